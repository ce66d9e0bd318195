#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>
#include <tbb/enumerable_thread_specific.h>

#include "brink/disparity.hpp"
#include "disparity/descriptors.hpp"

namespace brink {

/// A pixel whose disparity is certain. In the left view u is the left column, in the right view the right one (left -
/// disparity).
struct SupportPoint {
  int u = 0;
  int v = 0;
  int disparity = 0;

  friend bool operator==(const SupportPoint&, const SupportPoint&) = default;
};

/// Disparities on a grid of candidates: cell (row j, column i) is the pixel (i, j) * candidate_step_px.
using SupportGrid = cv::Mat1i;
inline constexpr int kNoSupport = -1;

/// Memory for one row of candidates.
struct SupportRowMemory {
  struct View {
    DescriptorRow upper;  ///< descriptors of the rows above and below the candidates
    DescriptorRow lower;
    std::vector<std::int16_t> texture;  ///< of their own row
  };
  View left;
  View right;
  std::vector<std::int16_t> costs;
};

/// Memory that is used again for the next pair.
using SupportMemory = tbb::enumerable_thread_specific<SupportRowMemory>;

/// Matches every candidate with texture over the whole range of disparities, from the left and back from the right
/// (algorithms.md A.3). @return kNoSupport where there is no certain match.
SupportGrid match_support_candidates(const DescriptorImage& left, const DescriptorImage& right, const ElasParams& params,
                                     SupportMemory& memory);

/// Removes points that disagree with their surroundings. All points are judged by the untouched grid: the order plays no part.
SupportGrid remove_inconsistent(const SupportGrid& grid, const ElasParams& params);

/// Removes points that lie between two points of nearly their disparity, first along columns, then along rows: the planes
/// hardly change and become fewer.
SupportGrid remove_redundant(const SupportGrid& grid);

/// The four corners of the left picture, and the two right corners as the right view sees them, each with the disparity of the
/// nearest point. @param points not empty.
std::vector<SupportPoint> make_corners(const std::vector<SupportPoint>& points, cv::Size size);

/// All of the above: the support points of the left view, row by row, corners last.
std::vector<SupportPoint> find_support_points(const DescriptorImage& left, const DescriptorImage& right,
                                              const ElasParams& params, SupportMemory& memory);

}  // namespace brink
