#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "brink/disparity.hpp"
#include "disparity/dense_matching.hpp"
#include "disparity/descriptors.hpp"

namespace brink {

/// What is known of the pixels of a row before they are matched.
struct RowPrior {
  static constexpr std::int16_t kNone = -20000;
  explicit RowPrior(std::size_t width) : expected(width), reliable(width), wanted(width) {}

  std::vector<std::int16_t> expected;  ///< disparity of the plane, px; kNone outside all triangles
  std::vector<std::int16_t> reliable;  ///< the same where the plane is reliable; kNone elsewhere
  std::vector<std::uint8_t> wanted;    ///< 0 = stays invalid
};

/// Matches the pixels of row v: match_dense, which calls this, for one row. Equal to the plain twin in
/// tests/reference/dense_matching.hpp for every target.
///
/// A pixel's candidates are the disparities of its cell and those near its plane that lie in the picture. Its energy is the
/// matching cost and the penalty; the least wins, of equal ones the smallest disparity.
/// @param disparity the row of the result, invalid at first.
void match_dense_row(View view, const DescriptorImage& image, const DescriptorImage& other, int v, const RowPrior& prior,
                     const CandidateGrid& grid, const Penalty& penalty, const ElasParams& params, float* disparity);

}  // namespace brink
