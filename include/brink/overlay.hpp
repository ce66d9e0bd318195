#pragma once

#include <opencv2/core.hpp>

#include "brink/candidates.hpp"
#include "brink/detector.hpp"
#include "brink/frame.hpp"

namespace brink {

/// Pictures of one frame, after the paper's figures 2 to 5. All take the frame and what Detector::process told of it, have the
/// size of frame.left, and show the plain picture where there is nothing to draw (status not ok, ground not visible).

/// The left picture with ground pixels tinted green and pixels below the ground by min_depth_m or more tinted red; the state of
/// the ground is written at the top.
cv::Mat3b draw_ground(const Frame& frame, const Detection& detection, const CandidateParams& params = {});

/// Disparities in colour, from blue (far) to red (near), black = none, with a scale of pixels at the right unless
/// the picture is too small for it. Empty for an empty image. @param disparity px, kInvalidDisparity = none.
cv::Mat3b draw_disparity(const cv::Mat1f& disparity);

/// The left picture with contours: candidates of Type 1 cyan, of Type 2 magenta, rejected regions thin grey with the rule that
/// they failed.
cv::Mat3b draw_candidates(const Frame& frame, const Detection& detection);

/// The left picture with the obstacles that are reported, filled and outlined, the distance of the rim beside each; the state
/// of the ground is written at the top.
cv::Mat3b draw_obstacles(const Frame& frame, const Detection& detection);

}  // namespace brink
