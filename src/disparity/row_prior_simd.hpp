#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "disparity/dense_matching.hpp"

namespace brink {

/// What is known of the pixels of a row before they are matched.
struct RowPrior {
  static constexpr std::int16_t kNone = -20000;
  static constexpr int kPadding = 64;  ///< behind the rows, which may be written beyond their end
  explicit RowPrior(int pixels)
      : width(pixels),
        expected(static_cast<std::size_t>(pixels + kPadding)),
        reliable(expected.size()),
        wanted(expected.size()) {}

  int width;
  std::vector<std::int16_t> expected;  ///< disparity of the plane, px; kNone outside all triangles
  std::vector<std::int16_t> reliable;  ///< the same where the plane is reliable; kNone elsewhere
  std::vector<std::uint8_t> wanted;    ///< 0 = stays invalid
};

/// What the planes expect of the pixels of row v: PriorPlane::whole_disparity, for every target.
/// @param labels the row of label_triangles' result. @param prior all of `expected` and `reliable` is written.
void expect_row(const int* labels, const std::vector<PriorPlane>& planes, int v, RowPrior& prior);

}  // namespace brink
