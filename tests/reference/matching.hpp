#pragma once

#include <array>
#include <cstddef>

#include "ego_motion/matching_simd.hpp"

namespace brink::reference {

/// find_best_two, feature by feature.
inline BestTwo naive_best_two(const FeatureColumns& features, const FeaturePieces& pieces, const std::array<float, 4>& window,
                              const FeatureDescriptor& wanted) {
  BestTwo two;
  for (std::size_t piece = 0; piece < pieces.pieces; ++piece) {
    const std::size_t* const begin = pieces.begins + piece * pieces.stride;
    for (std::size_t i = begin[0]; i < begin[pieces.length]; ++i) {
      const float u = features.u[i];
      const float v = features.v[i];
      if (u < window[0] || v < window[1] || u > window[2] || v > window[3]) continue;
      const int cost = compute_cost(features.descriptors[i], wanted);
      if (cost < two.cost) {
        two = {static_cast<int>(i), cost, two.cost};
      } else if (cost < two.second_cost) {
        two.second_cost = cost;
      }
    }
  }
  return two;
}

}  // namespace brink::reference
