#include "ground/range.hpp"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "ground/level.hpp"

namespace brink {
namespace {

TEST(Span, IsFoundAtEitherEndInTheMiddleAndNowhere) {
  const auto find = [](int begin, int end, double peak) {
    const Span span = find_span(10, peak, [&](int i) { return i >= begin && i < end; });
    return std::pair(span.begin, span.end);
  };
  EXPECT_EQ(find(0, 10, 0.0), std::pair(0, 10));
  EXPECT_EQ(find(0, 3, 0.0), std::pair(0, 3));
  EXPECT_EQ(find(9, 10, 0.0), std::pair(9, 10));
  EXPECT_EQ(find(4, 7, 5.5), std::pair(4, 7));
  EXPECT_EQ(find(6, 7, 5.5), std::pair(6, 7)) << "beside the peak";
  EXPECT_EQ(find(5, 5, 5.5), std::pair(0, 0));
  EXPECT_EQ(find_span(0, 0.0, [](int) { return true; }).end, 0);
  EXPECT_EQ(common({2, 5}, {7, 9}).begin, common({2, 5}, {7, 9}).end);
}

TEST(GroundRange, TellsForRowsWhatItTellsForPixels) {
  cv::RNG random(2);
  const cv::Size size(97, 61);
  const StereoCamera camera{.focal = 60.0, .cx = 47.3, .cy = 30.9, .baseline = 0.15};
  int ending_on_both_sides = 0;
  for (int i = 0; i < 300; ++i) {
    const GroundPlane plane =
        make_ground_plane(random.uniform(0.3, 2.5), random.uniform(-20.0, 89.0), random.uniform(-80.0, 80.0), camera);
    const GroundRange range(compute_ground_pose(plane, camera), camera, random.uniform(0.1, 10.0));
    for (int v = 0; v < size.height; ++v) {
      const Span columns = range.columns(v, size.width);
      ending_on_both_sides += columns.begin > 0 && columns.begin < columns.end && columns.end < size.width ? 1 : 0;
      for (int u = 0; u < size.width; ++u)
        EXPECT_EQ(u >= columns.begin && u < columns.end, range.contains(u, v)) << u << ' ' << v;
    }
  }
  EXPECT_GT(ending_on_both_sides, 100);
}

TEST(Level, IsWhatLiesNearerToTheGroundThanItsTolerance) {
  const cv::Mat1f elevation = (cv::Mat1f(1, 6) << 0.0F, 0.0999F, 0.1F, -0.0999F, -0.1F, std::nanf(""));
  const cv::Mat1b expected = (cv::Mat1b(1, 6) << 255, 255, 0, 255, 0, 0);
  EXPECT_EQ(cv::norm(select_level(elevation, 0.1), expected, cv::NORM_INF), 0.0);
}

}  // namespace
}  // namespace brink
