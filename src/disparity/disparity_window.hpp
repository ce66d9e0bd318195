#pragma once

#include <algorithm>
#include <cstdint>

namespace brink {

/// A set of disparities from `first` on, which may be -1: bit i is first + i.
struct DisparityWindow {
  static constexpr int kSize = 64;
  int first;

  /// Of those in [least, greatest].
  [[nodiscard]] std::uint64_t range(int least, int greatest) const {
    const int begin = std::max(least - first, 0);
    const int last = std::min(greatest - first, kSize - 1);
    return begin <= last
               ? (~std::uint64_t{0} >> static_cast<unsigned>(kSize - 1 - (last - begin))) << static_cast<unsigned>(begin)
               : 0;
  }

  /// Of those in the set of a cell; what is beyond the cell's last word is not told.
  [[nodiscard]] std::uint64_t of_cell(const std::uint64_t* words) const {
    if (first < 0) return words[0] << 1U;
    const auto shift = static_cast<unsigned>(first % 64);
    words += first / 64;
    return words[0] >> shift | words[1] << 1U << (63U - shift);
  }
};

inline bool contains(std::uint64_t set, int i) { return ((set >> static_cast<unsigned>(i)) & 1U) != 0; }

}  // namespace brink
