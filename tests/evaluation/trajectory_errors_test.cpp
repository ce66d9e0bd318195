#include <cmath>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

#include "brink/trajectory.hpp"
#include "expect_error.hpp"

namespace brink {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

Eigen::Isometry3d motion(double x, double z, double yaw_deg = 0.0) {
  return Eigen::Translation3d(x, 0.0, z) * Eigen::AngleAxisd(yaw_deg * kDegree, Eigen::Vector3d::UnitY());
}

/// `poses` of them, each one step from the one before.
Trajectory walk(int poses, const Eigen::Isometry3d& step) {
  Trajectory trajectory;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int i = 0; i < poses; ++i, pose = pose * step) trajectory.world_from_camera.push_back(pose);
  return trajectory;
}

/// Goes ahead, round corners and up and down.
Trajectory winding_walk() {
  Trajectory trajectory;
  for (int i = 0; i < 60; ++i) {
    const double t = 0.1 * i;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() = Eigen::Vector3d(std::sin(t), 0.2 * std::cos(3.0 * t), t);
    pose.rotate(Eigen::AngleAxisd(0.3 * std::sin(2.0 * t), Eigen::Vector3d(0.2, 0.9, 0.1).normalized()));
    trajectory.world_from_camera.push_back(pose);
  }
  return trajectory;
}

Trajectory moved(const Trajectory& trajectory, const Eigen::Isometry3d& new_from_world) {
  Trajectory result;
  for (const Eigen::Isometry3d& pose : trajectory.world_from_camera)
    result.world_from_camera.emplace_back(new_from_world * pose);
  return result;
}

TEST(TrajectoryErrors, AreZeroForTheTruthItself) {
  const TrajectoryErrors errors = compute_trajectory_errors(winding_walk(), winding_walk(), 1.0);
  EXPECT_EQ(errors.poses, 60);
  EXPECT_GT(errors.length_m, 6.0);
  EXPECT_GT(errors.segments, 30);
  EXPECT_EQ(errors.rotation.mean, 0.0);
  EXPECT_EQ(errors.translation_m.deviation, 0.0);
  EXPECT_EQ(errors.step_rotation.mean, 0.0);
  EXPECT_EQ(errors.step_translation_m.mean, 0.0);
  EXPECT_NEAR(errors.segment_translation_percent.value(), 0.0, 1e-12);
  EXPECT_NEAR(errors.segment_rotation_deg_per_m.value(), 0.0, 1e-12);
  EXPECT_EQ(errors.end_error_percent, 0.0);
  EXPECT_NEAR(errors.ate_rmse_m, 0.0, 1e-12);
}

TEST(TrajectoryErrors, OfAScaleOneHundredthTooLargeAreOnePercent) {
  // 11 poses, 0, 0.5, ... 5 m; the estimate is off by 0, 0.005, ... 0.05 m: 0.025 on average, with a deviation of 0.005
  // sqrt(10).
  const TrajectoryErrors errors = compute_trajectory_errors(walk(11, motion(0.0, 0.505)), walk(11, motion(0.0, 0.5)), 2.0);
  EXPECT_NEAR(errors.length_m, 5.0, 1e-12);
  EXPECT_NEAR(errors.translation_m.mean, 0.025, 1e-12);
  EXPECT_NEAR(errors.translation_m.deviation, 0.005 * std::sqrt(10.0), 1e-12);
  EXPECT_NEAR(errors.step_translation_m.mean, 0.005, 1e-12);
  EXPECT_NEAR(errors.step_translation_m.deviation, 0.0, 1e-12);
  EXPECT_EQ(errors.segments, 7);  // from 0, 0.5, ... 3 m
  EXPECT_NEAR(errors.segment_translation_percent.value(), 1.0, 1e-9);
  EXPECT_NEAR(errors.segment_rotation_deg_per_m.value(), 0.0, 1e-12);
  EXPECT_NEAR(errors.end_error_percent.value(), 1.0, 1e-9);
  // Aligned by their middles, the ends are off by 0.025 m; without scale this stays.
  EXPECT_NEAR(errors.ate_rmse_m, 0.005 * std::sqrt(10.0), 1e-9);
  EXPECT_EQ(errors.rotation.mean, 0.0);
}

TEST(TrajectoryErrors, DivideASegmentByItsOwnLength) {
  // Steps of 0.3 m: the first length of at least 1 m is 1.2 m.
  const TrajectoryErrors errors = compute_trajectory_errors(walk(11, motion(0.0, 0.303)), walk(11, motion(0.0, 0.3)), 1.0);
  EXPECT_EQ(errors.segments, 7);
  EXPECT_NEAR(errors.segment_translation_percent.value(), 1.0, 1e-9);
}

