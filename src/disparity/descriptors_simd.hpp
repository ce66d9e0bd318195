#pragma once

#include <array>
#include <cstdint>

#include "disparity/descriptors.hpp"

namespace brink {

// Each equals the definition in tests/reference/naive_disparity.hpp for every target. Vectors may reach beyond the end of a
// row: kRowPadding more bytes are read and written.

/// Samples i = 0 .. count - 1 of both gradients of a row: Sobel / 4 + 128, saturated. Dividing rounds half to even: the noise
/// of a surface without texture, less than one grey level, then vanishes in both directions alike.
/// @param rows of the picture, above, at and below; that of sample i is pixel i + 1.
void compute_gradient_rows(const std::array<const std::uint8_t*, 3>& rows, int count, std::uint8_t* horizontal,
                           std::uint8_t* vertical);

/// The descriptors of a row: describe() of each pixel.
/// @param row of `width` descriptors, and kRowPadding more.
void gather_descriptors(const DescriptorSamples& samples, int width, Descriptor* row);

/// compute_texture of each pixel of a row, of which nothing is written beyond the end.
void compute_texture_row(const DescriptorSamples& samples, int width, std::int16_t* texture);

}  // namespace brink
