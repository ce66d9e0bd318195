#pragma once

#include "brink/disparity.hpp"
#include "disparity/descriptors.hpp"
#include "disparity/support_points.hpp"

namespace brink {

/// Matches the candidates of one row of the grid: match_support_candidates, which calls this, for row j alone. Equal to the
/// plain twin in tests/reference/support_points.hpp for every target.
/// @param row one number for each column of the grid, kNoSupport at first.
void match_support_row(const DescriptorImage& left, const DescriptorImage& right, int j, const ElasParams& params,
                       SupportRowMemory& memory, int* row);

/// Takes the points out of these rows of the result with which fewer than inconsistency_min_support points of their window
/// agree: they themselves count. Equal to the plain twin in tests/reference/support_points.hpp for every target.
/// @param framed the grid with inconsistency_window cells of kNoSupport around it, and kRowPadding more behind every row.
void remove_inconsistent_points(const SupportGrid& framed, const ElasParams& params, const cv::Range& rows,
                                SupportGrid& result);

}  // namespace brink