TEST(TrajectoryErrors, TakeTheFrobeniusNormOfTheDifferenceOfRotations) {
  // For two rotations that differ by an angle it is 2 sqrt(2) sin(angle / 2).
  const TrajectoryErrors errors = compute_trajectory_errors(walk(2, motion(0.0, 1.0, 10.0)), walk(2, motion(0.0, 1.0)), 1.0);
  const double norm = 2.0 * std::sqrt(2.0) * std::sin(5.0 * kDegree);
  EXPECT_NEAR(errors.step_rotation.mean, norm, 1e-12);
  EXPECT_NEAR(errors.rotation.mean, norm / 2.0, 1e-12);  // of poses that are off by 0 and by 10 degrees
  EXPECT_NEAR(errors.rotation.deviation, norm / 2.0, 1e-12);
  EXPECT_EQ(errors.translation_m.mean, 0.0);
}

TEST(TrajectoryErrors, AddUpAConstantYawErrorPerFrame) {
  // 0.5 degrees a frame and 0.25 m a frame: 2 degrees per metre, whatever the segment.
  const Trajectory truth = walk(21, motion(0.0, 0.25));
  const TrajectoryErrors errors = compute_trajectory_errors(walk(21, motion(0.0, 0.25, 0.5)), truth, 1.0);
  EXPECT_EQ(errors.segments, 17);
  EXPECT_NEAR(errors.segment_rotation_deg_per_m.value(), 2.0, 1e-9);
  EXPECT_NEAR(errors.step_rotation.mean, 2.0 * std::sqrt(2.0) * std::sin(0.25 * kDegree), 1e-12);
  EXPECT_NEAR(errors.step_rotation.deviation, 0.0, 1e-12);
  double sum = 0.0;
  for (int i = 0; i < 21; ++i) sum += 2.0 * std::sqrt(2.0) * std::sin(0.25 * i * kDegree);
  EXPECT_NEAR(errors.rotation.mean, sum / 21.0, 1e-12);
  // The estimate runs along a chain of 20 chords, each turned by half a degree more.
  Eigen::Vector2d end = Eigen::Vector2d::Zero();
  for (int i = 0; i < 20; ++i) end += 0.25 * Eigen::Vector2d(std::sin(0.5 * i * kDegree), std::cos(0.5 * i * kDegree));
  EXPECT_NEAR(errors.end_error_percent.value(), 100.0 * (end - Eigen::Vector2d(0.0, 5.0)).norm() / 5.0, 1e-9);
  // KITTI's translation error over 4 steps, by the same chain, seen from its own end.
  Eigen::Vector2d four = Eigen::Vector2d::Zero();
  for (int i = 0; i < 4; ++i) four += 0.25 * Eigen::Vector2d(std::sin(0.5 * i * kDegree), std::cos(0.5 * i * kDegree));
  EXPECT_NEAR(errors.segment_translation_percent.value(), 100.0 * (four - Eigen::Vector2d(0.0, 1.0)).norm(), 1e-9);
}

TEST(TrajectoryErrors, CountOneJumpInOneStepAndInAllThatFollows) {
  // 10 steps of 1 m; the sixth goes 0.3 m to the side as well.
  const Trajectory truth = walk(11, motion(0.0, 1.0));
  Trajectory estimate = truth;
  for (std::size_t i = 6; i < 11; ++i) estimate.world_from_camera[i].translation().x() += 0.3;
  const TrajectoryErrors errors = compute_trajectory_errors(estimate, truth, 2.0);
  EXPECT_NEAR(errors.step_translation_m.mean, 0.03, 1e-12);       // 0.3 m in one of 10 steps
  EXPECT_NEAR(errors.step_translation_m.deviation, 0.09, 1e-12);  // sqrt(0.1 * 0.27^2 + 0.9 * 0.03^2)
  EXPECT_NEAR(errors.translation_m.mean, 5.0 * 0.3 / 11.0, 1e-12);
  EXPECT_NEAR(errors.end_error_percent.value(), 3.0, 1e-12);
  EXPECT_EQ(errors.segments, 9);
  EXPECT_NEAR(errors.segment_translation_percent.value(), 2.0 * 15.0 / 9.0, 1e-12);  // two of nine hold the jump: 0.3 m in 2 m
}

