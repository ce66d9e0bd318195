#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace brink {

/// A bit for each pixel of a row: pixel u is bit u % 64 of word u / 64.
using PixelBits = std::vector<std::uint64_t>;

/// Which pixels of a row of disparities are valid, and which of them belong together. Bits beyond the row are 0.
struct ValidBits {
  PixelBits valid;
  PixelBits joined;  ///< the pixel and the next one are valid and alike
};

/// Finds both. Equal to the plain twin in tests/reference/naive_disparity.hpp for every target.
/// @param similarity_px largest difference of neighbours that are alike. @param bits what was in it before plays no part.
void find_valid_bits(const float* row, int width, float similarity_px, ValidBits& bits);

/// Calls visit(u) for each bit that is set, from left to right. @param word the number of the word.
template <typename Visit>
void for_each_bit(std::uint64_t bits, std::size_t word, const Visit& visit) {
  for (; bits != 0; bits &= bits - 1) visit(static_cast<int>(64 * word) + std::countr_zero(bits));
}

/// Calls visit(begin, end) for each run of valid pixels in which neighbours are joined, from left to right.
template <typename Visit>
void for_each_run(const ValidBits& bits, const Visit& visit) {
  std::uint64_t joined_before = 0;
  int begin = 0;
  for (std::size_t k = 0; k < bits.valid.size(); ++k) {
    const std::uint64_t first = bits.valid[k] & ~(bits.joined[k] << 1U | joined_before);
    const std::uint64_t last = bits.valid[k] & ~bits.joined[k];
    joined_before = bits.joined[k] >> 63U;
    for_each_bit(first | last, k, [&](int u) {
      const auto bit = std::uint64_t{1} << static_cast<unsigned>(u % 64);
      if ((first & bit) != 0) begin = u;
      if ((last & bit) != 0) visit(begin, u + 1);
    });
  }
}

}  // namespace brink
