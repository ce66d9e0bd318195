#pragma once

#include <cstddef>

#include "ego_motion/normal_equations_simd.hpp"

namespace brink::reference {

/// add_observations for one of them.
inline EquationSums naive_add_observation(const LinearObservation& observation, EquationSums sums) {
  std::array<std::array<double, kEquationColumns>, 4> rows{};
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t column = 0; column < kEquationColumns; ++column) {
      for (std::size_t k = 0; k < 4; ++k)
        rows[i][column] += observation.sqrt_information[4 * k + i] * observation.rows[k][column];
    }
  }
  for (std::size_t i = 1; i < kEquationColumns; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      const auto product = [&](std::size_t k) { return observation.weight * rows[k][i] * rows[k][j]; };
      sums[i][j] += (product(0) + product(2)) + (product(1) + product(3));
    }
  }
  return sums;
}

}  // namespace brink::reference
