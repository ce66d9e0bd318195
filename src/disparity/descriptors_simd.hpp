#pragma once

#include <cstdint>

#include "disparity/descriptors.hpp"

namespace brink {

/// The descriptors of a row: describe() of each pixel, for every target.
/// @param row of `width` descriptors.
void gather_descriptors(const DescriptorSamples& samples, int width, Descriptor* row);

/// compute_texture of each pixel of a row.
void compute_texture_row(const Descriptor* row, int width, std::int16_t* texture);

}  // namespace brink
