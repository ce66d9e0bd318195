#include "ego_motion/normal_equations_simd.hpp"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "reference/motion_equations.hpp"
#include "simd_targets.hpp"

namespace brink {
namespace {

TEST(AddObservations, EqualsThePlainTwinOnEveryTarget) {
  std::mt19937 random(9);
  std::normal_distribution<double> any(0.0, 10.0);
  std::array<double, 16> sqrt_information{};
  for (double& value : sqrt_information) value = any(random);
  std::vector<LinearObservation> observations(37);
  EquationSums expected{};
  for (LinearObservation& observation : observations) {
    observation.sqrt_information = sqrt_information.data();
    observation.weight = std::abs(any(random));
    for (auto& row : observation.rows) {
      for (double& value : row) value = any(random);
    }
    expected = reference::naive_add_observation(observation, expected);
  }
  test::for_each_target([&] {
    const EquationSums some = add_observations(observations.data(), 20, {});
    const EquationSums sums = add_observations(observations.data() + 20, observations.size() - 20, some);
    for (std::size_t i = 1; i < kEquationColumns; ++i) {
      for (std::size_t j = 0; j <= i; ++j) EXPECT_EQ(sums[i][j], expected[i][j]) << i << " " << j;
    }
    EXPECT_EQ(add_observations(nullptr, 0, some), some);
  });
}

}  // namespace
}  // namespace brink
