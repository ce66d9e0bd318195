#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "ego_motion/features.hpp"

namespace brink {

/// A feature as a search looks at it; a line of the cache.
struct alignas(64) FeatureEntry {
  std::array<float, 4>
      place{};  ///< column, row, and both with the other sign, px: within a window when none is below its limits
  FeatureDescriptor descriptor{};
  int index = 0;
};

/// Groups of entries that lie in `strips` pieces, piece s from begins[s * stride] to begins[s * stride + length].
struct SearchPieces {
  const FeatureEntry* entries;
  const std::size_t* begins;
  std::size_t stride;
  std::size_t length;
  std::size_t strips;
};

/// The entry that looks most like a descriptor, and how much so does the next one.
struct BestTwo {
  int index = -1;  ///< of the entry; -1 = none; of several alike any
  int cost = std::numeric_limits<int>::max();
  int second_cost = std::numeric_limits<int>::max();
};

/// Compares what is within the limits. Equal to the plain twin in tests/reference/matching.hpp for every target.
/// @param limits of FeatureEntry::place.
BestTwo find_best_two(const SearchPieces& pieces, const std::array<float, 4>& limits, const FeatureDescriptor& wanted);

}  // namespace brink
