#pragma once

#include <cstdint>

namespace brink {

// Sums over square windows, which move down the picture row by row. Equal to the plain twin in
// tests/reference/naive_disparity.hpp for every target.

/// Adds a row to the sums of the columns, and takes another one away.
void slide_column_sums(const std::int16_t* added, const std::int16_t* removed, int width, std::int32_t* sums);

/// 255 where the sums of the 2 radius + 1 columns around a pixel add up to at least so much, 0 elsewhere.
/// @param sums of the first pixel's column; `radius` more on both sides are read, and kRowPadding more behind those.
/// @param marks kRowPadding more than `width` are written.
void mark_windows(const std::int32_t* sums, int width, int radius, std::int32_t least, std::uint8_t* marks);

}  // namespace brink
