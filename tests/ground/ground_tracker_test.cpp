#include <cmath>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "brink/ground_tracking.hpp"
#include "floor_profile.hpp"
#include "synthetic_scene.hpp"

namespace brink {
namespace {

using test::FloorProfile;
using test::Stand;

constexpr double kStepS = 1.0 / 7.0;

/// What is known of the motion while a bearer goes from stand to stand.
enum class Known { motion, gravity, nothing };

std::vector<GroundEstimate> track(const FloorProfile& profile, const std::vector<Stand>& stands, Known known = Known::motion,
                                  const StereoCamera& camera = test::half_size_camera()) {
  GroundTracker tracker;
  std::vector<GroundEstimate> grounds;
  for (std::size_t i = 0; i < stands.size(); ++i) {
    const cv::Mat1f disparity =
        test::make_disparity(profile, stands[i], camera, test::half_size(), 0.1, static_cast<unsigned>(i));
    const Eigen::Isometry3d world_from_camera = stands[i].world_from_camera();
    std::optional<Eigen::Vector3d> gravity;
    if (known == Known::gravity) gravity = world_from_camera.linear().transpose() * Eigen::Vector3d::UnitY();
    MotionHint motion;
    if (known == Known::motion && i > 0) {
      motion.current_from_previous = world_from_camera.inverse() * stands[i - 1].world_from_camera();
    }
    tracker.search(disparity, camera, gravity);
    grounds.push_back(tracker.update(motion, static_cast<double>(i) * kStepS));
  }
  return grounds;
}

/// The whole of the flight, and the level that it leads to.
FloorProfile make_stairs(double edge_m, int steps, double rise_m, double tread_m) {
  FloorProfile profile{{0.0, 0.0}};
  for (int i = 0; i < steps; ++i) profile.push_back({edge_m + i * tread_m, (i + 1) * rise_m});
  return profile;
}

TEST(GroundTracker, KeepsTheUpperFloorToTheEdge) {
  for (const double depth_m : {0.75, 1.5}) {
    for (const double pitch_deg : {10.0, 25.0, 40.0}) {
      SCOPED_TRACE(testing::Message() << "drop of " << depth_m << " m, pitch " << pitch_deg);
      const auto stands = test::make_approach(0.0, 2.6, 0.2, {.pitch_deg = pitch_deg});
      for (const GroundEstimate& ground : track({{0.0, 0.0}, {2.9, depth_m}}, stands)) {
        ASSERT_TRUE(ground.plane) << ground.reason;
        EXPECT_NEAR(ground.pose.height_m, 1.6, 0.05);
        EXPECT_NEAR(ground.pose.pitch_deg, pitch_deg, 1.5);
      }
    }
  }
}

TEST(GroundTracker, SaysWhenTheGroundIsCarriedOn) {
  const auto grounds = track({{0.0, 0.0}, {2.9, 0.75}}, test::make_approach(0.0, 2.6, 0.2, {}));
  EXPECT_EQ(grounds.front().state, GroundState::seen);
  EXPECT_FALSE(grounds.front().is_carried);
  EXPECT_EQ(grounds.back().state, GroundState::uncertain);
  EXPECT_TRUE(grounds.back().is_carried);
  EXPECT_FALSE(grounds.back().reason.empty());
  EXPECT_LT(grounds.back().confidence, 0.5);
}

TEST(GroundTracker, KeepsTheUpperFloorWithoutAnyMotion) {
  for (const Known known : {Known::gravity, Known::nothing}) {
    for (const GroundEstimate& ground : track({{0.0, 0.0}, {2.9, 0.75}}, test::make_approach(0.0, 2.6, 0.2, {}), known)) {
      ASSERT_TRUE(ground.plane) << ground.reason;
      EXPECT_NEAR(ground.pose.height_m, 1.6, 0.05);
    }
  }
}

TEST(GroundTracker, GoesDownAFlightWithItsBearer) {
  const FloorProfile stairs = make_stairs(2.0, 6, 0.17, 0.3);
  std::vector<Stand> stands = test::make_approach(0.0, 5.0, 0.1, {});
  for (Stand& stand : stands) {
    double depth_m = 0.0;
    for (const test::Floor& floor : stairs) depth_m = stand.along_m >= floor.from_m ? floor.depth_m : depth_m;
    stand.height_m -= depth_m;
  }
  const auto grounds = track(stairs, stands);
  for (std::size_t i = 0; i < grounds.size(); ++i) {
    ASSERT_TRUE(grounds[i].plane) << grounds[i].reason;
    // On the flight, feet and head are on different steps; a step is not noticed before it is higher than gait.
    EXPECT_NEAR(grounds[i].pose.height_m, 1.6, 0.36) << stands[i].along_m;
  }
  EXPECT_NEAR(grounds.back().pose.height_m, 1.6, 0.05);
  EXPECT_EQ(grounds.back().state, GroundState::seen) << grounds.back().reason;
}

TEST(GroundTracker, GoesUpAndDownAKerbWithItsBearer) {
  for (const double depth_m : {-0.12, 0.12}) {
    std::vector<Stand> stands = test::make_approach(0.0, 5.0, 0.1, {});
    for (Stand& stand : stands) stand.height_m -= stand.along_m >= 3.0 ? depth_m : 0.0;
    const auto grounds = track({{0.0, 0.0}, {3.0, depth_m}}, stands);
    for (const GroundEstimate& ground : grounds) {
      ASSERT_TRUE(ground.plane) << ground.reason;
      EXPECT_NEAR(ground.pose.height_m, 1.6, 0.17);
    }
    EXPECT_NEAR(grounds.back().pose.height_m, 1.6, 0.05);
  }
}

TEST(GroundTracker, StaysOnTheFloorWhenItsBearerCrouches) {
  std::vector<Stand> stands(25);
  for (std::size_t i = 8; i < stands.size(); ++i) stands[i].height_m = std::max(0.9, 1.6 - 0.1 * static_cast<double>(i - 7));
  const auto grounds = track({{0.0, 0.0}, {4.0, 0.7}}, stands);
  for (std::size_t i = 0; i < grounds.size(); ++i) EXPECT_NEAR(grounds[i].pose.height_m, stands[i].height_m, 0.05) << i;
}

TEST(GroundTracker, StartsOnTheFloorAtTheFeet) {
  for (const double ahead_m : {1.4, 1.6, 2.0}) {  // the image begins 1.23 m ahead
    SCOPED_TRACE(testing::Message() << "edge " << ahead_m << " m ahead");
    const auto grounds = track({{0.0, 0.0}, {ahead_m, 0.75}}, std::vector<Stand>(1));
    ASSERT_TRUE(grounds[0].plane) << grounds[0].reason;
    EXPECT_NEAR(grounds[0].pose.height_m, 1.6, 0.05);
  }
}

TEST(GroundTracker, NamesBothHeightsWhenTheFirstFrameShowsTwoFloors) {
  const auto grounds = track({{0.0, 0.0}, {1.5, 0.75}}, std::vector<Stand>(1));
  EXPECT_EQ(grounds[0].state, GroundState::uncertain);
  EXPECT_NE(grounds[0].reason.find("1.6"), std::string::npos) << grounds[0].reason;
  EXPECT_NE(grounds[0].reason.find("2.3"), std::string::npos) << grounds[0].reason;
}

// The first frame shows the lower floor only. The bearer steps back, sees his own floor, and walks on over it.
TEST(GroundTracker, LeavesAWrongStart) {
  std::vector<Stand> stands = test::make_approach(0.0, 2.0, 0.1, {});
  std::ranges::reverse(stands);
  const std::vector<Stand> back = test::make_approach(0.0, 2.0, 0.1, {});
  stands.insert(stands.end(), back.begin(), back.end());
  const auto grounds = track({{0.0, 0.0}, {2.3, 0.75}}, stands);
  EXPECT_NEAR(grounds.front().pose.height_m, 2.35, 0.05) << "nothing else is in the image";
  ASSERT_TRUE(grounds.back().plane) << grounds.back().reason;
  EXPECT_NEAR(grounds.back().pose.height_m, 1.6, 0.05);
}

TEST(GroundTracker, NamesTheLimitThatAPlaneBreaks) {
  const auto reason_of = [](const Stand& stand) {
    const auto grounds = track({{0.0, 0.0}}, {stand});
    EXPECT_EQ(grounds[0].state, GroundState::not_visible);
    return grounds[0].reason;
  };
  EXPECT_NE(reason_of({.pitch_deg = 86.0}).find("ground.max_pitch_deg = 80"), std::string::npos);
  EXPECT_NE(reason_of({.height_m = 4.6, .pitch_deg = 60.0}).find("ground.max_height_m = 4"), std::string::npos);
}

TEST(GroundTracker, FindsCamerasThatPeopleMount) {
  for (const Stand& stand : {Stand{.height_m = 0.15, .pitch_deg = 5.0}, Stand{.height_m = 0.28, .pitch_deg = 20.0},
                             Stand{.height_m = 3.0, .pitch_deg = 45.0}, Stand{.height_m = 1.5, .pitch_deg = 70.0}}) {
    const auto grounds = track({{0.0, 0.0}}, {stand});
    ASSERT_EQ(grounds[0].state, GroundState::seen) << grounds[0].reason;
    EXPECT_NEAR(grounds[0].pose.height_m, stand.height_m, 0.01 * stand.height_m);
    EXPECT_NEAR(grounds[0].pose.pitch_deg, stand.pitch_deg, 0.5);
  }
}

TEST(GroundTracker, HasNoGroundWithoutDisparities) {
  const StereoCamera camera = test::half_size_camera();
  for (const cv::Size& size : {cv::Size(0, 0), cv::Size(1, 1), cv::Size(33, 35)}) {
    const GroundEstimate ground = find_ground(cv::Mat1f(size, kInvalidDisparity), camera);
    EXPECT_EQ(ground.state, GroundState::not_visible);
    EXPECT_FALSE(ground.reason.empty());
  }
}

}  // namespace
}  // namespace brink
