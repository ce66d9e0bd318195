#pragma once

#include <limits>
#include <vector>

namespace brink::reference {

/// compute_elevation_row, pixel by pixel.
inline std::vector<float> naive_elevation_row(const std::vector<float>& disparity, float height_m, float first, float step) {
  std::vector<float> elevation;
  for (const float d : disparity) {
    const float ground = step * static_cast<float>(elevation.size()) + first;
    elevation.push_back(d > 0.0F ? height_m * (1.0F - ground / d) : std::numeric_limits<float>::quiet_NaN());
  }
  return elevation;
}

}  // namespace brink::reference
