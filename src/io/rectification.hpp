#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "brink/camera.hpp"

namespace brink {

/// A pinhole camera with a lens, as it was calibrated.
struct LensCamera {
  double focal_x = 0.0;  ///< px
  double focal_y = 0.0;  ///< px
  double cx = 0.0;       ///< px
  double cy = 0.0;       ///< px
  cv::Mat1d distortion;  ///< radial-tangential: k1 k2 p1 p2, and k3 if there is one
  cv::Size size;         ///< px
};

/// From which place of a picture each pixel of the rectified one comes.
struct RectificationMaps {
  cv::Mat places;     ///< CV_16SC2
  cv::Mat fractions;  ///< CV_16UC1
  [[nodiscard]] cv::Mat apply(const cv::Mat& picture) const;
};

/// What makes rectified pairs of those of two cameras.
struct Rectification {
  cv::Size size;        ///< of the pictures, before and after
  StereoCamera camera;  ///< of the rectified pictures; not validated: a baseline <= 0 means swapped eyes
  /// Axes of the left camera to those of the rectified one.
  Eigen::Matrix3d rectified_from_left = Eigen::Matrix3d::Identity();
  RectificationMaps left;
  RectificationMaps right;
};

/// Bouguet's rectification by cv::stereoRectify: principal points equal, no pixel without a source.
/// @param right_from_left position of points in the right camera from that in the left one, m.
Rectification make_rectification(const LensCamera& left, const LensCamera& right, const Eigen::Isometry3d& right_from_left);

}  // namespace brink
