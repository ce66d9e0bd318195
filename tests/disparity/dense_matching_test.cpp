#include "disparity/dense_matching.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "disparity/synthetic.hpp"

namespace brink {
namespace {

/// Four points of one disparity around the middle of a picture.
std::vector<SupportPoint> make_frame_of_points(cv::Size size, int disparity) {
  const int right = size.width - 1;
  const int bottom = size.height - 1;
  return {{disparity, 0, disparity}, {right, 0, disparity}, {disparity, bottom, disparity}, {right, bottom, disparity}};
}

cv::Mat1f match_left(const SyntheticPair& pair, const std::vector<SupportPoint>& points, const ElasParams& params = {}) {
  return match_dense(View::left, DescriptorImage(pair.left), DescriptorImage(pair.right), points, params);
}

int count_valid(const cv::Mat1f& disparity) { return cv::countNonZero(disparity != kInvalidDisparity); }

TEST(DenseMatching, PlaneGoesThroughItsCorners) {
  const std::vector<SupportPoint> points = {{0, 0, 10}, {100, 0, 20}, {0, 50, 15}};
  const PriorPlane plane = fit_planes(View::left, points, {{0, 1, 2}}).front();
  EXPECT_FLOAT_EQ(plane.a, 0.1F);
  EXPECT_FLOAT_EQ(plane.b, 0.1F);
  EXPECT_FLOAT_EQ(plane.c, 10.0F);
  EXPECT_FLOAT_EQ(plane.disparity(100, 0), 20.0F);
  EXPECT_TRUE(plane.reliable);
}

TEST(DenseMatching, SlopeMustBeSmallInBothViews) {
  const auto is_reliable = [](View view, int rise) {
    const std::vector<SupportPoint> points = {{0, 0, 100}, {100, 0, 100 + rise}, {0, 50, 100}};
    return fit_planes(view, points, {{0, 1, 2}}).front().reliable;
  };
  // Slope a in the left view is a / (1 - a) in the right one: 0.40 -> 0.67, 0.45 -> 0.82, -0.60 -> -0.38.
  EXPECT_TRUE(is_reliable(View::left, 40));
  EXPECT_FALSE(is_reliable(View::left, 45));
  EXPECT_TRUE(is_reliable(View::left, -60));
  EXPECT_FALSE(is_reliable(View::left, -75));
  EXPECT_TRUE(is_reliable(View::right, 60));
  EXPECT_FALSE(is_reliable(View::right, -45));
  EXPECT_FALSE(is_reliable(View::left, 100)) << "upright in the right view";
}

TEST(DenseMatching, CandidatesReachTheNeighboringCellsAndStayInRange) {
  ElasParams params;
  params.max_disparity = 30;
  const CandidateGrid grid = make_candidate_grid({{5, 5, 30}, {45, 5, 0}}, {65, 45}, params);  // 4 x 3 cells of 20 px
  EXPECT_EQ(*grid.words_at(0, 0), 0x60000000U);                                                // 29 and 30
  EXPECT_EQ(*grid.words_at(25, 5), 0x60000003U);                                               // 0, 1, 29 and 30
  EXPECT_EQ(*grid.words_at(64, 39), 0x3U);
  EXPECT_EQ(*grid.words_at(0, 44), 0U);
}

/// Up to 3 px from the border a descriptor sees repeated pixels instead of the scene: left out here.
TEST(DenseMatching, WallIsFoundInBothViews) {
  const cv::Size size(91, 47);
  const SyntheticPair pair = make_wall(size, 13);
  const std::vector<SupportPoint> points = make_frame_of_points(size, 13);
  ElasParams params;
  params.subpixel = false;
  const cv::Mat1f left = match_left(pair, points, params);
  EXPECT_EQ(cv::countNonZero(left.colRange(13 + 3, 91 - 3) == 13.0F), 72 * 47);
  const cv::Mat1f right =
      match_dense(View::right, DescriptorImage(pair.right), DescriptorImage(pair.left), move_to_right_view(points), params);
  EXPECT_EQ(cv::countNonZero(right.colRange(3, 78 - 3) == 13.0F), 72 * 47);
}

TEST(DenseMatching, SubpixelTellsFractionsOfAPixel) {
  const cv::Size size(160, 60);
  for (const int quarters : {37, 38, 39, 40}) {
    const cv::Mat1f disparity = match_left(make_fractional_wall(size, quarters), make_frame_of_points(size, quarters / 4));
    const cv::Mat1f inner = disparity(cv::Rect(20, 5, 130, 50));
    ASSERT_EQ(count_valid(inner), inner.rows * inner.cols);
    cv::Scalar mean;
    cv::Scalar deviation;
    cv::meanStdDev(inner, mean, deviation);
    EXPECT_NEAR(mean[0], quarters / 4.0, 0.08);
    EXPECT_LT(deviation[0], 0.2);
  }
}

TEST(DenseMatching, SurfaceWithoutTextureStaysInvalid) {
  const cv::Size size(100, 60);
  SyntheticPair pair = make_wall(size, 10);
  pair.left.colRange(50, 100) = 5;
  pair.right.colRange(40, 100) = 5;
  const cv::Mat1f disparity = match_left(pair, make_frame_of_points(size, 10));
  EXPECT_EQ(count_valid(disparity.colRange(60, 100)), 0);
  EXPECT_EQ(count_valid(disparity.colRange(20, 45)), 25 * 60);
}

TEST(DenseMatching, MarginRejectsARepeatedPattern) {
  cv::Mat1b stripes(40, 120);
  for (int v = 0; v < stripes.rows; ++v) {
    for (int u = 0; u < stripes.cols; ++u) stripes(v, u) = (u / 4) % 2 == 0 ? 50 : 200;
  }
  // Support points that offer two disparities a period of 8 px apart, both without a plane.
  const std::vector<SupportPoint> points = {{60, 20, 8}, {62, 20, 16}};
  ElasParams params;
  params.match_margin = 0.0;
  const cv::Rect near_points(40, 0, 40, 40);
  EXPECT_EQ(count_valid(match_left({stripes, stripes}, points, params)(near_points)), 40 * 40);
  params.match_margin = 0.03;
  EXPECT_EQ(count_valid(match_left({stripes, stripes}, points, params)(near_points)), 0);
}

TEST(DenseMatching, OutsideAllTrianglesOnlyWhenAsked) {
  const cv::Size size(100, 60);
  const SyntheticPair pair = make_wall(size, 10);
  const std::vector<SupportPoint> points = {{40, 20, 10}, {60, 20, 10}, {50, 40, 10}};
  ElasParams params;
  const cv::Mat1f outside = match_left(pair, points, params);
  EXPECT_NE(outside(5, 30), kInvalidDisparity);
  params.match_outside = false;
  const cv::Mat1f inside = match_left(pair, points, params);
  EXPECT_EQ(inside(5, 30), kInvalidDisparity);
  EXPECT_NEAR(inside(25, 50), 10.0F, 0.5F);
}

TEST(DenseMatching, NoPointsNoDisparity) {
  const SyntheticPair pair = make_wall({31, 33}, 3);
  EXPECT_EQ(count_valid(match_left(pair, {})), 0);
}

}  // namespace
}  // namespace brink
