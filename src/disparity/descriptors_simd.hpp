#pragma once

#include <array>
#include <cstdint>

#include "disparity/descriptors.hpp"

namespace brink {

/// The gradients that one row of descriptors samples: rows v - 2 .. v + 2, each pointing at column 0. At least 2 samples on
/// both sides of the picture's columns can be read.
struct GradientRows {
  std::array<const std::uint8_t*, 5> horizontal{};
  std::array<const std::uint8_t*, 5> vertical{};
};

/// One row of compute_descriptors. Equal to the plain twin in tests/reference/naive_disparity.hpp for every target.
/// @param row of `width` descriptors.
void gather_descriptors(const GradientRows& gradients, int width, Descriptor* row);

/// compute_texture of each pixel of a row.
void compute_texture_row(const Descriptor* row, int width, std::int16_t* texture);

}  // namespace brink
