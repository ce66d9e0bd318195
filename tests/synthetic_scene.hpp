#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "brink/camera.hpp"
#include "brink/disparity.hpp"
#include "brink/frame.hpp"
#include "brink/ground.hpp"

namespace brink::test {

/// A camera like the paper's at half size.
inline StereoCamera half_size_camera() { return {350.0, 319.5, 179.5, 0.15}; }
inline cv::Size half_size() { return {640, 360}; }

/// A rectangular opening in the ground with vertical walls, in ground coordinates: metres ahead and to the right of the foot of
/// the camera's perpendicular.
struct Opening {
  double near_m = 0.0;
  double far_m = 0.0;
  double left_m = 0.0;
  double right_m = 0.0;
  double depth_m = 0.0;

  [[nodiscard]] bool contains(double ahead, double aside) const {
    return ahead >= near_m && ahead <= far_m && aside >= left_m && aside <= right_m;
  }
};

/// Disparity that the camera sees over flat ground with openings: every ray is followed through the opening it meets to its
/// floor or wall. Exact up to rounding; above the horizon invalid.
inline cv::Mat1f make_disparity(const StereoCamera& camera, const cv::Size& size, const GroundPlane& ground,
                                const std::vector<Opening>& openings = {}) {
  const GroundPose pose = compute_ground_pose(ground, camera);
  cv::Mat1f disparity(size, kInvalidDisparity);
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      const auto point = pose.intersect(u, v, camera);
      if (!point) continue;
      double stretch = 1.0;  // how much farther along the ray than the ground
      for (const Opening& opening : openings) {
        const double ahead = pose.forward.dot(*point);
        const double aside = pose.right.dot(*point);
        if (!opening.contains(ahead, aside)) continue;
        stretch = 1.0 + opening.depth_m / pose.height_m;                      // floor
        if (ahead > 0.0) stretch = std::min(stretch, opening.far_m / ahead);  // far wall
        if (aside > 0.0) stretch = std::min(stretch, opening.right_m / aside);
        if (aside < 0.0) stretch = std::min(stretch, opening.left_m / aside);
      }
      disparity(v, u) = static_cast<float>(ground.disparity(u, v) / stretch);
    }
  }
  return disparity;
}

/// Adds noise of a standard deviation, px, to the valid pixels and makes a share of them invalid.
inline void degrade(cv::Mat1f& disparity, double sigma_px, double invalid_share, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, sigma_px);
  std::uniform_real_distribution<double> uniform;
  for (float& d : disparity) {
    if (d <= 0.0F) continue;
    d = uniform(random) < invalid_share ? kInvalidDisparity : static_cast<float>(std::max(0.01, d + noise(random)));
  }
}

/// Grey value of a point of a textured ground, 0..255: value noise of three cell sizes, so that there is something to match
/// from one metre to eight.
inline double ground_texture(double ahead, double aside) {
  const auto hash = [](int x, int y, unsigned seed) {
    unsigned h = static_cast<unsigned>(x) * 374761393U + static_cast<unsigned>(y) * 668265263U + seed * 2246822519U;
    h = (h ^ (h >> 13U)) * 1274126177U;
    return static_cast<double>((h ^ (h >> 16U)) & 0xFFFFU) / 65535.0;
  };
  double value = 0.0;
  unsigned seed = 0;
  for (const double cell : {0.02, 0.06, 0.2}) {
    const double x = ahead / cell;
    const double y = aside / cell;
    const int column = static_cast<int>(std::floor(x));
    const int row = static_cast<int>(std::floor(y));
    const double s = x - column;
    const double t = y - row;
    value += (1 - t) * ((1 - s) * hash(column, row, seed) + s * hash(column + 1, row, seed)) +
             t * ((1 - s) * hash(column, row + 1, seed) + s * hash(column + 1, row + 1, seed));
    ++seed;
  }
  return 20.0 + value / 3.0 * 215.0;
}

/// A rectified pair of pictures of textured flat ground, with noise; grey 128 above the horizon.
inline Frame make_ground_frame(const StereoCamera& camera, const cv::Size& size, const GroundPlane& ground) {
  const GroundPose pose = compute_ground_pose(ground, camera);
  std::array<cv::Mat1b, 2> eyes = {cv::Mat1b(size, uchar{128}), cv::Mat1b(size, uchar{128})};
  for (std::size_t eye = 0; eye < eyes.size(); ++eye) {
    const Eigen::Vector3d origin(static_cast<double>(eye) * camera.baseline, 0.0, 0.0);
    std::mt19937 random(static_cast<unsigned>(eye) + 1U);
    std::normal_distribution<double> noise(0.0, 1.5);
    for (int v = 0; v < size.height; ++v) {
      for (int u = 0; u < size.width; ++u) {
        const Eigen::Vector3d ray((u - camera.cx) / camera.focal, (v - camera.cy) / camera.focal, 1.0);
        const double descent = pose.down.dot(ray);
        const Eigen::Vector3d point = origin + ray * (pose.elevation(origin) / descent);
        if (descent <= 0.0 || pose.distance(point) > 30.0) continue;
        const double grey = ground_texture(pose.forward.dot(point), pose.right.dot(point)) + noise(random);
        eyes[eye](v, u) = cv::saturate_cast<uchar>(grey);
      }
    }
  }
  return make_frame(eyes[0], eyes[1], camera);
}

}  // namespace brink::test
