#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "brink/camera.hpp"
#include "brink/frame.hpp"

namespace brink::test {

/// From a place on, m along the way, the floor lies this far below the level of the start.
struct Floor {
  double from_m = 0.0;
  double depth_m = 0.0;
};

/// A way straight ahead, the same all across it: floors one after the other, the first from minus infinity.
using FloorProfile = std::vector<Floor>;

/// Where the camera is, in the axes of the profile: upright but for its pitch, looking along the way.
struct Stand {
  double along_m = 0.0;
  double height_m = 1.6;  ///< over the level of the start
  double pitch_deg = 25.0;

  /// World: x right, y down, z along the way; the level of the start is y = 0.
  [[nodiscard]] Eigen::Isometry3d world_from_camera() const {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() << 0.0, -height_m, along_m;
    pose.linear() = Eigen::AngleAxisd(-pitch_deg * std::numbers::pi / 180.0, Eigen::Vector3d::UnitX()).toRotationMatrix();
    return pose;
  }
};

/// z of what the ray of an image row meets, m; 0 = nothing. @param forward, down of the ray whose z in the camera frame is 1.
inline double trace_row(const FloorProfile& profile, const Stand& stand, double forward, double down) {
  double nearest = 0.0;
  const auto note = [&nearest](double z) {
    if (z > 0.0 && (nearest == 0.0 || z < nearest)) nearest = z;
  };
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const Floor& floor = profile[i];
    if (down > 0.0) {
      const double z = (stand.height_m + floor.depth_m) / down;
      const double at = stand.along_m + forward * z;
      if ((i == 0 || at >= floor.from_m) && (i + 1 == profile.size() || at < profile[i + 1].from_m)) note(z);
    }
    if (i == 0 || forward <= 0.0 || floor.depth_m >= profile[i - 1].depth_m) continue;
    const double z = (floor.from_m - stand.along_m) / forward;  // a step up faces the camera
    const double below = down * z - stand.height_m;
    if (below >= floor.depth_m && below <= profile[i - 1].depth_m) note(z);
  }
  return nearest;
}

/// The disparities that a camera sees of a profile, with noise. What is nothing, or farther than 30 m, is invalid.
inline cv::Mat1f make_disparity(const FloorProfile& profile, const Stand& stand, const StereoCamera& camera,
                                const cv::Size& size, double noise_px, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, noise_px);
  const double pitch = stand.pitch_deg * std::numbers::pi / 180.0;
  cv::Mat1f disparity(size, kInvalidDisparity);
  for (int v = 0; v < size.height; ++v) {
    const double y = (v - camera.cy) / camera.focal;
    const double z = trace_row(profile, stand, std::cos(pitch) - y * std::sin(pitch), std::sin(pitch) + y * std::cos(pitch));
    if (z <= 0.0 || z > 30.0) continue;
    const double d = camera.focal * camera.baseline / z;
    for (int u = 0; u < size.width; ++u) {
      const double measured = d + (noise_px > 0.0 ? noise(random) : 0.0);
      if (measured < u && measured > 0.0) disparity(v, u) = static_cast<float>(measured);
    }
  }
  return disparity;
}

/// Straight on with steps of so many metres, at the same height over the level of the start.
inline std::vector<Stand> make_approach(double from_m, double to_m, double step_m, const Stand& first) {
  std::vector<Stand> stands;
  for (double at = from_m; at <= to_m + 1e-9; at += step_m) {
    stands.push_back(first);
    stands.back().along_m = at;
  }
  return stands;
}

}  // namespace brink::test
