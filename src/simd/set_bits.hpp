#pragma once

#include <cstddef>
#include <cstdint>

namespace brink {

/// The numbers of the bits that are set in a byte, from the lowest on: with them a vector keeps what a mask selects. (Highway
/// 1.0.3's CompressStore copies its table each time.)
struct SetBits {
  constexpr SetBits() {
    for (unsigned byte = 0; byte < 256; ++byte) {
      std::size_t count = 0;
      for (std::uint8_t bit = 0; bit < 8; ++bit) {
        if ((byte >> bit & 1U) != 0) numbers[byte][count++] = bit;
      }
    }
  }
  std::uint8_t numbers[256][8] = {};  // NOLINT(modernize-avoid-c-arrays)
};
inline constexpr SetBits kSetBits;

}  // namespace brink
