#pragma once

#include <algorithm>
#include <cstddef>

namespace brink {

/// std::nth_element for short arrays in any order: where values are exchanged does not depend on them by a branch, which could
/// not be foretold.
inline void select_nth(float* begin, float* nth, float* end) {
  constexpr std::ptrdiff_t kShort = 8;
  // Moves to the front what fulfils a condition; where the rest begins.
  const auto partition = [](float* from, float* to, const auto& is_first) {
    float* rest = from;
    for (float* place = from; place != to; ++place) {
      const float value = *place;
      *place = *rest;
      *rest = value;
      rest += is_first(value) ? 1 : 0;
    }
    return rest;
  };
  while (end - begin > kShort) {
    const float middle = begin[(end - begin) / 2];
    const float pivot = std::max(std::min(*begin, middle), std::min(std::max(*begin, middle), end[-1]));
    float* const rest = partition(begin, end, [pivot](float value) { return value < pivot; });
    if (nth < rest) {
      end = rest;
      continue;
    }
    float* const above = partition(rest, end, [pivot](float value) { return value <= pivot; });
    if (nth < above) return;
    begin = above;
  }
  std::sort(begin, end);
}

}  // namespace brink
