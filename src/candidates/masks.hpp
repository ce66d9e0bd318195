#pragma once

#include <opencv2/core.hpp>

#include "brink/candidates.hpp"

namespace brink {

constexpr float kLeastDisparity = 1.0F;  // the paper: a disparity below 1 is none

/// What Type 1 is made of, 255 = so, size of the picture.
struct BelowGroundMasks {
  explicit BelowGroundMasks(const cv::Size& size) : none(size), deep(size), low(size), level(size) {}
  cv::Mat1b none;   ///< no disparity
  cv::Mat1b deep;   ///< as far below the ground as is wanted, in range
  cv::Mat1b low;    ///< as far as the rim of a drop must be, in range
  cv::Mat1b level;  ///< a surface at the height of the ground
};

/// All in one pass over the pictures. In range is a pixel whose ray meets the ground within max_range_m.
BelowGroundMasks find_below_ground(const cv::Mat1f& disparity, const cv::Mat1f& elevation, const GroundSurface& ground,
                                   const StereoCamera& camera, const CandidateParams& params);

/// What Type 2 is made of: 255 where there is no disparity though both cameras see the ground, in range and at least border_px
/// away from the edges of their pictures. What only the left camera sees has no disparity either, but says nothing about a
/// hole.
/// @param none 255 = no disparity.
cv::Mat1b find_no_disparity(const cv::Mat1b& none, const GroundSurface& ground, const StereoCamera& camera,
                            const CandidateParams& params);

}  // namespace brink
