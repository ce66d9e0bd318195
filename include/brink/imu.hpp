#pragma once

#include <Eigen/Core>

namespace brink {

inline constexpr double kGravity = 9.81;  ///< m/s^2

/// One reading of an inertial measurement unit, in the left camera frame.
struct ImuSample {
  double time = 0.0;                                         ///< s
  Eigen::Vector3d angular_rate = Eigen::Vector3d::Zero();    ///< rad/s
  Eigen::Vector3d specific_force = Eigen::Vector3d::Zero();  ///< m/s^2: acceleration less gravity, 9.81 upwards at rest
};

}  // namespace brink
