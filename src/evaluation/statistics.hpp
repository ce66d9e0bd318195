#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

namespace brink {

/// The value (none NaN) below which `share` (0..1) of the values lie, between two of them in proportion; 0.5 = median. Empty
/// without values.
inline std::optional<double> quantile(std::vector<double> values, double share) {
  if (values.empty()) return std::nullopt;
  const double position = share * static_cast<double>(values.size() - 1);
  const auto below = values.begin() + static_cast<std::ptrdiff_t>(position);
  std::ranges::nth_element(values, below);
  if (below + 1 == values.end()) return *below;
  return *below + (position - std::floor(position)) * (*std::min_element(below + 1, values.end()) - *below);
}

}  // namespace brink
