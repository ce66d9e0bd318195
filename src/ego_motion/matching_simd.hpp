#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "ego_motion/features.hpp"

namespace brink {

/// Features as a search looks at them.
struct FeatureColumns {
  static constexpr std::size_t kSpare = 16;  ///< so many more places may be read beyond the last one
  std::vector<float> u, v;                   ///< px; with spare ones
  std::vector<FeatureDescriptor> descriptors;
};

/// Pieces of them: piece s from begins[s * stride] to begins[s * stride + length].
struct FeaturePieces {
  const std::size_t* begins;
  std::size_t stride;
  std::size_t length;
  std::size_t pieces;
};

/// The feature that looks most like a descriptor, and how much so does the next one.
struct BestTwo {
  int best = -1;  ///< number of the feature; -1 = none; of several alike any
  int cost = std::numeric_limits<int>::max();
  int second_cost = std::numeric_limits<int>::max();
};

/// Compares what is within the window. Equal to the plain twin in tests/reference/matching.hpp for every target.
/// @param window least column and row, greatest column and row, px, borders included.
BestTwo find_best_two(const FeatureColumns& features, const FeaturePieces& pieces, const std::array<float, 4>& window,
                      const FeatureDescriptor& wanted);

}  // namespace brink
