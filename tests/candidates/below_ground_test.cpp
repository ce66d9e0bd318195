#include "reference/below_ground.hpp"

#include <cstddef>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "brink/frame.hpp"
#include "candidates/below_ground_simd.hpp"
#include "simd_targets.hpp"

namespace brink {
namespace {

reference::BelowGroundMasks sort(const std::vector<float>& disparity, const std::vector<float>& elevation,
                                 const BelowGroundLimits& limits) {
  reference::BelowGroundMasks masks(disparity.size());
  const BelowGroundRow row{masks.none.data(), masks.deep.data(), masks.low.data(), masks.level.data()};
  sort_below_ground_row(disparity.data(), elevation.data(), static_cast<int>(disparity.size()), limits, row);
  return masks;
}

const BelowGroundLimits kLimits{
    .least_disparity = 1.0F, .noise_px_m = 3.0F, .measured_m = 0.135F, .rim_ratio = 0.4F, .tolerance_m = 0.1F};

TEST(BelowGround, SortsPixelsByTheDepthThatNoiseAndRuleAsk) {
  // At 10 px the noise asks for 30 cm, at 60 px for 5 cm, which is less than the rule's 13.5 cm.
  const std::vector<float> disparity{10.0F, 10.0F, 10.0F, 60.0F, 60.0F, 60.0F, 60.0F, 0.9F, kInvalidDisparity};
  const std::vector<float> elevation{-0.31F, -0.2F, -0.11F, -0.14F, -0.06F, 0.09F, 0.11F, -1.0F, -1.0F};
  const reference::BelowGroundMasks masks = sort(disparity, elevation, kLimits);
  EXPECT_EQ(masks.none, (std::vector<std::uint8_t>{0, 0, 0, 0, 0, 0, 0, 255, 255}));
  EXPECT_EQ(masks.deep, (std::vector<std::uint8_t>{255, 0, 0, 255, 0, 0, 0, 0, 0}));
  EXPECT_EQ(masks.low, (std::vector<std::uint8_t>{255, 255, 0, 255, 255, 0, 0, 0, 0}));
  EXPECT_EQ(masks.level, (std::vector<std::uint8_t>{0, 0, 255, 0, 0, 255, 0, 0, 0}));
}

TEST(BelowGround, EqualsItsTwinOnEveryTarget) {
  cv::RNG random(6);
  for (const std::size_t width : {1U, 3U, 16U, 131U}) {
    std::vector<float> disparity(width);
    std::vector<float> elevation(width);
    for (std::size_t u = 0; u < width; ++u) {
      disparity[u] = u % 7 == 0 ? kInvalidDisparity : random.uniform(0.0F, 40.0F);
      elevation[u] = u % 7 == 0 ? std::numeric_limits<float>::quiet_NaN() : random.uniform(-0.4F, 0.2F);
    }
    const reference::BelowGroundMasks expected = reference::naive_below_ground_row(disparity, elevation, kLimits);
    test::for_each_target([&] { EXPECT_EQ(sort(disparity, elevation, kLimits), expected) << width; });
  }
}

}  // namespace
}  // namespace brink
