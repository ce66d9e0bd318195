#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "brink/camera.hpp"
#include "brink/sim/render.hpp"
#include "brink/sim/scene.hpp"

namespace brink::sim {

/// Smooth head motion of a walk: twice differentiable, so that an IMU can be derived from it.
class HeadMotion {
 public:
  /// @param ground_height of the path's ground at (x, y), m. @throws std::invalid_argument when the walk is not valid.
  HeadMotion(const Walk& walk, const std::function<double(double, double)>& ground_height);
  /// @return world_from_camera of the left camera at a time, s, from 0.
  [[nodiscard]] Eigen::Isometry3d operator()(double time) const;
  /// Time at which the path ends, s.
  [[nodiscard]] double duration() const;
};

/// One reading in the left camera frame.
struct ImuSample {
  double time = 0.0;                                         ///< s
  Eigen::Vector3d angular_rate = Eigen::Vector3d::Zero();    ///< rad/s
  Eigen::Vector3d specific_force = Eigen::Vector3d::Zero();  ///< m/s^2
};

struct SimulationParams {
  std::string family;
  int seed = 1;
  int frames = 150;
  int width = 1280;
  int height = 720;
  double focal_px = 700.0;
  double baseline_m = 0.15;
  double fps = 15.0;
  std::string light;      ///< sunny, overcast, dusk; empty = by the seed
  double noise = 1.0;     ///< factor on the sensor's noise
  bool blur = false;      ///< motion blur
  int jpeg_quality = 0;   ///< 0 = PNG
  double dropped = 0.0;   ///< share of frames that are missing
  void validate() const;  ///< @throws std::invalid_argument "name = value, must be ..."
};

}  // namespace brink::sim
