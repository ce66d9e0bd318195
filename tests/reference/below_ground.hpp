#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "candidates/below_ground_simd.hpp"

namespace brink::reference {

/// The masks of a row.
struct BelowGroundMasks {
  explicit BelowGroundMasks(std::size_t width) : none(width), deep(width), low(width), level(width) {}
  std::vector<std::uint8_t> none;
  std::vector<std::uint8_t> deep;
  std::vector<std::uint8_t> low;
  std::vector<std::uint8_t> level;
  bool operator==(const BelowGroundMasks&) const = default;
};

/// sort_below_ground_row, pixel by pixel.
inline BelowGroundMasks naive_below_ground_row(const std::vector<float>& disparity, const std::vector<float>& elevation,
                                               const BelowGroundLimits& limits) {
  BelowGroundMasks masks(disparity.size());
  for (std::size_t u = 0; u < disparity.size(); ++u) {
    if (disparity[u] < limits.least_disparity) {
      masks.none[u] = 255;
      continue;
    }
    const float wanted = std::max(limits.noise_px_m / disparity[u], limits.measured_m);
    const float rim = limits.rim_ratio * wanted;
    if (elevation[u] <= -wanted) masks.deep[u] = 255;
    if (elevation[u] <= -rim) masks.low[u] = 255;
    if (elevation[u] > -rim && elevation[u] < limits.tolerance_m) masks.level[u] = 255;
  }
  return masks;
}

}  // namespace brink::reference
