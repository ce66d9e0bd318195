#pragma once

#include <algorithm>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "brink/camera.hpp"
#include "brink/ground.hpp"

namespace brink::test {

inline const cv::Size kSize(640, 360);
inline constexpr StereoCamera kCamera{350.0, 319.5, 179.5, 0.15};

/// A camera 1.6 m over flat ground that looks down by 30 degrees; y of the ground frame points down, z ahead.
inline constexpr double kHeight = 1.6;
inline Eigen::Isometry3d camera_from_ground() {
  return Eigen::Isometry3d(Eigen::AngleAxisd(std::numbers::pi / 6.0, Eigen::Vector3d::UnitX()));
}

/// Points on the ground, given by what is to the right and ahead of the camera's foot, in the camera frame.
inline std::vector<Eigen::Vector3d> on_ground(const std::vector<Eigen::Vector2d>& right_and_ahead) {
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector2d& p : right_and_ahead)
    points.push_back(camera_from_ground() * Eigen::Vector3d(p.x(), kHeight, p.y()));
  return points;
}

/// Disparities of the ground, with a box of one depth in front of a part of the picture.
inline cv::Mat1f ground_with_box(const cv::Rect& box, double box_depth) {
  const GroundPlane ground = make_ground_plane(kHeight, 30.0, 0.0, kCamera);
  cv::Mat1f disparity(kSize, 0.0F);
  for (int v = 0; v < kSize.height; ++v) {
    for (int u = 0; u < kSize.width; ++u) disparity(v, u) = static_cast<float>(std::max(0.0, ground.disparity(u, v)));
  }
  disparity(box) = static_cast<float>(kCamera.focal * kCamera.baseline / box_depth);
  return disparity;
}

}  // namespace brink::test
