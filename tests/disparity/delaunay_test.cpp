#include "disparity/delaunay.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdlib>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "reference/delaunay.hpp"

namespace brink {
namespace {

std::int64_t twice_area(const SupportPoint& a, const SupportPoint& b, const SupportPoint& c) {
  return std::int64_t{b.u - a.u} * (c.v - a.v) - std::int64_t{b.v - a.v} * (c.u - a.u);
}

/// > 0 when p lies inside the circle through a, b, c (counter-clockwise).
std::int64_t in_circle(const SupportPoint& a, const SupportPoint& b, const SupportPoint& c, const SupportPoint& p) {
  const std::int64_t au = a.u - p.u, av = a.v - p.v, bu = b.u - p.u, bv = b.v - p.v, cu = c.u - p.u, cv = c.v - p.v;
  return (au * au + av * av) * (bu * cv - cu * bv) - (bu * bu + bv * bv) * (au * cv - cu * av) +
         (cu * cu + cv * cv) * (au * bv - bu * av);
}

void expect_delaunay(const std::vector<SupportPoint>& points) {
  const auto at = [&](int i) { return points[static_cast<std::size_t>(i)]; };
  std::int64_t area = 0;
  for (const Triangle& t : triangulate(points)) {
    ASSERT_GT(twice_area(at(t[0]), at(t[1]), at(t[2])), 0);
    area += twice_area(at(t[0]), at(t[1]), at(t[2]));
    for (const SupportPoint& p : points) ASSERT_LE(in_circle(at(t[0]), at(t[1]), at(t[2]), p), 0);
  }
  std::vector<cv::Point> pixels;
  pixels.reserve(points.size());
  for (const SupportPoint& p : points) pixels.emplace_back(p.u, p.v);
  std::vector<cv::Point> hull;
  cv::convexHull(pixels, hull);
  EXPECT_EQ(static_cast<double>(area) / 2.0, cv::contourArea(hull));
}

TEST(Delaunay, NeedsThreePointsThatAreNotOnOneLine) {
  EXPECT_TRUE(triangulate({}).empty());
  EXPECT_TRUE(triangulate({{1, 2, 3}}).empty());
  EXPECT_TRUE(triangulate({{1, 2, 3}, {5, 2, 3}}).empty());
  EXPECT_TRUE(triangulate({{0, 0, 1}, {5, 5, 1}, {10, 10, 1}, {30, 30, 1}}).empty());
}

TEST(Delaunay, SquareHasTwoTriangles) {
  const std::vector<SupportPoint> square = {{0, 0, 1}, {10, 0, 1}, {10, 10, 1}, {0, 10, 1}};
  EXPECT_EQ(triangulate(square).size(), 2U);
  EXPECT_EQ(triangulate(square), triangulate(square));
  expect_delaunay(square);
}

/// Each triangle from its smallest index on, all in order.
std::vector<Triangle> sorted(std::vector<Triangle> triangles) {
  for (Triangle& t : triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

// Hardly any four of them lie on one circle.
TEST(Delaunay, EqualsTheDualOfTheVoronoiDiagram) {
  cv::RNG random(5);
  std::vector<SupportPoint> points;
  for (int i = 0; i < 3000; ++i) points.push_back({random.uniform(0, 4000), random.uniform(0, 3000), 1});
  points = move_to_right_view(points);  // no two at one pixel
  EXPECT_EQ(sorted(triangulate(points)), sorted(reference::triangulate(points)));
}

TEST(Delaunay, NoPointLiesInsideACircumcircleAndTheHullIsCovered) {
  cv::RNG random(11);
  for (const int size : {3, 4, 17, 101}) {
    cv::Mat1b taken(61, 97, std::uint8_t{0});
    std::vector<SupportPoint> points;
    for (int i = 0; i < size; ++i) {
      const cv::Point p(random.uniform(0, taken.cols), random.uniform(0, taken.rows));
      if (taken(p) == 0) points.push_back({p.x, p.y, i});
      taken(p) = 1;
    }
    expect_delaunay(points);
  }
}

TEST(Delaunay, RowsOfManyPointsAreCovered) {
  std::vector<SupportPoint> points;
  cv::RNG random(8);
  for (int v = 0; v < 200; v += 5) {
    for (int u = random.uniform(0, 9); u < 160; u += random.uniform(1, 40)) points.push_back({u, v, 3});
  }
  expect_delaunay(points);
  std::swap(points.front(), points.back());  // in any order
  expect_delaunay(points);
}

TEST(Delaunay, GridWithManyPointsOnOneCircleIsCovered) {
  std::vector<SupportPoint> points;
  for (int v = 5; v <= 60; v += 5) {
    for (int u = 5; u <= 85; u += 5) points.push_back({u, v, 9});
  }
  expect_delaunay(points);
}

TEST(Delaunay, NearerSurfaceStaysWhereTwoMeetInTheRightView) {
  const std::vector<SupportPoint> moved = move_to_right_view({{30, 5, 10}, {40, 5, 20}, {10, 5, 2}, {7, 0, 3}});
  EXPECT_EQ(moved, (std::vector<SupportPoint>{{4, 0, 3}, {8, 5, 2}, {20, 5, 20}}));
}

}  // namespace
}  // namespace brink
