#include "ego_motion/kalman.hpp"

#include <cmath>
#include <numbers>

namespace brink {
namespace {

Vector6d to_vector(const Eigen::Isometry3d& motion) {
  const Eigen::AngleAxisd turn(motion.linear());
  Vector6d vector;
  vector << turn.angle() * turn.axis(), motion.translation();
  return vector;
}

Eigen::Isometry3d to_motion(const Vector6d& vector) {
  const Eigen::Vector3d turn = vector.head<3>();
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.linear() = Eigen::AngleAxisd(turn.norm(), turn.stableNormalized()).toRotationMatrix();
  motion.translation() = vector.tail<3>();
  return motion;
}

}  // namespace

void VelocityFilter::update(const Eigen::Isometry3d& current_from_previous, const Matrix6d& covariance, double seconds) {
  const Vector6d measured = to_vector(current_from_previous) / seconds;
  const Eigen::Matrix2d passage = (Eigen::Matrix2d() << 1.0, seconds, 0.0, 1.0).finished();
  for (int i = 0; i < 6; ++i) {
    const double jerk = i < 3 ? params_.turn_jerk_deg * std::numbers::pi / 180.0 : params_.jerk_m;
    const double variance = covariance(i, i) / (seconds * seconds);
    Eigen::Matrix2d& spread = covariance_[static_cast<std::size_t>(i)];
    if (!known_) {
      velocity_[i] = measured[i];
      acceleration_[i] = 0.0;
      spread << variance, 0.0, 0.0, jerk * jerk * seconds * seconds;
      continue;
    }
    // Prediction: the acceleration wanders by jerk * seconds, the velocity by what comes of it.
    const Eigen::Vector2d wander(0.5 * jerk * seconds * seconds, jerk * seconds);
    const Eigen::Vector2d state = passage * Eigen::Vector2d(velocity_[i], acceleration_[i]);
    spread = passage * spread * passage.transpose() + wander * wander.transpose();
    // Correction by the measured velocity.
    const Eigen::Vector2d gain = spread.col(0) / (spread(0, 0) + variance);
    const Eigen::Vector2d corrected = state + gain * (measured[i] - state[0]);
    const Eigen::RowVector2d row = spread.row(0);
    spread -= gain * row;
    velocity_[i] = corrected[0];
    acceleration_[i] = corrected[1];
  }
  known_ = true;
}

std::optional<Eigen::Isometry3d> VelocityFilter::predict(double seconds) const {
  if (!known_ || !(seconds > 0.0)) return std::nullopt;
  return to_motion((velocity_ + seconds * acceleration_) * seconds);
}

}  // namespace brink
