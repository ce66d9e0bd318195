#include "disparity/dense_matching_simd.hpp"

#include <gtest/gtest.h>

#include "disparity/consistency.hpp"
#include "disparity/synthetic.hpp"
#include "reference/dense_matching.hpp"
#include "simd_targets.hpp"

namespace brink {
namespace {

/// Of both views, for the support points of the pair and for arbitrary ones.
void expect_equal_to_twin(const SyntheticPair& pair, const ElasParams& params) {
  const DescriptorImage left(pair.left);
  const DescriptorImage right(pair.right);
  SupportMemory support_memory;
  std::vector<SupportPoint> arbitrary;
  arbitrary.reserve(40);
  cv::RNG random(11);
  for (int i = 0; i < 40; ++i) {
    arbitrary.push_back(
        {random.uniform(0, left.width()), random.uniform(0, left.height()), random.uniform(0, params.max_disparity + 1)});
  }
  for (const std::vector<SupportPoint>& points :
       {find_support_points(left, right, params, support_memory), move_to_right_view(arbitrary)}) {
    const std::vector<SupportPoint> moved = move_to_right_view(points);
    const cv::Mat1f expected_left = reference::match_dense(View::left, left, right, points, params);
    const cv::Mat1f expected_right = reference::match_dense(View::right, right, left, moved, params);
    const cv::Mat1f confirmed =
        check_consistency(expected_left, expected_right, static_cast<float>(params.consistency_threshold_px));
    DenseMemory memory;  // of the other targets, too
    test::for_each_target([&] {
      EXPECT_EQ(cv::countNonZero(match_both_views(left, right, points, params, memory) != confirmed), 0) << left.width();
      EXPECT_EQ(cv::countNonZero(match_dense(View::left, left, right, points, params) != expected_left), 0) << left.width();
      EXPECT_EQ(cv::countNonZero(match_dense(View::right, right, left, moved, params) != expected_right), 0) << left.width();
    });
  }
}

TEST(DenseMatchingSimd, EqualsItsTwinOnWallsOfOddSizes) {
  for (const cv::Size size : {cv::Size(33, 21), cv::Size(121, 83), cv::Size(257, 64), cv::Size(639, 31)}) {
    for (const int max_disparity : {20, 63, 64, 127, 255}) {
      ElasParams params;
      params.max_disparity = max_disparity;
      expect_equal_to_twin(make_wall(size, 14), params);
    }
  }
}

TEST(DenseMatchingSimd, EqualsItsTwinForOtherParameters) {
  expect_equal_to_twin(make_fractional_wall({301, 77}, 30), ElasParams::middlebury());
  expect_equal_to_twin(make_fractional_wall({301, 77}, 30), ElasParams::paper());
  ElasParams params;
  params.grid_size_px = 7;
  params.sigma_px = 3.0;
  params.match_margin = 0.0;
  params.match_texture = 0;
  params.beta = 0.0001;  // penalties far above the costs
  expect_equal_to_twin(make_fractional_wall({301, 77}, 30), params);
  params.grid_size_px = 64;
  params.match_outside = false;
  expect_equal_to_twin(make_fractional_wall({301, 77}, 30), params);
}

// Few grey levels: many energies are equal, and the smallest disparity of them must be taken.
TEST(DenseMatchingSimd, EqualsItsTwinWhereEnergiesAreEqual) {
  ElasParams params;
  params.match_texture = 0;
  params.match_margin = 0.0;
  expect_equal_to_twin(coarsen(make_wall({203, 91}, 9)), params);
}

TEST(DenseMatchingSimd, TexturedPixelsAreThoseOfTheTwin) {
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(3, 9), cv::Size(67, 41), cv::Size(40, 300)}) {
    cv::Mat1b picture = make_texture(size, 3);
    picture(cv::Rect(0, 0, (size.width + 1) / 2, (size.height + 1) / 2)) = 90;
    const DescriptorImage image(picture);
    for (const int radius : {0, 1, 4, 12}) {
      ElasParams params;
      params.texture_radius_px = radius;
      params.match_texture = 100;
      const cv::Mat1b expected = reference::find_textured(image, params);
      cv::Mat1b textured;  // memory of the other targets, too
      test::for_each_target([&] {
        textured = find_textured(image, params, textured);
        EXPECT_EQ(cv::countNonZero(textured != expected), 0) << size << ", " << radius;
      });
    }
  }
}

}  // namespace
}  // namespace brink
