#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "brink/sim/simulate.hpp"
#include "expect_error.hpp"

namespace brink::sim {
namespace {

using Eigen::Vector3d;

constexpr double kDegrees = 180.0 / std::numbers::pi;

std::vector<double> times_until(double end, double step) {
  std::vector<double> times;
  while (static_cast<double>(times.size()) * step < end) times.push_back(static_cast<double>(times.size()) * step);
  return times;
}

double flat(double /*x*/, double /*y*/, double /*z*/) { return 0.0; }

// Nothing moves but the walker.
Walk still_head(const std::vector<Eigen::Vector2d>& waypoints) {
  Walk walk;
  walk.waypoints = waypoints;
  walk.bob_m = walk.sway_m = 0.0;
  walk.roll_deg = walk.pitch_swing_deg = walk.yaw_swing_deg = 0.0;
  walk.look_yaw_deg = walk.look_pitch_deg = 0.0;
  return walk;
}

Walk winding(double look_yaw_deg) {
  Walk walk;
  walk.waypoints = {{0, 0}, {6, 0}, {8, 3}, {14, 3}, {14, 8}, {8, 8}, {8, 3.5}, {0, 3.5}};
  walk.look_yaw_deg = look_yaw_deg;
  return walk;
}

double ramp(double x, double /*y*/, double /*z*/) { return 0.1 * std::clamp(x - 3.0, 0.0, 5.0); }

Vector3d angular_rate(const HeadMotion& motion, double time) {
  constexpr double kStep = 1e-4;
  const Eigen::Matrix3d turned = motion(time - kStep).linear().transpose() * motion(time + kStep).linear();
  const Eigen::AngleAxisd angle(turned);
  return angle.axis() * (angle.angle() / (2.0 * kStep));
}

Vector3d velocity(const HeadMotion& motion, double time) {
  constexpr double kStep = 1e-4;
  return (motion(time + kStep).translation() - motion(time - kStep).translation()) / (2.0 * kStep);
}

Vector3d acceleration(const HeadMotion& motion, double time) {
  constexpr double kStep = 1e-3;
  return (motion(time + kStep).translation() - 2.0 * motion(time).translation() + motion(time - kStep).translation()) /
         (kStep * kStep);
}

TEST(HeadMotion, AStillHeadWalksStraightAtEvenSpeed) {
  Walk walk = still_head({{1, 2}, {7, 2}});
  walk.speed_mps = 1.5;
  const HeadMotion motion(walk, flat);
  EXPECT_NEAR(motion.duration(), 4.0, 0.05 / 1.5);
  for (const double time : {-5.0, -1.0, 0.0, 0.123, 2.0, 3.9, 6.0, 20.0}) {
    EXPECT_LT((motion(time).translation() - Vector3d(1.0 + 1.5 * time, 2.0, 1.65)).norm(), 1e-6) << time;
  }
}

TEST(HeadMotion, ThePrincipalRayMeetsTheGroundWherePitchAndHeightSay) {
  Walk walk = still_head({{0, 0}, {0, 5}});  // to the left of the world
  walk.camera_height_m = 1.6;
  walk.pitch_deg = 30.0;
  const Eigen::Isometry3d world_from_camera = HeadMotion(walk, flat)(1.0);
  const Vector3d ray = world_from_camera.linear().col(2);
  const Vector3d hit = world_from_camera.translation() + 1.6 / -ray.z() * ray;
  const double ahead = 1.6 / std::tan(30.0 / kDegrees);
  EXPECT_LT((hit - Vector3d(0.0, 1.2 + ahead, 0.0)).norm(), 1e-6);
  EXPECT_LT((world_from_camera.linear().col(0) - Vector3d::UnitX()).norm(), 1e-9) << "x of the camera is its right";
  EXPECT_LT(world_from_camera.linear().col(1).z(), 0.0) << "y of the camera is downwards";
  EXPECT_NEAR(world_from_camera.linear().determinant(), 1.0, 1e-12);
}

TEST(HeadMotion, FollowsTheGround) {
  const HeadMotion motion(still_head({{0, 0}, {12, 0}}), ramp);
  EXPECT_NEAR(motion(0.5).translation().z(), 1.65, 1e-6);
  EXPECT_NEAR(motion(5.5 / 1.2).translation().z(), 1.65 + 0.25, 1e-4);
  EXPECT_NEAR(motion(11.0 / 1.2).translation().z(), 1.65 + 0.5, 1e-6);
}

TEST(HeadMotion, GoesOnLevelWhereThereIsNoGroundAndBeyondThePath) {
  const auto hole = [](double x, double /*y*/, double /*z*/) {
    return x > 2.0 && x < 4.0 ? std::numeric_limits<double>::quiet_NaN() : x > 6.0 ? -1.0 : 0.0;
  };
  const HeadMotion motion(still_head({{0, 0}, {6, 0}}), hole);
  for (const double time : {0.0, 2.5, 5.0, 7.0}) EXPECT_NEAR(motion(time).translation().z(), 1.65, 1e-6) << time;
}

TEST(HeadMotion, AsksForTheGroundFromWhereItIs) {
  // Two floors, one a metre above the other: the lower one is reached by a ramp.
  const auto floors = [](double x, double /*y*/, double z) { return z < -0.5 ? -1.0 : std::max(-1.0, -0.2 * x); };
  const HeadMotion motion(still_head({{0, 0}, {12, 0}}), floors);
  EXPECT_NEAR(motion(9.5).translation().z(), 0.65, 1e-6);
}

TEST(HeadMotion, PassesEveryCornerCloselyAndKeepsItsSpeed) {
  Walk walk = still_head(winding(0.0).waypoints);
  const HeadMotion motion(walk, flat);
  std::vector<double> nearest(walk.waypoints.size(), 1e9);
  double slowest = 1e9;
  double fastest = 0.0;
  for (const double time : times_until(motion.duration(), 0.01)) {
    const Vector3d position = motion(time).translation();
    for (std::size_t i = 0; i < nearest.size(); ++i) {
      nearest[i] = std::min(nearest[i], (position.head<2>() - walk.waypoints[i]).norm());
    }
    const double speed = velocity(motion, time).norm();
    slowest = std::min(slowest, speed);
    fastest = std::max(fastest, speed);
  }
  for (const double distance : nearest) EXPECT_LT(distance, 0.3);
  EXPECT_GT(slowest, 0.99 * walk.speed_mps);
  EXPECT_LT(fastest, 1.001 * walk.speed_mps);
}

TEST(HeadMotion, BobsOnceAStepAndSwaysOnceEveryTwo) {
  Walk walk = still_head({{0, 0}, {12, 0}});
  walk.bob_m = 0.03;
  walk.sway_m = 0.02;
  walk.step_length_m = 0.6;
  const HeadMotion motion(walk, flat);
  const double step = 0.6 / 1.2;
  for (const double time : {2.0, 2.1, 2.37}) {
    const Vector3d now = motion(time).translation();
    EXPECT_NEAR(motion(time + step).translation().z(), now.z(), 1e-6);
    EXPECT_NEAR(motion(time + step).translation().y(), -now.y(), 1e-6);
    EXPECT_NEAR(motion(time + 2.0 * step).translation().y(), now.y(), 1e-6);
  }
  double highest = 0.0;
  double leftmost = 0.0;
  for (const double time : times_until(4.0, 0.005)) {
    highest = std::max(highest, motion(time).translation().z());
    leftmost = std::max(leftmost, motion(time).translation().y());
  }
  EXPECT_NEAR(highest, 1.68, 1e-4);
  EXPECT_NEAR(leftmost, 0.02, 1e-4);
}

// A jump of the velocity or of the angular rate would show as a difference that does not shrink with the step.
TEST(HeadMotion, VelocityAndAccelerationHaveNoJumps) {
  Walk walk = winding(45.0);
  walk.look_period_s = 2.0;
  const HeadMotion motion(walk, ramp);
  constexpr double kStep = 0.002;
  double rate_change = 0.0;
  double velocity_change = 0.0;
  double acceleration_change = 0.0;
  for (const double time : times_until(motion.duration(), kStep)) {
    rate_change = std::max(rate_change, (angular_rate(motion, time + kStep) - angular_rate(motion, time)).norm());
    velocity_change = std::max(velocity_change, (velocity(motion, time + kStep) - velocity(motion, time)).norm());
    acceleration_change =
        std::max(acceleration_change, (acceleration(motion, time + kStep) - acceleration(motion, time)).norm());
  }
  RecordProperty("rate_change_dps", std::to_string(rate_change * kDegrees));
  EXPECT_LT(rate_change * kDegrees, 1000.0 * kStep);  // 1000 deg/s^2 at most
  EXPECT_LT(velocity_change, 5.0 * kStep);            // 5 m/s^2
  EXPECT_LT(acceleration_change, 50.0 * kStep);       // 50 m/s^3
}

TEST(HeadMotion, LooksAroundQuicklyButNotTooQuickly) {
  Walk walk = still_head({{0, 0}, {120, 0}});
  walk.look_yaw_deg = 45.0;
  walk.look_pitch_deg = 15.0;
  const HeadMotion motion(walk, flat);
  double fastest = 0.0;
  double left = 0.0;
  double right = 0.0;
  for (const double time : times_until(motion.duration(), 0.01)) {
    fastest = std::max(fastest, angular_rate(motion, time).norm() * kDegrees);
    const Vector3d ahead = motion(time).linear().col(2);
    left = std::max(left, std::atan2(ahead.y(), ahead.x()) * kDegrees);
    right = std::max(right, -std::atan2(ahead.y(), ahead.x()) * kDegrees);
  }
  EXPECT_GT(fastest, 60.0);
  EXPECT_LE(fastest, 100.1);
  EXPECT_GT(left, 25.0);
  EXPECT_GT(right, 25.0);
  EXPECT_LE(std::max(left, right), 45.0 + 1e-6);
}

TEST(HeadMotion, TheSeedChoosesTheLooks) {
  Walk walk = winding(30.0);
  const HeadMotion first(walk, flat);
  const HeadMotion same(walk, flat);
  walk.seed = 2;
  const HeadMotion other(walk, flat);
  EXPECT_EQ(first(10.0).matrix(), same(10.0).matrix());
  EXPECT_GT((first(10.0).linear() - other(10.0).linear()).norm(), 0.01);
}

TEST(HeadMotion, WalksOfAllFamiliesLastAsLongAsAskedWithRoundedCorners) {
  for (const Family& family : families()) {
    for (const double asked : {1.0, 25.0}) {
      for (int seed = 1; seed <= 8; ++seed) {
        const World world = make_world(family.name, seed, asked);
        EXPECT_GE(HeadMotion(world.walk, flat).duration(), asked) << family.name << " " << seed;
      }
    }
  }
}

TEST(HeadMotion, RefusesWalksThatCannotBeWalked) {
  const auto error = [](const Walk& walk) {
    return test::error_of<std::invalid_argument>([&] { (void)HeadMotion(walk, flat); });
  };
  test::expect_line_with(error(still_head({})), "walk.waypoints.size() = 0, must be at least 2");
  test::expect_line_with(error(still_head({{0, 0}})), "walk.waypoints.size() = 1");
  test::expect_line_with(error(still_head({{0, 0}, {0, 0}})), "walk.waypoints = 1, must be at least 0.01 m");
  test::expect_line_with(error(still_head({{0, 0}, {std::nan(""), 0}})), "walk.waypoints = 1, must be a finite point");
  Walk walk = winding(10.0);
  walk.speed_mps = 0.0;
  test::expect_line_with(error(walk), "walk.speed_mps = 0, must be 0.01 to 10");
}

}  // namespace
}  // namespace brink::sim
