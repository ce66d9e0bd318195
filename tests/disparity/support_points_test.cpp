#include "disparity/support_points.hpp"

#include <gtest/gtest.h>

#include "disparity/synthetic.hpp"

namespace brink {
namespace {

std::vector<SupportPoint> find(const SyntheticPair& pair, const ElasParams& params = {}) {
  SupportMemory memory;
  return find_support_points(DescriptorImage(pair.left), DescriptorImage(pair.right), params, memory);
}

int count(const SupportGrid& grid) { return cv::countNonZero(grid != kNoSupport); }

TEST(SupportPoints, WallGivesItsDisparityEverywhere) {
  const std::vector<SupportPoint> points = find(make_wall({121, 83}, 17));
  ASSERT_GE(points.size(), 10U);
  for (const SupportPoint& point : points) {
    EXPECT_EQ(point.disparity, 17);
    EXPECT_EQ(point.u % 5, 0);
    EXPECT_EQ(point.v % 5, 0);
  }
}

TEST(SupportPoints, RangeBeyondThePictureIsHarmless) {
  ElasParams params;
  params.max_disparity = 511;
  EXPECT_EQ(find(make_wall({121, 83}, 17), params), find(make_wall({121, 83}, 17)));
}

TEST(SupportPoints, SmallestDisparityIsRespected) {
  ElasParams params;
  params.min_disparity = 20;
  for (const SupportPoint& point : find(make_wall({121, 83}, 17), params)) EXPECT_GE(point.disparity, 20);
}

TEST(SupportPoints, NoneWithoutTexture) {
  const cv::Mat1b grey(90, 120, std::uint8_t{5});
  EXPECT_TRUE(find({grey, grey}).empty());
}

TEST(SupportPoints, NoneInPicturesSmallerThanTheirSurroundings) {
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(7, 5), cv::Size(10, 10), cv::Size(300, 9)}) {
    EXPECT_TRUE(find(make_wall(size, 0)).empty()) << size;
  }
}

TEST(SupportPoints, RepeatedPatternIsNotCertain) {
  cv::Mat1b stripes(60, 120);
  for (int v = 0; v < stripes.rows; ++v) {
    for (int u = 0; u < stripes.cols; ++u) stripes(v, u) = (u / 4) % 2 == 0 ? 50 : 200;
  }
  SupportMemory memory;
  EXPECT_EQ(count(match_support_candidates(DescriptorImage(stripes), DescriptorImage(stripes), {}, memory)), 0);
}

TEST(SupportPoints, LonelyPointIsInconsistent) {
  SupportGrid grid(7, 7, 40);
  grid(3, 3) = 60;  // differs from all 48 others by more than 5
  const SupportGrid cleaned = remove_inconsistent(grid, {});
  EXPECT_EQ(cleaned(3, 3), kNoSupport);
  EXPECT_EQ(count(cleaned), 48);
}

TEST(SupportPoints, ConsistencyDoesNotDependOnTheOrder) {
  SupportGrid grid(23, 31);
  cv::RNG(3).fill(grid, cv::RNG::UNIFORM, -1, 60);
  const SupportGrid direct = remove_inconsistent(grid, {});
  SupportGrid transposed;
  cv::transpose(grid, transposed);
  SupportGrid turned;
  cv::transpose(remove_inconsistent(transposed, {}), turned);
  EXPECT_GT(count(direct), 0);
  EXPECT_LT(count(direct), count(grid));
  EXPECT_EQ(cv::countNonZero(direct != turned), 0);
}

TEST(SupportPoints, OnlyTheEndsOfAnEvenRowAreNeeded) {
  const SupportGrid row = (SupportGrid(1, 5) << 30, 30, 31, 30, 30);
  const SupportGrid expected = (SupportGrid(1, 5) << 30, kNoSupport, kNoSupport, kNoSupport, 30);
  EXPECT_EQ(cv::countNonZero(remove_redundant(row) != expected), 0);
}

TEST(SupportPoints, StepsAreKept) {
  const SupportGrid row = (SupportGrid(1, 4) << 30, 30, 50, 50);
  EXPECT_EQ(cv::countNonZero(remove_redundant(row) != row), 0);
}

TEST(SupportPoints, CornersTakeTheNearestDisparity) {
  const std::vector<SupportPoint> points = {{10, 10, 7}, {90, 40, 12}};
  const std::vector<SupportPoint> expected = {{0, 0, 7}, {100, 0, 12}, {112, 0, 12}, {0, 50, 7}, {100, 50, 12}, {112, 50, 12}};
  EXPECT_EQ(make_corners(points, {101, 51}), expected);
}

}  // namespace
}  // namespace brink
