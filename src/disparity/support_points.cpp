#include "disparity/support_points.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "disparity/padded_rows.hpp"
#include "disparity/support_points_simd.hpp"

namespace brink {
namespace {

/// Whether one of the up to kRedundancyReach cells from (i, j) on in steps of (di, dj) holds nearly the same disparity.
bool has_similar(const SupportGrid& grid, int i, int j, int di, int dj) {
  constexpr int kRedundancyReach = 3;
  constexpr int kRedundancyThreshold = 1;
  for (int step = 1; step <= kRedundancyReach; ++step) {
    const int x = i + step * di;
    const int y = j + step * dj;
    if (x < 0 || y < 0 || x >= grid.cols || y >= grid.rows) return false;
    if (grid(y, x) != kNoSupport && std::abs(grid(y, x) - grid(j, i)) <= kRedundancyThreshold) return true;
  }
  return false;
}

}  // namespace

SupportGrid match_support_candidates(const DescriptorImage& left, const DescriptorImage& right, const ElasParams& params,
                                     SupportMemory& memory) {
  const int step = params.candidate_step_px;
  SupportGrid grid((left.height() + step - 1) / step, (left.width() + step - 1) / step, kNoSupport);
  tbb::parallel_for(tbb::blocked_range<int>(0, grid.rows), [&](const tbb::blocked_range<int>& rows) {
    for (int j = rows.begin(); j < rows.end(); ++j) match_support_row(left, right, j, params, memory.local(), grid[j]);
  });
  return grid;
}

SupportGrid remove_inconsistent(const SupportGrid& grid, const ElasParams& params) {
  // With a frame, so that no window ends at the border and vectors may reach beyond it.
  const int reach = params.inconsistency_window;
  SupportGrid framed;
  cv::copyMakeBorder(grid, framed, reach, reach, reach, reach + kRowPadding, cv::BORDER_CONSTANT, kNoSupport);
  SupportGrid result = grid.clone();
  constexpr int kRows = 8;
  tbb::parallel_for(tbb::blocked_range<int>(0, result.rows, kRows), [&](const tbb::blocked_range<int>& rows) {
    remove_inconsistent_points(framed, params, {rows.begin(), rows.end()}, result);
  });
  return result;
}

SupportGrid remove_redundant(const SupportGrid& grid) {
  SupportGrid result = grid.clone();
  // In place on purpose: judged by the untouched grid, the inside of every even surface would vanish altogether.
  const auto thin_out = [&result](const cv::Range& columns, const cv::Range& rows, int di, int dj) {
    for (int j = rows.start; j < rows.end; ++j) {
      for (int i = columns.start; i < columns.end; ++i) {
        if (result(j, i) == kNoSupport) continue;
        if (has_similar(result, i, j, -di, -dj) && has_similar(result, i, j, di, dj)) result(j, i) = kNoSupport;
      }
    }
  };
  const cv::Range all_columns(0, result.cols);
  const cv::Range all_rows(0, result.rows);
  constexpr int kLines = 16;
  tbb::parallel_for(tbb::blocked_range<int>(0, result.cols, kLines), [&](const tbb::blocked_range<int>& columns) {
    thin_out({columns.begin(), columns.end()}, all_rows, 0, 1);
  });
  tbb::parallel_for(tbb::blocked_range<int>(0, result.rows, kLines), [&](const tbb::blocked_range<int>& rows) {
    thin_out(all_columns, {rows.begin(), rows.end()}, 1, 0);
  });
  return result;
}

std::vector<SupportPoint> make_corners(const std::vector<SupportPoint>& points, cv::Size size) {
  std::vector<SupportPoint> corners;
  for (const int v : {0, size.height - 1}) {
    for (const int u : {0, size.width - 1}) {
      const auto squared_distance = [u, v](const SupportPoint& p) {
        return std::int64_t{p.u - u} * (p.u - u) + std::int64_t{p.v - v} * (p.v - v);
      };
      const auto nearest = std::min_element(points.begin(), points.end(), [&](const SupportPoint& a, const SupportPoint& b) {
        return squared_distance(a) < squared_distance(b);
      });
      corners.push_back({u, v, nearest->disparity});
      if (u > 0) corners.push_back({u + nearest->disparity, v, nearest->disparity});
    }
  }
  return corners;
}

std::vector<SupportPoint> find_support_points(const DescriptorImage& left, const DescriptorImage& right,
                                              const ElasParams& params, SupportMemory& memory) {
  const SupportGrid candidates = match_support_candidates(left, right, params, memory);
  const SupportGrid grid = remove_redundant(remove_inconsistent(candidates, params));
  std::vector<SupportPoint> points;
  for (int j = 0; j < grid.rows; ++j) {
    for (int i = 0; i < grid.cols; ++i) {
      if (grid(j, i) != kNoSupport) {
        points.push_back({i * params.candidate_step_px, j * params.candidate_step_px, grid(j, i)});
      }
    }
  }
  if (params.add_corners && !points.empty()) {
    const std::vector<SupportPoint> corners = make_corners(points, {left.width(), left.height()});
    points.insert(points.end(), corners.begin(), corners.end());
  }
  return points;
}

}  // namespace brink
