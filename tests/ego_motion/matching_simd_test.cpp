#include "ego_motion/matching_simd.hpp"

#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "reference/matching.hpp"
#include "simd_targets.hpp"

namespace brink {
namespace {

FeatureDescriptor make_descriptor(cv::RNG& random) {
  FeatureDescriptor descriptor;
  for (std::uint8_t& value : descriptor) value = static_cast<std::uint8_t>(random.uniform(0, 256));
  return descriptor;
}

FeatureColumns make_features(std::size_t count, cv::RNG& random) {
  FeatureColumns features;
  for (std::size_t i = 0; i < count + FeatureColumns::kSpare; ++i) {
    features.u.push_back(static_cast<float>(random.uniform(0, 20)));
    features.v.push_back(static_cast<float>(random.uniform(0, 20)));
    if (i < count) features.descriptors.push_back(make_descriptor(random));
  }
  return features;
}

void expect_twin(const FeatureColumns& features, const FeaturePieces& pieces, const std::array<float, 4>& window,
                 const FeatureDescriptor& wanted) {
  const BestTwo expected = reference::naive_best_two(features, pieces, window, wanted);
  test::for_each_target([&] {
    const BestTwo two = find_best_two(features, pieces, window, wanted);
    EXPECT_EQ(two.best, expected.best);
    EXPECT_EQ(two.cost, expected.cost);
    EXPECT_EQ(two.second_cost, expected.second_cost);
  });
}

TEST(FindBestTwo, EqualsThePlainTwinOnEveryTarget) {
  cv::RNG random(5);
  const FeatureColumns features = make_features(300, random);
  const std::vector<std::size_t> begins = {0, 10, 10, 25, 60, 61, 61, 61, 150, 200, 280, 300};
  for (int trial = 0; trial < 200; ++trial) {
    const auto first = static_cast<std::size_t>(random.uniform(0, 4));
    const auto length = static_cast<std::size_t>(random.uniform(1, 3));
    const auto count = static_cast<std::size_t>(random.uniform(0, 3));
    const auto u = static_cast<float>(random.uniform(0, 20));  // many places are on the border of the window
    const auto v = static_cast<float>(random.uniform(0, 20));
    SCOPED_TRACE(trial);
    expect_twin(features, {begins.data() + first, 3, length, count}, {u, v, u + 6.0F, v + 9.0F}, make_descriptor(random));
  }
}

TEST(FindBestTwo, ComparesMoreThanItHoldsAtOnce) {
  cv::RNG random(6);
  const FeatureColumns features = make_features(1500, random);
  const std::vector<std::size_t> begins = {0, 1500};
  expect_twin(features, {begins.data(), 1, 1, 1}, {-1.0F, -1.0F, 30.0F, 30.0F}, make_descriptor(random));
}

TEST(FindBestTwo, TellsTheGreatestCost) {
  FeatureColumns features;
  features.u.resize(1 + FeatureColumns::kSpare);
  features.v.resize(1 + FeatureColumns::kSpare);
  features.descriptors.emplace_back().fill(255);
  const std::vector<std::size_t> begins = {0, 1};
  test::for_each_target([&] {
    const BestTwo two = find_best_two(features, {begins.data(), 1, 1, 1}, {0.0F, 0.0F, 0.0F, 0.0F}, FeatureDescriptor{});
    EXPECT_EQ(two.best, 0);
    EXPECT_EQ(two.cost, 32 * 255);
    EXPECT_EQ(two.second_cost, std::numeric_limits<int>::max());
  });
}

}  // namespace
}  // namespace brink
