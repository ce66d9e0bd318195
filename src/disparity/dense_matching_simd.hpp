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

/// Memory that one row after the other uses.
struct RowScratch {
  std::vector<std::uint64_t> candidates;  ///< sets of disparities: bit d of the words
  std::vector<std::uint64_t> looked_at;
  std::vector<const std::uint64_t*> cells;  ///< whose sets are united
  std::vector<std::int16_t> costs;  ///< of the disparities that are looked at, as many as a vector has lanes each
  std::vector<std::int16_t> energies;
  // What the search found for each pixel:
  std::vector<std::int16_t> energy;      ///< least, or none
  std::vector<std::int16_t> rival;       ///< least of those that lie more than 1 px away from the best
  std::vector<std::int16_t> disparity;   ///< of the best
  std::vector<std::int16_t> cost_below;  ///< matching costs of the disparity - 1, itself, and + 1
  std::vector<std::int16_t> cost;
  std::vector<std::int16_t> cost_above;
};

/// Matches the pixels of row v: match_dense, which calls this, for one row. Equal to the plain twin in
/// tests/reference/dense_matching.hpp for every target.
///
/// A pixel's candidates are the disparities of its cell and those near its plane that lie in the picture. Its energy is the
/// matching cost and the penalty; the least wins, of equal ones the smallest disparity.
/// @param disparity the row of the result: every pixel of it is written.
void match_dense_row(View view, const DescriptorImage& image, const DescriptorImage& other, int v, const RowPrior& prior,
                     const CandidateGrid& grid, const Penalty& penalty, const ElasParams& params, RowScratch& scratch,
                     float* disparity);

}  // namespace brink
