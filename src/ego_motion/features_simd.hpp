#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace brink {

/// The filters for features reach this far from a pixel, px.
inline constexpr int kFilterRadius = 2;

/// A row of all that features are found with, pixel by pixel.
struct FilteredRow {
  std::int16_t* blobs;       ///< centre +8, the ring around it +1, the ring around that -1: sums to 0
  std::int16_t* corners;     ///< a checkerboard of 2x2 squares, with an empty middle row and column
  std::uint16_t* gradients;  ///< 5x5 Sobel, an eighth of full scale, 128 = none: along the row, 256 times down the columns
};

/// Scratch that filter_row needs for a row.
inline constexpr std::size_t filter_scratch(int width) { return 6 * static_cast<std::size_t>(width + 2 * kFilterRadius); }

/// Filters the middle one of five rows. Equal to the plain twin in tests/reference/features.hpp for every target, as is
/// find_row_extrema.
/// @param rows kFilterRadius pixels longer at both ends than what is filtered. @param scratch of filter_scratch(width) values.
void filter_row(const std::array<const std::uint8_t*, 5>& rows, int width, std::int16_t* scratch, const FilteredRow& filtered);

/// Scratch that find_row_extrema needs for [begin, end).
inline constexpr std::size_t extrema_scratch(int begin, int end, int radius) {
  return 2 * static_cast<std::size_t>(end - begin + 2 * radius);
}
/// So many more columns are written than are found.
inline constexpr std::size_t kSpareColumns = 8;

/// The columns [begin, end) of the middle row whose response is at least `least_strength` from 0, and beyond which none in the
/// (2 radius + 1)^2 neighbourhood goes. @param rows 2 radius + 1 rows of responses, of at least end + radius columns.
/// @param scratch of extrema_scratch(begin, end, radius) values. @param columns receives them from left to right.
/// @return how many there are.
std::size_t find_row_extrema(const std::int16_t* const* rows, int radius, int begin, int end, int least_strength,
                             std::int16_t* scratch, std::int32_t* columns);

}  // namespace brink
