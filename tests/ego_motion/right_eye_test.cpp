#include "ego_motion/right_eye.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "ego_motion/synthetic_room.hpp"

namespace brink {
namespace {

/// d = 60 + 0.1 u - 0.2 v.
cv::Mat1f make_slope(const cv::Size& size) {
  cv::Mat1f disparity(size);
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) disparity(v, u) = 60.0F + 0.1F * static_cast<float>(u) - 0.2F * static_cast<float>(v);
  }
  return disparity;
}

TEST(ReadDisparityAt, ReadsAPlaneBetweenPixels) {
  const auto reading = read_disparity_at(make_slope({31, 23}), {10.25, 8.5});
  ASSERT_TRUE(reading);
  EXPECT_NEAR(reading->disparity, 60.0 + 1.025 - 1.7, 1e-5);
  EXPECT_NEAR(std::sqrt(reading->variance), 0.03, 1e-6) << "never better than what interpolation leaves";
}

TEST(ReadDisparityAt, ToleratesAQuarterOfHoles) {
  cv::Mat1f disparity = make_slope({31, 23});
  for (int i = 0; i < 12; ++i) disparity(8 + (i % 4) - 2, 10 + i / 4 - 1) = kInvalidDisparity;
  const auto reading = read_disparity_at(disparity, {10.0, 8.0});
  ASSERT_TRUE(reading) << "12 of 49 pixels have none";
  EXPECT_NEAR(reading->disparity, 60.0 + 1.0 - 1.6, 1e-4);
  disparity(5, 7) = kInvalidDisparity;
  EXPECT_FALSE(read_disparity_at(disparity, {10.0, 8.0})) << "13 of 49";
}

TEST(ReadDisparityAt, IsEmptyAtDepthEdges) {
  cv::Mat1f disparity(30, 30, 10.0F);
  disparity.colRange(15, 30) = 16.0F;
  EXPECT_FALSE(read_disparity_at(disparity, {14.0, 10.0}));
  EXPECT_FALSE(read_disparity_at(disparity, {16.0, 10.0}));
  EXPECT_NEAR(read_disparity_at(disparity, {11.0, 10.0}).value().disparity, 10.0, 1e-9);
  EXPECT_NEAR(read_disparity_at(disparity, {18.0, 10.0}).value().disparity, 16.0, 1e-9);
}

TEST(ReadDisparityAt, IsEmptyAtTheBorderAndWithoutDisparities) {
  const cv::Mat1f disparity = make_slope({31, 23});
  for (const Eigen::Vector2d& place : {Eigen::Vector2d(2.4, 10), Eigen::Vector2d(28, 10), Eigen::Vector2d(10, 2),
                                       Eigen::Vector2d(10, 20), Eigen::Vector2d(-50, 1e6)}) {
    EXPECT_FALSE(read_disparity_at(disparity, place)) << place.transpose();
  }
  EXPECT_TRUE(read_disparity_at(disparity, {3, 3}));
  EXPECT_TRUE(read_disparity_at(disparity, {27, 19}));
  EXPECT_FALSE(read_disparity_at(cv::Mat1f(9, 9, kInvalidDisparity), {4, 4}));
  EXPECT_FALSE(read_disparity_at(cv::Mat1f(), {0, 0}));
  EXPECT_FALSE(read_disparity_at(cv::Mat1f(1, 1, 3.0F), {0, 0}));
}

TEST(ReadDisparityAt, TellsTheNoise) {
  std::mt19937 random(3);
  std::normal_distribution<float> noise(0.0F, 0.3F);
  cv::Mat1f disparity = make_slope({200, 200});
  for (float& d : disparity) d += noise(random);
  double told = 0.0;
  double made = 0.0;
  int count = 0;
  for (int v = 5; v < 195; v += 7) {
    for (int u = 5; u < 195; u += 7, ++count) {
      const auto reading = read_disparity_at(disparity, {u, v});
      ASSERT_TRUE(reading);
      told += reading->variance;
      made += std::pow(reading->disparity - (60.0 + 0.1 * u - 0.2 * v), 2);
    }
  }
  // Independent pixels: sigma^2 / 49. What is told takes nine neighbours for alike.
  EXPECT_NEAR(std::sqrt(made / count), 0.3 / 7.0, 0.01);
  EXPECT_NEAR(std::sqrt(told / count), 3.0 * 0.3 / 7.0, 0.02);
}

TEST(FindRightFeatures, MovesThoseWithADisparity) {
  const Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const Frame seen = test::render_room(pose, 0);
  cv::Mat1f disparity = disparity_from_depth(test::render_room_depth(pose), test::room_camera());
  disparity.colRange(0, 160) = kInvalidDisparity;
  const Frame frame = make_frame_with_disparity(seen.left, disparity, test::room_camera());
  const std::vector<Feature> left = find_features(frame.left, {});
  const std::vector<Feature> right = find_right_features(frame, left, {});
  ASSERT_GT(right.size(), 20U);
  EXPECT_LT(right.size(), left.size());
  std::size_t i = 0;
  for (const Feature& moved : right) {
    while (left[i].descriptor != moved.descriptor || left[i].position.y != moved.position.y) ++i;
    EXPECT_GE(left[i].position.x, 160.0F - 3.0F);
    EXPECT_NEAR(left[i].position.x - moved.position.x, disparity(cv::Point(left[i].position)), 0.1);
  }
}

TEST(FindInRight, ByADisparityImageSharesTheErrorsOfTheLeft) {
  const cv::Mat1f disparity = make_slope({64, 48});
  cv::Mat1b picture(48, 64);
  cv::RNG(1).fill(picture, cv::RNG::UNIFORM, 0, 256);
  const auto patch = make_patch(picture, {30, 20});
  ASSERT_TRUE(patch);
  const Alignment left{{30.0, 20.0}, 0.01 * Eigen::Matrix2d::Identity()};
  const auto place =
      find_in_right({picture, {}, disparity}, {{left, {&*patch, {0.0, 0.0}, Eigen::Matrix2d::Identity()}}}).front();
  ASSERT_TRUE(place);
  EXPECT_NEAR(place->position.x(), 30.0 - 59.0, 1e-5);  // 60 + 3 - 4
  EXPECT_EQ(place->position.y(), 20.0);
  // The variance of u_left - u_right is that of the disparity alone.
  const Eigen::Vector4d difference(1.0, 0.0, -1.0, 0.0);
  EXPECT_NEAR(difference.dot(place->covariance * difference), 0.03 * 0.03, 1e-6);
  EXPECT_NEAR(place->covariance(0, 0), 0.01 + 0.03 * 0.03, 1e-9);
  EXPECT_GT(place->covariance(3, 3), 1000.0) << "no row was measured";
}

}  // namespace
}  // namespace brink
