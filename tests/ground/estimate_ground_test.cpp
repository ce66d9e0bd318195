#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "brink/ground.hpp"
#include "synthetic_scene.hpp"

namespace brink {
namespace {

void expect_pose(const GroundEstimate& estimate, double height_m, double pitch_deg, double roll_deg) {
  ASSERT_TRUE(estimate.plane) << estimate.reason;
  EXPECT_NEAR(estimate.pose.height_m, height_m, 0.01 * height_m);
  EXPECT_NEAR(estimate.pose.pitch_deg, pitch_deg, 0.3);
  EXPECT_NEAR(estimate.pose.roll_deg, roll_deg, 0.3);
}

TEST(EstimateGround, FindsHeightPitchAndRollOfANoisyPlane) {
  const StereoCamera camera = test::half_size_camera();
  for (const double height : {0.5, 1.2, 1.7}) {
    for (const double pitch : {0.0, 15.0, 40.0, 55.0}) {
      for (const double roll : {-20.0, -3.7, 0.0, 10.0}) {
        SCOPED_TRACE(testing::Message() << height << " m, pitch " << pitch << ", roll " << roll);
        cv::Mat1f disparity = test::make_disparity(camera, test::half_size(), make_ground_plane(height, pitch, roll, camera));
        test::degrade(disparity, 0.3, 0.3, 1);
        const GroundEstimate estimate = estimate_ground(disparity, camera);
        EXPECT_EQ(estimate.state, GroundState::seen) << estimate.reason;
        EXPECT_NEAR(estimate.residual_px, 0.3, 0.1);
        expect_pose(estimate, height, pitch, roll);
      }
    }
  }
}

TEST(EstimateGround, NothingToSeeIsNotVisibleWithAReason) {
  const StereoCamera camera = test::half_size_camera();
  for (const cv::Size& size : {cv::Size(0, 0), cv::Size(1, 1), cv::Size(33, 35), test::half_size()}) {
    const GroundEstimate estimate = estimate_ground(cv::Mat1f(size, kInvalidDisparity), camera);
    EXPECT_EQ(estimate.state, GroundState::not_visible);
    EXPECT_FALSE(estimate.plane);
    EXPECT_FALSE(estimate.reason.empty());
  }
}

TEST(EstimateGround, AWallInFrontIsNotGround) {
  const StereoCamera camera = test::half_size_camera();
  for (const float d : {15.0F, 30.0F, 60.0F}) {
    cv::Mat1f disparity(test::half_size(), d);
    test::degrade(disparity, 0.3, 0.2, 2);
    EXPECT_EQ(estimate_ground(disparity, camera).state, GroundState::not_visible) << "wall at " << d << " px";
  }
}

TEST(EstimateGround, NoiseIsNotGround) {
  const StereoCamera camera = test::half_size_camera();
  cv::Mat1f disparity(test::half_size());
  cv::setRNGSeed(3);
  cv::randu(disparity, 1.0F, 100.0F);
  EXPECT_EQ(estimate_ground(disparity, camera).state, GroundState::not_visible);
}

TEST(EstimateGround, ObstaclesMayCoverHalfOfTheLowerPicture) {
  const StereoCamera camera = test::half_size_camera();
  const GroundPlane plane = make_ground_plane(1.6, 25.0, 4.0, camera);
  cv::Mat1f disparity = test::make_disparity(camera, test::half_size(), plane);
  disparity(cv::Rect(0, 120, 200, 240)).setTo(45.0F);   // a box and
  disparity(cv::Rect(420, 60, 120, 300)).setTo(38.0F);  // a person, both upright and facing the camera
  test::degrade(disparity, 0.3, 0.2, 4);
  const GroundEstimate estimate = estimate_ground(disparity, camera);
  EXPECT_EQ(estimate.state, GroundState::seen);
  expect_pose(estimate, 1.6, 25.0, 4.0);
}

TEST(EstimateGround, APlatformIsTheGroundAndItsTrackBedIsNot) {
  const StereoCamera camera = test::half_size_camera();
  for (const double rim_m : {1.8, 2.5, 3.5}) {
    for (const double height : {1.0, 1.4, 1.7}) {
      SCOPED_TRACE(testing::Message() << "rim at " << rim_m << " m, camera " << height << " m");
      const GroundPlane plane = make_ground_plane(height, 30.0, 0.0, camera);
      cv::Mat1f disparity = test::make_disparity(camera, test::half_size(), plane, {{rim_m, 100.0, -100.0, 100.0, 1.0}});
      test::degrade(disparity, 0.3, 0.2, 5);
      expect_pose(estimate_ground(disparity, camera), height, 30.0, 0.0);
    }
  }
}

TEST(EstimateGround, GravityRulesOutASlopeThatNobodyWalksOn) {
  const StereoCamera camera = test::half_size_camera();
  const GroundPlane plane = make_ground_plane(1.6, 30.0, 0.0, camera);
  cv::Mat1f disparity = test::make_disparity(camera, test::half_size(), plane);
  test::degrade(disparity, 0.3, 0.2, 6);
  const Eigen::Vector3d down = compute_ground_pose(plane, camera).down;
  EXPECT_EQ(estimate_ground(disparity, camera, {}, 9.81 * down).state, GroundState::seen);
  const Eigen::Vector3d level = compute_ground_pose(make_ground_plane(1.6, 5.0, 0.0, camera), camera).down;
  EXPECT_EQ(estimate_ground(disparity, camera, {}, level).state, GroundState::not_visible);
}

TEST(EstimateGround, AWrongPreviousGroundCannotStick) {
  const StereoCamera camera = test::half_size_camera();
  cv::Mat1f disparity = test::make_disparity(camera, test::half_size(), make_ground_plane(1.6, 25.0, 0.0, camera));
  test::degrade(disparity, 0.3, 0.2, 7);
  for (const GroundPlane& previous :
       {make_ground_plane(2.4, 25.0, 0.0, camera), make_ground_plane(0.8, 40.0, 15.0, camera), GroundPlane{}}) {
    expect_pose(estimate_ground(disparity, camera, {}, std::nullopt, previous), 1.6, 25.0, 0.0);
  }
}

TEST(EstimateGround, IsTheSameFromRunToRun) {
  const StereoCamera camera = test::half_size_camera();
  cv::Mat1f disparity = test::make_disparity(camera, test::half_size(), make_ground_plane(1.6, 25.0, 3.0, camera));
  test::degrade(disparity, 0.5, 0.5, 8);
  const GroundEstimate first = estimate_ground(disparity, camera);
  const GroundEstimate second = estimate_ground(disparity, camera);
  EXPECT_EQ(first.plane->a, second.plane->a);
  EXPECT_EQ(first.plane->b, second.plane->b);
  EXPECT_EQ(first.plane->c, second.plane->c);
}

TEST(EstimateGround, LittleGroundIsUncertain) {
  const StereoCamera camera = test::half_size_camera();
  cv::Mat1f disparity = test::make_disparity(camera, test::half_size(), make_ground_plane(1.6, 25.0, 0.0, camera));
  test::degrade(disparity, 0.3, 0.85, 9);
  const GroundEstimate estimate = estimate_ground(disparity, camera);
  EXPECT_EQ(estimate.state, GroundState::uncertain);
  EXPECT_FALSE(estimate.reason.empty());
  expect_pose(estimate, 1.6, 25.0, 0.0);
}

TEST(EstimateGround, WrongArgumentsAreNamed) {
  const StereoCamera camera = test::half_size_camera();
  const cv::Mat1f disparity(test::half_size(), 10.0F);
  GroundParams params;
  params.tolerance_px = 0.0;
  try {
    estimate_ground(disparity, camera, params);
    FAIL() << "tolerance_px = 0 was taken";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "ground.tolerance_px = 0, must be above 0 to 20");
  }
  EXPECT_THROW(estimate_ground(disparity, StereoCamera{}), std::invalid_argument);
  EXPECT_THROW(estimate_ground(disparity, camera, {}, Eigen::Vector3d::Zero()), std::invalid_argument);
}

}  // namespace
}  // namespace brink
