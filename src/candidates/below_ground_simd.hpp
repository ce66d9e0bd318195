#pragma once

#include <cstdint>

namespace brink {

/// Where Type 1 begins, and where the ground ends.
struct BelowGroundLimits {
  float least_disparity = 1.0F;  ///< px: a smaller one is none
  float noise_px_m = 0.0F;       ///< depth to stand out of the noise, times the disparity
  float measured_m = 0.0F;       ///< depth that is wanted
  float rim_ratio = 1.0F;        ///< of the depth that is wanted, at the rim
  float tolerance_m = 0.0F;      ///< of the height of the ground
};

/// A row of masks, 255 = so.
struct BelowGroundRow {
  std::uint8_t* none;   ///< no disparity
  std::uint8_t* deep;   ///< at least as far below the ground as is wanted
  std::uint8_t* low;    ///< at least as far as the rim of a drop must be
  std::uint8_t* level;  ///< a surface that is not so low, nor higher than the ground
};

/// Sorts the pixels of a row; no disparity, or no elevation (NaN), is none of the last three. Equal to the plain twin in
/// tests/reference/below_ground.hpp for every target.
void sort_below_ground_row(const float* disparity, const float* elevation, int width, const BelowGroundLimits& limits,
                           const BelowGroundRow& masks);

}  // namespace brink
