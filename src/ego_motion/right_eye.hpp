#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "brink/ego_motion.hpp"
#include "brink/frame.hpp"
#include "ego_motion/features.hpp"
#include "ego_motion/refinement.hpp"

namespace brink {

/// A frame as points are found in it: its left picture, and what tells where they are in the right one.
struct SmoothPair {
  cv::Mat1b left;       ///< smoothed for patches
  cv::Mat1b right;      ///< likewise; empty when there is a disparity image
  cv::Mat1f disparity;  ///< Frame::disparity; empty when there is a right picture
};
SmoothPair make_smooth_pair(const Frame& frame);

/// The features of the right picture. Where a disparity image takes its place: the left ones, moved to where the right picture
/// would show them; those for which none is told are left out.
std::vector<Feature> find_right_features(const Frame& frame, const std::vector<Feature>& left, const EgoMotionParams& params);

/// A disparity and how well it is known.
struct DisparityReading {
  double disparity = 0.0;  ///< px
  double variance = 0.0;   ///< px^2
};

/// The disparity at a place between pixels: that of the plane through the pixels around it, which also tell their noise.
/// @return empty near the border, where too many pixels have none, and where no plane fits: at depth edges.
std::optional<DisparityReading> read_disparity_at(const cv::Mat1f& disparity, const Eigen::Vector2d& position);

/// Where the right picture shows a point.
struct RightPlace {
  Eigen::Vector2d position;    ///< px
  Eigen::Matrix4d covariance;  ///< of the position in the left picture and this one, px^2
};

/// A point of the left picture that is sought in the right one.
struct RightSearch {
  Alignment left;    ///< where the left picture shows it
  PatchSearch here;  ///< its patch in the right picture
};

/// Finds points of the left picture in the right one, by aligning their patches there, or by the disparity image.
/// @return for each search; empty when it is not found, or not on its row.
std::vector<std::optional<RightPlace>> find_in_right(const SmoothPair& frame, const std::vector<RightSearch>& searches);

}  // namespace brink