TEST(TrajectoryErrors, DoNotDependOnWhereTheTrajectoriesBegin) {
  const Trajectory truth = winding_walk();
  Trajectory estimate = truth;
  for (std::size_t i = 0; i < estimate.world_from_camera.size(); ++i) {
    estimate.world_from_camera[i].translation().x() += 0.01 * static_cast<double>(i);
  }
  const Eigen::Isometry3d elsewhere =
      Eigen::Translation3d(5.0, -2.0, 7.0) * Eigen::AngleAxisd(1.1, Eigen::Vector3d(1.0, 2.0, -1.0).normalized());
  const TrajectoryErrors here = compute_trajectory_errors(estimate, truth, 1.0);
  const TrajectoryErrors there = compute_trajectory_errors(moved(estimate, elsewhere), truth, 1.0);
  EXPECT_GT(here.translation_m.mean, 0.1);
  EXPECT_NEAR(there.translation_m.mean, here.translation_m.mean, 1e-9);
  EXPECT_NEAR(there.rotation.mean, here.rotation.mean, 1e-9);
  EXPECT_NEAR(there.segment_translation_percent.value(), here.segment_translation_percent.value(), 1e-9);
  EXPECT_NEAR(there.ate_rmse_m, here.ate_rmse_m, 1e-9);
}

TEST(TrajectoryErrors, AlignPositionsBeforeTheAbsoluteError) {
  // Only the first pose of the estimate is turned: all that follow it are off, but not their shape.
  const Trajectory truth = winding_walk();
  Trajectory estimate = truth;
  estimate.world_from_camera[0].rotate(Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY()));
  const TrajectoryErrors errors = compute_trajectory_errors(estimate, truth, 1.0);
  EXPECT_GT(errors.translation_m.mean, 0.1);
  EXPECT_NEAR(errors.ate_rmse_m, 0.0, 1e-9);
}

TEST(TrajectoryErrors, AlignAStraightPathToo) {
  // Of a path along z that was estimated along x nothing is left.
  EXPECT_NEAR(compute_trajectory_errors(walk(9, motion(0.4, 0.0)), walk(9, motion(0.0, 0.4)), 1.0).ate_rmse_m, 0.0, 1e-9);
  // Zigzags to the side stay: being symmetric about the middle, no turn helps. 4 of 9 points are 0.1 m off, so the deviation
  // is 0.1 sqrt(4/9 * 5/9).
  Trajectory zigzag = walk(9, motion(0.0, 0.4));
  for (std::size_t i = 1; i < 9; i += 2) zigzag.world_from_camera[i].translation().y() = 0.1;
  const double rmse = compute_trajectory_errors(zigzag, walk(9, motion(0.0, 0.4)), 1.0).ate_rmse_m;
  EXPECT_NEAR(rmse, 0.1 * std::sqrt(20.0) / 9.0, 1e-12);
}

TEST(TrajectoryErrors, OfAnEstimateThatStandsStillAreFinite) {
  const TrajectoryErrors errors = compute_trajectory_errors(walk(5, motion(0.0, 0.0)), walk(5, motion(0.0, 1.0)), 1.0);
  EXPECT_NEAR(errors.end_error_percent.value(), 100.0, 1e-12);
  EXPECT_NEAR(errors.segment_translation_percent.value(), 100.0, 1e-12);
  EXPECT_NEAR(errors.ate_rmse_m, std::sqrt(2.0), 1e-12);  // 0..4 m about its middle
}

TEST(TrajectoryErrors, LeaveOutWhatAShortPathCannotTell) {
  const TrajectoryErrors errors = compute_trajectory_errors(walk(3, motion(0.0, 0.4)), walk(3, motion(0.0, 0.4)), 1.0);
  EXPECT_EQ(errors.segments, 0);
  EXPECT_FALSE(errors.segment_translation_percent.has_value());
  EXPECT_FALSE(errors.segment_rotation_deg_per_m.has_value());
  EXPECT_TRUE(errors.end_error_percent.has_value());
  const TrajectoryErrors still = compute_trajectory_errors(walk(3, motion(0.0, 0.1)), walk(3, motion(0.0, 0.0)), 1.0);
  EXPECT_EQ(still.length_m, 0.0);
  EXPECT_FALSE(still.end_error_percent.has_value());
  EXPECT_NEAR(still.translation_m.mean, 0.1, 1e-12);
}

TEST(TrajectoryErrors, RefuseTrajectoriesThatCannotBeCompared) {
  const auto fault = [](int estimate, int truth, double segment_m) {
    return test::error_of<std::invalid_argument>(
        [&] { compute_trajectory_errors(walk(estimate, motion(0, 1)), walk(truth, motion(0, 1)), segment_m); });
  };
  test::expect_line_with(fault(3, 4, 1.0), "estimate has 3 poses, must be 4 like the truth");
  test::expect_line_with(fault(1, 1, 1.0), "trajectory has 1 poses, must be at least 2");
  test::expect_line_with(fault(0, 0, 1.0), "trajectory has 0 poses");
  test::expect_line_with(fault(3, 3, 0.0), "segment_m = 0, must be > 0");
  test::expect_line_with(fault(3, 3, std::nan("")), "segment_m = nan, must be > 0");
}

}  // namespace
}  // namespace brink
