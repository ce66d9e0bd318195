#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "brink/disparity.hpp"
#include "disparity/dense_matching.hpp"
#include "disparity/descriptors.hpp"
#include "disparity/expected_disparities_simd.hpp"

namespace brink {

/// What is known of the pixels of a row before they are matched.
struct RowPrior {
  const std::int16_t* expected;  ///< the row of expect_disparities
  const std::uint8_t* textured;  ///< the row of find_textured
  int width;
  bool outside;  ///< whether pixels outside all triangles are matched

  /// Whether the pixel is matched.
  [[nodiscard]] bool is_wanted(int u) const {
    return textured[u] != 0 && (outside || expected[u] != ExpectedDisparity::kNoPlane);
  }
};

/// Searches the best disparities of the pixels of row v of a view.
///
/// A pixel's candidates are the disparities of its cell and those near its plane that lie in the picture. Its energy is the
/// matching cost and the penalty; the least wins, of equal ones the smallest disparity.
/// @param row, other_row the descriptors of that view and of the other one; DescriptorRow::kPadding more on both sides are
/// read.
void search_row(View view, const Descriptor* row, const Descriptor* other_row, int v, const RowPrior& prior,
                const CandidateGrid& grid, const Penalty& penalty, const ElasParams& params, RowSearch& search);

/// The last step for the pixels of a row: which are certain, and where between whole numbers they lie. Both steps together
/// equal the plain twin in tests/reference/dense_matching.hpp for every target.
/// @param disparity the row of the result: every pixel of it is written.
void finish_row(View view, const RowSearch& search, const RowPrior& prior, const ElasParams& params, float* disparity);

}  // namespace brink
