#include "brink/walking.hpp"

#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

namespace brink {
namespace {

constexpr double kStep = 1.0 / 15.0;  // s

/// A camera at 1.6 m that looks 30 degrees down.
const StereoCamera kCamera{.focal = 350.0, .cx = 319.5, .cy = 179.5, .baseline = 0.15};
const GroundPose kGround = compute_ground_pose(make_ground_plane(1.6, 30.0, 0.0, kCamera), kCamera);

/// A place on the ground, m ahead and to the right of the camera's foot.
Eigen::Vector3d on_ground(double ahead, double right) {
  return kGround.down * kGround.height_m + kGround.forward * ahead + kGround.right * right;
}

/// The rim of an opening of 1 x 1 m.
std::vector<Eigen::Vector3d> square(double ahead, double right) {
  return {on_ground(ahead, right - 0.5), on_ground(ahead, right + 0.5), on_ground(ahead + 1.0, right + 0.5),
          on_ground(ahead + 1.0, right - 0.5)};
}

Eigen::Isometry3d walked(const Eigen::Vector3d& by) { return Eigen::Isometry3d(Eigen::Translation3d(-by)); }

TEST(WalkEstimator, AveragesTheSwayOfAHead) {
  WalkEstimator walk;
  walk.update(std::nullopt, 0.0);
  EXPECT_FALSE(walk.velocity());
  // 1.2 m/s ahead; two steps a second, each of which moves the head 3 cm up and to one side.
  const auto place = [](int i) {
    const double phase = 2.0 * std::numbers::pi * i * kStep;
    return Eigen::Vector3d(kGround.forward * (1.2 * i * kStep) + kGround.right * (0.03 * std::sin(phase)) -
                           kGround.down * (0.03 * std::sin(2.0 * phase)));
  };
  for (int i = 1; i <= 30; ++i) {
    walk.update(walked(place(i) - place(i - 1)), i * kStep);
    EXPECT_EQ(walk.velocity().has_value(), i >= 8) << i << ": half a second";
    if (i >= 15) {
      EXPECT_LT((*walk.velocity() - 1.2 * kGround.forward).norm(), 1e-6) << i;
    }
  }
}

TEST(WalkEstimator, KnowsTheWalkWhileTheHeadTurns) {
  WalkEstimator walk;
  walk.update(std::nullopt, 0.0);
  const Eigen::AngleAxisd turn(-0.05, kGround.down);  // the head turns to the right, the feet go on
  Eigen::Vector3d velocity = 1.2 * kGround.forward;
  for (int i = 1; i <= 15; ++i) {
    walk.update(Eigen::Isometry3d(turn) * walked(velocity * kStep), i * kStep);
    velocity = turn * velocity;
  }
  EXPECT_LT((*walk.velocity() - velocity).norm(), 1e-6);
  EXPECT_LT(kGround.right.dot(velocity), -0.5) << "as the camera sees it, the walk goes to the left";
}

TEST(WalkEstimator, ForgetsAWalkThatItLostSightOf) {
  WalkEstimator walk;
  for (int i = 0; i < 15; ++i) walk.update(walked(kGround.forward * 0.1), i * kStep);
  EXPECT_TRUE(walk.velocity());
  walk.update(std::nullopt, 15 * kStep);
  EXPECT_FALSE(walk.velocity());
}

TEST(TimeToEdge, IsTheDistanceAlongThePathOverTheSpeed) {
  const Eigen::Vector3d velocity = 1.2 * kGround.forward + 0.3 * kGround.down;  // nodding up and down tells nothing
  EXPECT_NEAR(*compute_time_to_edge(square(3.0, 0.0), velocity, kGround, 0.6), 2.5, 1e-6);
  EXPECT_NEAR(*compute_time_to_edge(square(3.0, 0.75), velocity, kGround, 0.6), 2.5, 1e-6) << "a foot would hit its corner";
  EXPECT_EQ(*compute_time_to_edge(square(-0.5, 0.0), velocity, kGround, 0.6), 0.0) << "over it";
}

TEST(TimeToEdge, IsToldOfWhatLiesInTheWayOnly) {
  const Eigen::Vector3d velocity = 1.2 * kGround.forward;
  EXPECT_FALSE(compute_time_to_edge(square(3.0, 0.85), velocity, kGround, 0.6)) << "beside the path";
  EXPECT_FALSE(compute_time_to_edge(square(-1.5, 0.0), velocity, kGround, 0.6)) << "behind";
  EXPECT_FALSE(compute_time_to_edge(square(3.0, 0.0), 0.1 * kGround.forward, kGround, 0.6)) << "at rest";
  EXPECT_FALSE(compute_time_to_edge({}, velocity, kGround, 0.6));
  const Eigen::Vector3d aslant = kGround.forward + kGround.right;  // 45 degrees to the right
  EXPECT_FALSE(compute_time_to_edge(square(3.0, 0.0), aslant, kGround, 0.6));
  EXPECT_NEAR(*compute_time_to_edge(square(3.0, 3.5), aslant, kGround, 0.6), 3.0, 0.01);
}

}  // namespace
}  // namespace brink
