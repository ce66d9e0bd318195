#pragma once

#include <cstdint>
#include <vector>

#include "brink/disparity.hpp"
#include "disparity/descriptors.hpp"
#include "disparity/support_points.hpp"

namespace brink {

/// Memory for one row of candidates.
struct SupportRowMemory {
  explicit SupportRowMemory(int width) : left_upper(width), left_lower(width), right_upper(width), right_lower(width) {}

  DescriptorRow left_upper;  ///< rows of descriptors above and below the candidates
  DescriptorRow left_lower;
  DescriptorRow right_upper;
  DescriptorRow right_lower;
  std::vector<std::int16_t> costs;
};

/// Matches the candidates of one row of the grid: match_support_candidates, which calls this, for row j alone. Equal to the
/// plain twin in tests/reference/support_points.hpp for every target.
/// @param row one number for each column of the grid, kNoSupport at first.
void match_support_row(const DescriptorImage& left, const DescriptorImage& right, int j, const ElasParams& params,
                       SupportRowMemory& memory, int* row);

}  // namespace brink
