#pragma once

#include <map>
#include <optional>
#include <utility>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "brink/ground.hpp"
#include "ground/plane_search.hpp"

namespace brink {

/// Heights of the surfaces that were seen around the bearer, in cells of the ground seen from above: what has left the view, at
/// the bearer's feet, is remembered. A cell holds the mean of the last frames that showed it.
class Footing {
 public:
  /// Forgets everything; the cells lie along the axes of a ground. @param ground in the camera frame of now.
  void start(const GroundPose& ground);
  [[nodiscard]] bool is_started() const { return started_; }

  void move(const Eigen::Isometry3d& current_from_previous);

  /// Adds what a frame shows within reach. @param samples of the camera frame of now.
  void add(const GroundSamples& samples);

  /// Distance of the surface at the feet from the camera, along the normal of the ground at the start, m. The feet are at the
  /// foot of the camera's perpendicular, give or take half a step.
  /// @return empty where nothing was seen there.
  [[nodiscard]] std::optional<double> height_m() const;

 private:
  struct Cell {
    double height = 0.0;  ///< m along the normal, down positive, in the frame of the start
    int frames = 0;
    int last_frame = 0;
  };
  bool started_ = false;
  int frame_ = 0;
  Eigen::Isometry3d start_from_camera_ = Eigen::Isometry3d::Identity();  ///< start: axes right, down, forward of its ground
  std::map<std::pair<int, int>, Cell> cells_;
};

}  // namespace brink
