#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "brink/ego_motion.hpp"
#include "ego_motion/motion.hpp"

namespace brink {

/// Velocity and acceleration of the camera, in its own frame, assuming constant acceleration: three turns (rad/s), three
/// translations (m/s). Six filters of two unknowns each.
class VelocityFilter {
 public:
  explicit VelocityFilter(const EgoMotionParams& params) : params_(params) {}

  /// Takes in a measured motion. @param covariance of (w, t) as MotionFit tells it. @param seconds that it took, > 0.
  void update(const Eigen::Isometry3d& current_from_previous, const Matrix6d& covariance, double seconds);
  /// Forgets everything: after a failure the past tells nothing.
  void reset() { known_ = false; }

  /// The motion to expect over the next seconds; empty before the first measurement, and unless seconds > 0.
  [[nodiscard]] std::optional<Eigen::Isometry3d> predict(double seconds) const;
  /// Smoothed velocity: turn in rad/s, then translation in m/s, of the scene in the camera's frame.
  [[nodiscard]] const Vector6d& velocity() const { return velocity_; }

 private:
  EgoMotionParams params_;
  bool known_ = false;
  Vector6d velocity_ = Vector6d::Zero();
  Vector6d acceleration_ = Vector6d::Zero();
  std::array<Eigen::Matrix2d, 6> covariance_{};
};

}  // namespace brink
