#include "disparity/support_points_simd.hpp"

#include <gtest/gtest.h>

#include "disparity/synthetic.hpp"
#include "reference/support_points.hpp"
#include "simd_targets.hpp"

namespace brink {
namespace {

void expect_equal_to_twin(const SyntheticPair& pair, const ElasParams& params) {
  const DescriptorImage left(pair.left);
  const DescriptorImage right(pair.right);
  const SupportGrid expected = reference::match_support_candidates(left, right, params);
  SupportMemory memory;  // of the other targets, too
  test::for_each_target([&] {
    const SupportGrid grid = match_support_candidates(left, right, params, memory);
    ASSERT_EQ(grid.size(), expected.size());
    EXPECT_EQ(cv::countNonZero(grid != expected), 0) << pair.left.size();
  });
}

TEST(SupportPointsSimd, EqualsItsTwinOnWallsOfOddSizes) {
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(33, 21), cv::Size(121, 83), cv::Size(257, 64), cv::Size(640, 17)}) {
    for (const int max_disparity : {15, 64, 127, 255, 511}) {
      ElasParams params;
      params.max_disparity = max_disparity;
      expect_equal_to_twin(make_wall(size, 14), params);
    }
  }
}

TEST(SupportPointsSimd, EqualsItsTwinForOtherParameters) {
  ElasParams params = ElasParams::middlebury();
  expect_equal_to_twin(make_wall({301, 77}, 40), params);
  params.candidate_step_px = 3;
  params.min_disparity = 11;
  params.support_threshold = 1.0;
  params.support_exclusion_px = 0;
  expect_equal_to_twin(make_wall({301, 77}, 40), params);
}

// Few grey levels: many costs are equal, and the first of them must be taken.
TEST(SupportPointsSimd, EqualsItsTwinWhereCostsAreEqual) {
  ElasParams params;
  params.support_threshold = 1.0;
  params.support_exclusion_px = 3;
  expect_equal_to_twin(coarsen(make_wall({203, 91}, 9)), params);
  const cv::Mat1b noise = make_texture({203, 91}, 5);
  expect_equal_to_twin({noise, make_texture({203, 91}, 6)}, params);
}

TEST(SupportPointsSimd, InconsistentPointsAreThoseOfTheTwin) {
  cv::RNG random(13);
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(5, 3), cv::Size(31, 17), cv::Size(64, 20)}) {
    SupportGrid grid(size);
    random.fill(grid, cv::RNG::UNIFORM, kNoSupport, 60);
    for (const int window : {0, 1, 5, 9}) {
      for (const int min_support : {1, 3, 8, 14}) {
        ElasParams params;
        params.inconsistency_window = window;
        params.inconsistency_min_support = min_support;
        const SupportGrid expected = reference::remove_inconsistent(grid, params);
        test::for_each_target(
            [&] { EXPECT_EQ(cv::countNonZero(remove_inconsistent(grid, params) != expected), 0) << size << ", " << window; });
      }
    }
  }
}

}  // namespace
}  // namespace brink
