#include "ego_motion/kalman.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace brink {
namespace {

constexpr double kStep = 1.0 / 15.0;

Eigen::Isometry3d turn_and_go(double angle, double ahead) {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.linear() = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()).toRotationMatrix();
  motion.translation().z() = -ahead;
  return motion;
}

TEST(VelocityFilter, PredictsNothingBeforeAMeasurementAndAfterAReset) {
  VelocityFilter filter{EgoMotionParams()};
  EXPECT_FALSE(filter.predict(kStep));
  filter.update(turn_and_go(0.01, 0.08), 1e-6 * Matrix6d::Identity(), kStep);
  EXPECT_TRUE(filter.predict(kStep));
  EXPECT_FALSE(filter.predict(0.0)) << "time stands still";
  filter.reset();
  EXPECT_FALSE(filter.predict(kStep));
}

TEST(VelocityFilter, PredictsAConstantAcceleration) {
  VelocityFilter filter{EgoMotionParams()};
  const auto motion = [](int frame) { return turn_and_go(0.002 * frame, 0.05 + 0.004 * frame); };
  for (int frame = 0; frame < 12; ++frame) filter.update(motion(frame), 1e-8 * Matrix6d::Identity(), kStep);
  const auto predicted = filter.predict(kStep);
  ASSERT_TRUE(predicted);
  EXPECT_TRUE(predicted->isApprox(motion(12), 1e-3));
}

TEST(VelocityFilter, SmoothsMeasurementsThatAreNoisy) {
  VelocityFilter filter{EgoMotionParams()};
  // 1.2 m/s, measured as 0.9 and 1.5 m/s in turns, with a standard deviation of 0.3 m/s.
  const Matrix6d covariance = 0.02 * 0.02 * Matrix6d::Identity();
  double largest = 0.0;
  for (int frame = 0; frame < 60; ++frame) {
    filter.update(turn_and_go(0.0, 0.08 + (frame % 2 == 0 ? 0.02 : -0.02)), covariance, kStep);
    if (frame > 20) largest = std::max(largest, std::abs(filter.velocity()[5] + 1.2));
  }
  EXPECT_LT(largest, 0.25);
  EXPECT_GT(largest, 0.0);
}

}  // namespace
}  // namespace brink
