#include <gtest/gtest.h>

#include "disparity/expected_disparities_simd.hpp"
#include "reference/dense_matching.hpp"
#include "simd_targets.hpp"

namespace brink {
namespace {

constexpr std::int16_t kNoPlane = ExpectedDisparity::kNoPlane;

TEST(ExpectedDisparities, TrianglesHoldTheirPixelsAndEdges) {
  const std::vector<SupportPoint> points = {{1, 1, 0}, {5, 1, 0}, {1, 5, 0}, {5, 5, 0}};
  const std::vector<PriorPlane> planes = {{0.0F, 0.0F, 7.0F, false}, {0.0F, 0.0F, 9.0F, true}};
  const cv::Mat1s codes = expect_disparities(points, {{0, 1, 2}, {1, 3, 2}}, planes, {7, 7});
  const std::int16_t n = kNoPlane;
  const cv::Mat1s expected = (cv::Mat1s(7, 7) <<  //
                                  n,
                              n, n, n, n, n, n,          //
                              n, 14, 14, 14, 14, 19, n,  //
                              n, 14, 14, 14, 19, 19, n,  //
                              n, 14, 14, 19, 19, 19, n,  //
                              n, 14, 19, 19, 19, 19, n,  //
                              n, 19, 19, 19, 19, 19, n,  //
                              n, n, n, n, n, n, n);
  EXPECT_EQ(cv::countNonZero(codes != expected), 0) << codes;
}

TEST(ExpectedDisparities, CodesTellDisparityAndReliability) {
  for (const int disparity : {-10000, -1, 0, 1, 255, 10000}) {
    for (const bool reliable : {false, true}) {
      const std::int16_t code = ExpectedDisparity::encode(disparity, reliable);
      EXPECT_EQ(ExpectedDisparity::disparity(code), disparity);
      EXPECT_EQ(ExpectedDisparity::is_reliable(code), reliable);
    }
  }
  EXPECT_EQ(ExpectedDisparity::disparity(kNoPlane), ExpectedDisparity::kNone);
}

TEST(ExpectedDisparities, TrianglesMayReachBeyondThePicture) {
  const std::vector<PriorPlane> planes = {{0.0F, 0.0F, 3.0F, true}};
  const cv::Mat1s codes = expect_disparities({{-5, -5, 3}, {20, -5, 3}, {-5, 20, 3}}, {{0, 1, 2}}, planes, {6, 5});
  EXPECT_EQ(cv::countNonZero(codes != 7), 0) << codes;
}

TEST(ExpectedDisparities, NoTriangleNoPlane) {
  EXPECT_EQ(cv::countNonZero(expect_disparities({}, {}, {}, {9, 4}) != kNoPlane), 0);
}

// Points on a grid share rows and columns, so that edges are level or upright; arbitrary ones have steep planes.
TEST(ExpectedDisparities, EqualTheirTwin) {
  cv::RNG random(3);
  for (const cv::Size size : {cv::Size(40, 30), cv::Size(97, 53)}) {
    for (const int step : {1, 5}) {
      std::vector<SupportPoint> points;
      for (int i = 0; i < 60; ++i) {
        const int u = step * random.uniform(-10 / step, (size.width + 10) / step);
        const int v = step * random.uniform(-10 / step, (size.height + 10) / step);
        points.push_back({u, v, random.uniform(0, 256)});
      }
      const std::vector<Triangle> triangles = triangulate(points);
      ASSERT_GT(triangles.size(), 20U);
      const std::vector<PriorPlane> planes = fit_planes(View::left, points, triangles);
      const cv::Mat1s expected = reference::expect_disparities(points, triangles, planes, size);
      test::for_each_target([&] {
        const cv::Mat1s codes = expect_disparities(points, triangles, planes, size);
        EXPECT_EQ(cv::countNonZero(codes != expected), 0) << size << ", step " << step;
      });
    }
  }
}

}  // namespace
}  // namespace brink
