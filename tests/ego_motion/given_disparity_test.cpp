// Ego-motion where a disparity image takes the place of the right picture.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "brink/ego_motion.hpp"
#include "ego_motion/synthetic_room.hpp"
#include "expect_error.hpp"

namespace brink {
namespace {

using test::make_pose;

Eigen::Isometry3d walk(int frame) {
  return make_pose(0.02 * frame, 0.01 * std::sin(frame), 0.08 * frame, 0.8 * frame, 0.5 * frame);
}
Eigen::Isometry3d walk_motion(int from, int to) { return walk(to).inverse() * walk(from); }

/// A depth sensor: whole millimetres, noise of 0.5 % at 1 m that grows with the square of the depth, a hole at each step.
cv::Mat1f degraded(const cv::Mat1f& depth_m, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 0.005);
  cv::Mat1f sensed(depth_m.size(), 0.0F);
  for (int v = 1; v + 1 < depth_m.rows; ++v) {
    for (int u = 1; u + 1 < depth_m.cols; ++u) {
      const double depth = depth_m(v, u);
      const double measured = depth + noise(random) * depth * depth;
      const bool step = std::abs(depth_m(v, u + 1) - depth_m(v, u - 1)) > 0.2F * depth_m(v, u);
      if (!step) sensed(v, u) = static_cast<float>(std::round(1000.0 * measured) / 1000.0);
    }
  }
  return sensed;
}

Frame make_depth_frame(int index, const cv::Mat1f& depth_m) {
  const auto left = test::render_eye(test::room_camera(), test::room_size(), walk(index), 0,
                                     static_cast<unsigned>(2 * index + 1), std::nullopt);
  return make_frame_with_disparity(left, disparity_from_depth(depth_m, test::room_camera()), test::room_camera(), index,
                                   index / 15.0);
}
Frame walk_frame(int index) { return make_depth_frame(index, test::render_room_depth(walk(index))); }

void expect_near(const EgoMotionEstimate& estimate, const Eigen::Isometry3d& truth, double metres, double degrees) {
  ASSERT_TRUE(estimate.motion) << estimate.reason;
  const Eigen::Isometry3d& motion = estimate.motion->current_from_previous;
  EXPECT_LT((motion.translation() - truth.translation()).norm(), metres);
  EXPECT_LT(test::angle_deg(motion.linear() * truth.linear().transpose()), degrees);
  EXPECT_LT(test::squared_error_in_sigmas(*estimate.motion, truth), 60.0);
  EXPECT_GT(estimate.inliers, 12);
}

TEST(EgoMotionFromDepth, IsThatOfTheCameraWithinItsCovariance) {
  EgoMotionEstimator estimator;
  (void)estimator.estimate(walk_frame(0));
  for (int frame = 1; frame < 8; ++frame)
    expect_near(estimator.estimate(walk_frame(frame)), walk_motion(frame - 1, frame), 0.003, 0.06);
}

TEST(EgoMotionFromDepth, SurvivesTheNoiseAndHolesOfADepthSensor) {
  EgoMotionEstimator estimator;
  Eigen::Isometry3d accumulated = Eigen::Isometry3d::Identity();
  for (int frame = 0; frame < 8; ++frame) {
    const Frame sensed =
        make_depth_frame(frame, degraded(test::render_room_depth(walk(frame)), static_cast<unsigned>(frame + 1)));
    const auto estimate = estimator.estimate(sensed);
    if (frame == 0) continue;
    expect_near(estimate, walk_motion(frame - 1, frame), 0.01, 0.1);
    accumulated = estimate.motion->current_from_previous * accumulated;
  }
  EXPECT_LT((accumulated.translation() - walk_motion(0, 7).translation()).norm(), 0.02);
}

TEST(EgoMotionFromDepth, IsEmptyWithoutDisparitiesAndSaysSo) {
  EgoMotionEstimator estimator;
  for (int frame = 0; frame < 2; ++frame) (void)estimator.estimate(walk_frame(frame));
  const auto estimate = estimator.estimate(make_depth_frame(2, cv::Mat1f(test::room_size(), 0.0F)));
  EXPECT_FALSE(estimate.motion);
  test::expect_line_with(estimate.reason, "the disparity image tells too little: 0 features have a disparity");
}

TEST(EgoMotionFromDepth, IsEmptyBetweenAPairAndADisparityImage) {
  EgoMotionEstimator estimator;
  (void)estimator.estimate(test::render_room(walk(0), 0));
  const auto estimate = estimator.estimate(walk_frame(1));
  EXPECT_FALSE(estimate.motion);
  EXPECT_EQ(estimate.reason, "disparities are given for one of the frames only");
  expect_near(estimator.estimate(walk_frame(2)), walk_motion(1, 2), 0.006, 0.1);
}

TEST(EgoMotionFromDepth, IsEmptyWithoutAPictureAndForgetsWhatWasBefore) {
  EgoMotionEstimator estimator;
  for (int frame = 0; frame < 2; ++frame) (void)estimator.estimate(walk_frame(frame));
  Frame blind = walk_frame(2);
  blind.left = cv::Mat1b();
  const auto estimate = estimator.estimate(blind);
  EXPECT_FALSE(estimate.motion);
  EXPECT_EQ(estimate.reason, "no left picture");
  EXPECT_EQ(estimator.estimate(walk_frame(3)).reason, "first frame");
  expect_near(estimator.estimate(walk_frame(4)), walk_motion(3, 4), 0.006, 0.1);
}

TEST(EgoMotionFromDepth, DoesNotFollowADepthImageThatBelongsToAnotherPicture) {
  EgoMotionEstimator estimator;
  for (int frame = 0; frame < 3; ++frame) (void)estimator.estimate(walk_frame(frame));
  const auto estimate = estimator.estimate(make_depth_frame(3, test::render_room_depth(make_pose(1.5, 0.5, 4.0, 60.0))));
  if (estimate.motion) {
    EXPECT_LT(test::squared_error_in_sigmas(*estimate.motion, walk_motion(2, 3)), 60.0);
  } else {
    EXPECT_NE(estimate.reason, "");
  }
}

}  // namespace
}  // namespace brink
