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

TEST(FindBestTwo, EqualsThePlainTwinOnEveryTarget) {
  cv::RNG random(5);
  std::vector<FeatureEntry> entries;
  for (int i = 0; i < 300; ++i) {
    const auto u = static_cast<float>(random.uniform(0, 20));
    const auto v = static_cast<float>(random.uniform(0, 20));
    entries.push_back({{u, v, -u, -v}, make_descriptor(random), 7 * i});
  }
  const std::vector<std::size_t> begins = {0, 10, 10, 25, 60, 61, 61, 61, 150, 200, 280, 300};
  int found = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const auto first = static_cast<std::size_t>(random.uniform(0, 4));
    const SearchPieces pieces{entries.data(), begins.data() + first, 3, static_cast<std::size_t>(random.uniform(1, 3)),
                              static_cast<std::size_t>(random.uniform(0, 3))};
    const auto u = static_cast<float>(random.uniform(0, 20));  // many places are on the border of the window
    const auto v = static_cast<float>(random.uniform(0, 20));
    const std::array<float, 4> limits = {u, v, -u - 6.0F, -v - 9.0F};
    const FeatureDescriptor wanted = make_descriptor(random);
    const BestTwo expected = reference::naive_best_two(pieces, limits, wanted);
    found += expected.second_cost <= 32 * 255 ? 1 : 0;
    test::for_each_target([&] {
      const BestTwo two = find_best_two(pieces, limits, wanted);
      EXPECT_EQ(two.index, expected.index) << trial;
      EXPECT_EQ(two.cost, expected.cost) << trial;
      EXPECT_EQ(two.second_cost, expected.second_cost) << trial;
    });
  }
  EXPECT_GT(found, 50);
}

TEST(FindBestTwo, TellsTheGreatestCost) {
  FeatureEntry entry;
  entry.descriptor.fill(255);
  entry.index = 3;
  const std::vector<std::size_t> begins = {0, 1};
  test::for_each_target([&] {
    const BestTwo two = find_best_two({&entry, begins.data(), 1, 1, 1}, {0.0F, 0.0F, 0.0F, 0.0F}, FeatureDescriptor{});
    EXPECT_EQ(two.index, 3);
    EXPECT_EQ(two.cost, 32 * 255);
  });
}

}  // namespace
}  // namespace brink
