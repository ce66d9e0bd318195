#pragma once

#include <cstddef>

#include "ego_motion/matching_simd.hpp"

namespace brink::reference {

/// find_best_two, entry by entry.
inline BestTwo naive_best_two(const SearchPieces& pieces, const std::array<float, 4>& limits, const FeatureDescriptor& wanted) {
  BestTwo two;
  for (std::size_t strip = 0; strip < pieces.strips; ++strip) {
    const std::size_t* const begin = pieces.begins + strip * pieces.stride;
    for (std::size_t i = begin[0]; i < begin[pieces.length]; ++i) {
      const FeatureEntry& entry = pieces.entries[i];
      bool within = true;
      for (std::size_t k = 0; k < limits.size(); ++k) within = within && entry.place[k] >= limits[k];
      if (!within) continue;
      const int cost = compute_cost(entry.descriptor, wanted);
      if (cost < two.cost) {
        two = {entry.index, cost, two.cost};
      } else if (cost < two.second_cost) {
        two.second_cost = cost;
      }
    }
  }
  return two;
}

}  // namespace brink::reference
