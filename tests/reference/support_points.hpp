#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <vector>

#include "brink/disparity.hpp"
#include "disparity/descriptors.hpp"
#include "disparity/support_points.hpp"

// The naive twin of disparity/support_points_simd.cpp.
namespace brink::reference {

/// Candidates keep this distance from the border: then every sample they use lies inside the picture, px.
inline constexpr int kBorder = 5;
/// The four descriptors of a candidate lie this far from it in u and v, px.
inline constexpr int kArm = 2;
/// With fewer disparities to choose from, being best means little.
inline constexpr int kMinRange = 10;

inline int compute_support_cost(const DescriptorImage& a, int u, const DescriptorImage& b, int other_u, int v) {
  int cost = 0;
  for (const int dv : {-kArm, kArm}) {
    for (const int du : {-kArm, kArm}) cost += compute_cost(a.at(u + du, v + dv), b.at(other_u + du, v + dv));
  }
  return cost;
}

/// The disparity of pixel (u, v) of `image`, whose counterpart in `other` lies at u + direction * disparity; kNoSupport if no
/// disparity is clearly the best.
/// @param costs scratch memory.
inline int match_support_point(const DescriptorImage& image, const DescriptorImage& other, int u, int v, int direction,
                               const ElasParams& params, std::vector<int>& costs) {
  const int room = direction < 0 ? u - kBorder : image.width() - 1 - kBorder - u;
  const int last = std::min(params.max_disparity, room);
  if (last - params.min_disparity < kMinRange) return kNoSupport;
  if (compute_texture(image.at(u, v)) < params.support_texture) return kNoSupport;

  costs.clear();
  for (int d = params.min_disparity; d <= last; ++d) {
    costs.push_back(compute_support_cost(image, u, other, u + direction * d, v));
  }
  const auto best = std::min_element(costs.begin(), costs.end());
  // The foot of the minimum is no rival: next to the best all costs are low where the texture is coarse.
  const std::ptrdiff_t exclusion = params.support_exclusion_px;
  const auto foot_begin = best - std::min(exclusion, best - costs.begin());
  const auto foot_end = best + std::min(exclusion + 1, costs.end() - best);
  int second_cost = std::numeric_limits<int>::max();
  for (auto rival = costs.begin(); rival != foot_begin; ++rival) second_cost = std::min(second_cost, *rival);
  for (auto rival = foot_end; rival != costs.end(); ++rival) second_cost = std::min(second_cost, *rival);
  if (*best >= params.support_threshold * second_cost) return kNoSupport;
  return params.min_disparity + static_cast<int>(best - costs.begin());
}

inline SupportGrid match_support_candidates(const DescriptorImage& left, const DescriptorImage& right,
                                            const ElasParams& params) {
  const int step = params.candidate_step_px;
  SupportGrid grid((left.height() + step - 1) / step, (left.width() + step - 1) / step, kNoSupport);
  for (int j = 0; j < grid.rows; ++j) {
    const int v = j * step;
    if (v < kBorder || v >= left.height() - kBorder) continue;
    std::vector<int> costs;
    for (int i = 0; i < grid.cols; ++i) {
      const int u = i * step;
      if (u < kBorder || u >= left.width() - kBorder) continue;
      const int d = match_support_point(left, right, u, v, -1, params, costs);
      if (d == kNoSupport) continue;
      const int back = match_support_point(right, left, u - d, v, +1, params, costs);
      if (back != kNoSupport && std::abs(back - d) <= params.consistency_threshold_px) grid(j, i) = d;
    }
  }
  return grid;
}

inline SupportGrid remove_inconsistent(const SupportGrid& grid, const ElasParams& params) {
  const int reach = params.inconsistency_window;
  SupportGrid result = grid.clone();
  for (int j = 0; j < grid.rows; ++j) {
    for (int i = 0; i < grid.cols; ++i) {
      int agreeing = 0;
      for (int y = std::max(j - reach, 0); y <= std::min(j + reach, grid.rows - 1); ++y) {
        for (int x = std::max(i - reach, 0); x <= std::min(i + reach, grid.cols - 1); ++x) {
          const bool agrees = std::abs(grid(y, x) - grid(j, i)) <= params.inconsistency_threshold_px;
          if (grid(y, x) != kNoSupport && agrees) ++agreeing;
        }
      }
      if (agreeing < params.inconsistency_min_support) result(j, i) = kNoSupport;
    }
  }
  return result;
}

}  // namespace brink::reference
