#include "brink/ego_motion.hpp"

#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "ego_motion/synthetic_room.hpp"
#include "expect_error.hpp"

namespace brink {
namespace {

using test::make_pose;
using test::render_room;

void expect_near(const EgoMotionEstimate& estimate, const Eigen::Isometry3d& truth, double metres, double degrees) {
  ASSERT_TRUE(estimate.motion) << estimate.reason;
  EXPECT_EQ(estimate.reason, "");
  const Eigen::Isometry3d& motion = estimate.motion->current_from_previous;
  EXPECT_LT((motion.translation() - truth.translation()).norm(), metres);
  EXPECT_LT(test::angle_deg(motion.linear() * truth.linear().transpose()), degrees);
  EXPECT_LT(test::squared_error_in_sigmas(*estimate.motion, truth), 60.0);
  EXPECT_GT(estimate.inliers, 12);
  EXPECT_GE(estimate.matches, estimate.inliers);
}

void expect_none(const EgoMotionEstimate& estimate, const std::string& reason) {
  EXPECT_FALSE(estimate.motion);
  EXPECT_FALSE(estimate.velocity);
  test::expect_line_with(estimate.reason, reason);
}

/// The motion is right within its covariance, or there is none and a reason is told.
void expect_right_or_none(const EgoMotionEstimate& estimate, const Eigen::Isometry3d& truth) {
  if (estimate.motion) {
    EXPECT_LT(test::squared_error_in_sigmas(*estimate.motion, truth), 60.0);
  } else {
    EXPECT_NE(estimate.reason, "");
  }
}

/// A calm walk through the room.
Eigen::Isometry3d walk(int frame) {
  return make_pose(0.02 * frame, 0.01 * std::sin(frame), 0.08 * frame, 0.8 * frame, 0.5 * frame);
}
Eigen::Isometry3d walk_motion(int from, int to) { return walk(to).inverse() * walk(from); }

const Frame& walk_frame(int frame) {
  static const std::vector<Frame> frames = [] {
    std::vector<Frame> made;
    made.reserve(8);
    for (int i = 0; i < 8; ++i) made.push_back(render_room(walk(i), i));
    return made;
  }();
  return frames.at(static_cast<std::size_t>(frame));
}

/// An estimator that has seen frames 0 to 3 of the walk.
EgoMotionEstimator walked() {
  EgoMotionEstimator estimator;
  for (int frame = 0; frame <= 3; ++frame) {
    const auto estimate = estimator.estimate(walk_frame(frame));
    EXPECT_EQ(estimate.motion.has_value(), frame > 0) << estimate.reason;
  }
  return estimator;
}

/// The frame with other pictures.
Frame with_pictures(const Frame& frame, const cv::Mat1b& left, const cv::Mat1b& right) {
  return make_frame(left, right, frame.camera, frame.index, frame.time);
}

TEST(EgoMotion, IsEmptyForTheFirstFrame) { expect_none(EgoMotionEstimator().estimate(walk_frame(0)), "first frame"); }

TEST(EgoMotion, IsThatOfTheCameraWithinItsCovariance) {
  EgoMotionEstimator estimator;
  (void)estimator.estimate(walk_frame(0));
  Eigen::Isometry3d accumulated = Eigen::Isometry3d::Identity();
  for (int frame = 1; frame < 8; ++frame) {
    const auto estimate = estimator.estimate(walk_frame(frame));
    expect_near(estimate, walk_motion(frame - 1, frame), 0.004, 0.06);
    accumulated = estimate.motion->current_from_previous * accumulated;
  }
  EXPECT_LT((accumulated.translation() - walk_motion(0, 7).translation()).norm(), 0.008);
}

TEST(EgoMotion, OfACameraThatStandsStillIsNone) {
  EgoMotionEstimator estimator;
  Eigen::Isometry3d accumulated = Eigen::Isometry3d::Identity();
  for (int frame = 0; frame < 8; ++frame) {
    const auto estimate = estimator.estimate(render_room(make_pose(0, 0, 0), frame));
    if (frame == 0) continue;
    expect_near(estimate, Eigen::Isometry3d::Identity(), 0.002, 0.03);
    accumulated = estimate.motion->current_from_previous * accumulated;
  }
  EXPECT_LT(accumulated.translation().norm(), 0.002) << "errors do not add up";
  EXPECT_LT(test::angle_deg(accumulated.linear()), 0.03);
}

TEST(EgoMotion, TellsASmoothedVelocity) {
  EgoMotionEstimator estimator = walked();
  const auto estimate = estimator.estimate(walk_frame(4));
  ASSERT_TRUE(estimate.velocity);
  EXPECT_NEAR(estimate.velocity->translation.z(), 15.0 * walk_motion(3, 4).translation().z(), 0.1);
}

TEST(EgoMotion, FollowsAHeadThatTurnsByAHundredDegreesASecond) {
  EgoMotionEstimator estimator;
  const auto pose = [](int frame) { return make_pose(0, 0, 0.05 * frame, 100.0 / 15.0 * frame); };
  for (int frame = 0; frame < 5; ++frame) {
    const auto estimate = estimator.estimate(render_room(pose(frame), frame));
    if (frame > 0) expect_near(estimate, pose(frame).inverse() * pose(frame - 1), 0.01, 0.1);
  }
}

TEST(EgoMotion, IsNotThatOfAPasserByWhoFillsAThirdOfThePicture) {
  EgoMotionEstimator estimator;
  for (int frame = 0; frame < 6; ++frame) {
    const test::PasserBy passer_by{{-0.6 + 0.08 * frame, 0.0, 2.0}, 0.5, 0.9};
    const auto estimate = estimator.estimate(render_room(walk(frame), frame, passer_by));
    if (frame > 0) expect_near(estimate, walk_motion(frame - 1, frame), 0.008, 0.1);
  }
}

TEST(EgoMotion, IsEmptyWhileALensIsCovered) {
  EgoMotionEstimator estimator = walked();
  cv::Mat1b covered(test::room_size());
  cv::RNG random(3);
  random.fill(covered, cv::RNG::NORMAL, 4.0, 2.0);
  expect_none(estimator.estimate(with_pictures(walk_frame(4), covered, walk_frame(4).right)), "");
  expect_none(estimator.estimate(walk_frame(5)), "");
  expect_near(estimator.estimate(walk_frame(6)), walk_motion(5, 6), 0.006, 0.1);
}

TEST(EgoMotion, IsEmptyForBlackPictures) {
  EgoMotionEstimator estimator = walked();
  const cv::Mat1b black(test::room_size(), uchar{0});
  expect_none(estimator.estimate(with_pictures(walk_frame(4), black, black)), "no texture");
  expect_none(estimator.estimate(walk_frame(5)), "too few matches");
  expect_near(estimator.estimate(walk_frame(6)), walk_motion(5, 6), 0.006, 0.1);
}

TEST(EgoMotion, IsEmptyWhileTheRightEyeIsFrozen) {
  EgoMotionEstimator estimator = walked();
  expect_none(estimator.estimate(with_pictures(walk_frame(4), walk_frame(4).left, walk_frame(3).right)), "frozen");
  expect_none(estimator.estimate(with_pictures(walk_frame(5), walk_frame(5).left, walk_frame(3).right)), "frozen");
  expect_none(estimator.estimate(walk_frame(6)), "");
  expect_near(estimator.estimate(walk_frame(7)), walk_motion(6, 7), 0.006, 0.1);
}

TEST(EgoMotion, IsEmptyWhenTheRightEyeLagsBehindWhileTheHeadNods) {
  const auto pose = [](int frame) { return make_pose(0, 0, 0.05 * frame, 1.0 * frame, 2.0 * frame); };
  EgoMotionEstimator estimator;
  Frame last = render_room(pose(0), 0);
  for (int frame = 1; frame < 5; ++frame) {
    const Frame now = render_room(pose(frame), frame);
    const auto estimate = estimator.estimate(with_pictures(now, now.left, last.right));
    if (frame > 1) expect_none(estimate, "");
    last = now;
  }
}

TEST(EgoMotion, IsEmptyWhenTheEyesAreSwapped) {
  EgoMotionEstimator estimator = walked();
  expect_none(estimator.estimate(with_pictures(walk_frame(4), walk_frame(4).right, walk_frame(4).left)), "");
  expect_none(estimator.estimate(with_pictures(walk_frame(5), walk_frame(5).right, walk_frame(5).left)), "");
  expect_none(estimator.estimate(walk_frame(6)), "");
  expect_near(estimator.estimate(walk_frame(7)), walk_motion(6, 7), 0.006, 0.1);
}

/// The motion is empty with a reason or right within its covariance, and the frame after is measured again.
void expect_no_lie(const Eigen::Isometry3d& jump) {
  EgoMotionEstimator estimator = walked();
  expect_right_or_none(estimator.estimate(render_room(jump, 20)), jump.inverse() * walk(3));
  const Eigen::Isometry3d next = jump * make_pose(0.01, 0.0, 0.06, 0.5);
  expect_near(estimator.estimate(render_room(next, 21)), next.inverse() * jump, 0.006, 0.1);
}

TEST(EgoMotion, DoesNotLieAfterASecondWithoutPictures) { expect_no_lie(make_pose(0.3, 0.02, 1.4, 12.0, 4.0)); }

TEST(EgoMotion, DoesNotLieAboutAJumpOfFortyDegrees) { expect_no_lie(walk(3) * make_pose(0, 0, 0, 40.0)); }

TEST(EgoMotion, IsEmptyWhenTheCameraOrTheSizeChanges) {
  EgoMotionEstimator estimator = walked();
  Frame other = walk_frame(4);
  other.camera.focal *= 1.01;
  expect_none(estimator.estimate(other), "the camera changed");
  expect_none(estimator.estimate(walk_frame(5)), "the camera changed");
  expect_near(estimator.estimate(walk_frame(6)), walk_motion(5, 6), 0.006, 0.1);
  const cv::Rect part(0, 0, 300, 170);
  expect_none(
      estimator.estimate(with_pictures(walk_frame(7), walk_frame(7).left(part).clone(), walk_frame(7).right(part).clone())),
      "the size of the pictures changed");
}

TEST(EgoMotion, IsEmptyWhenTheGyroscopeDisagrees) {
  for (const double wrong_deg : {0.0, 10.0}) {
    EgoMotionEstimator estimator = walked();
    Frame frame = walk_frame(4);
    frame.current_from_previous_rotation = make_pose(0, 0, 0, wrong_deg).linear() * walk_motion(3, 4).linear();
    const auto estimate = estimator.estimate(frame);
    if (wrong_deg == 0.0) expect_near(estimate, walk_motion(3, 4), 0.006, 0.1);
    if (wrong_deg > 0.0) expect_none(estimate, "gyroscope");
  }
}

TEST(EgoMotion, IgnoresTheGyroscopeWhenTheFrameBeforeIsMissing) {
  EgoMotionEstimator estimator = walked();
  Frame frame = walk_frame(5);  // 4 is missing: the gyroscope tells of the turn from 4 to 5
  frame.current_from_previous_rotation = make_pose(0, 0, 0, 20.0).linear();
  expect_near(estimator.estimate(frame), walk_motion(3, 5), 0.008, 0.1);
}

TEST(EgoMotion, IsAmbiguousWhenTheLimitOfItsUncertaintyIsStrict) {
  EgoMotionParams params;
  params.max_translation_sd_m = 1e-5;
  EgoMotionEstimator estimator(params);
  (void)estimator.estimate(walk_frame(0));
  expect_none(estimator.estimate(walk_frame(1)), "ambiguous");
}

TEST(EgoMotion, TakesFramesWhoseTimeStandsStill) {
  EgoMotionEstimator estimator;
  for (int i = 0; i < 3; ++i) {
    Frame frame = walk_frame(i);
    frame.time = 0.0;
    const auto estimate = estimator.estimate(frame);
    EXPECT_FALSE(estimate.velocity);
    if (i > 0) expect_near(estimate, walk_motion(i - 1, i), 0.006, 0.1);
  }
}

std::vector<EgoMotionEstimate> estimate_walk(std::size_t threads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  EgoMotionEstimator estimator;
  std::vector<EgoMotionEstimate> estimates;
  estimates.reserve(8);
  for (int frame = 0; frame < 8; ++frame) estimates.push_back(estimator.estimate(walk_frame(frame)));
  return estimates;
}

TEST(EgoMotion, IsTheSameForAnyNumberOfThreadsAndAnyRun) {
  const auto one = estimate_walk(1);
  for (const auto& other : {estimate_walk(4), estimate_walk(1)}) {
    for (std::size_t i = 1; i < one.size(); ++i) {
      ASSERT_TRUE(one[i].motion && other[i].motion);
      EXPECT_EQ(one[i].motion->current_from_previous.matrix(), other[i].motion->current_from_previous.matrix());
      EXPECT_EQ(one[i].motion->covariance, other[i].motion->covariance);
      EXPECT_EQ(one[i].inliers, other[i].inliers);
    }
  }
}

TEST(EgoMotion, TakesTheSmallestFrameAndRefusesWhatMakeFrameWouldRefuse) {
  EgoMotionEstimator estimator;
  const cv::Mat1b small(kMinImageHeight, kMinImageWidth, uchar{40});
  Frame frame = make_frame(small, small, test::room_camera());
  expect_none(estimator.estimate(frame), "first frame");
  expect_none(estimator.estimate(frame), "no texture");
  for (const cv::Size size : {cv::Size(0, 0), cv::Size(1, 1), cv::Size(kMinImageWidth, kMinImageHeight - 1)}) {
    frame.left = cv::Mat1b(size, uchar{0});
    frame.right = cv::Mat1b(size, uchar{0});
    EXPECT_THROW((void)estimator.estimate(frame), std::invalid_argument) << size;
  }
  frame.left = small;
  EXPECT_THROW((void)estimator.estimate(frame), std::invalid_argument) << "sizes differ";
}

TEST(EgoMotionParams, AreCheckedByName) {
  EgoMotionParams params;
  params.min_inliers = 2;
  test::expect_line_with(test::error_of<std::invalid_argument>([&] { EgoMotionEstimator{params}; }),
                         "ego_motion.min_inliers = 2, must be 6 to");
  params = {};
  params.match_ratio = std::nan("");
  test::expect_line_with(test::error_of<std::invalid_argument>([&] { params.validate(); }), "ego_motion.match_ratio");
}

}  // namespace
}  // namespace brink
