#include "disparity/dense_matching.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include "disparity/consistency_simd.hpp"
#include "disparity/dense_matching_simd.hpp"
#include "disparity/descriptors_simd.hpp"
#include "disparity/expected_disparities_simd.hpp"
#include "disparity/window_sums_simd.hpp"

namespace brink {
namespace {

/// Slope along u from which a triangle is taken to span two surfaces.
constexpr float kMaxSlope = 0.7F;

std::array<SupportPoint, 3> corners_of(const Triangle& triangle, const std::vector<SupportPoint>& points) {
  const auto corner = [&](std::size_t k) { return points[static_cast<std::size_t>(triangle[k])]; };
  return {corner(0), corner(1), corner(2)};
}

/// Matches the rows of a view.
class ViewMatcher {
 public:
  ViewMatcher(View view, const DescriptorImage& image, const std::vector<SupportPoint>& points, const ElasParams& params,
              const DensePrior& memory = {})
      : view_(view),
        width_(image.width()),
        params_(params),
        known_(make_dense_prior(view, image, points, params, memory)),
        penalty_(make_penalty(params)) {}

  [[nodiscard]] const DensePrior& known() const { return known_; }

  /// @param row, other_row descriptors of row v of this and of the other view.
  void match_row(int v, const Descriptor* row, const Descriptor* other_row, RowSearch& search, float* disparity) const {
    const RowPrior prior{known_.expected[v], known_.textured[v], width_, params_.match_outside};
    search_row(view_, row, other_row, v, prior, known_.grid, penalty_, params_, search);
    finish_row(view_, search, prior, params_, disparity);
  }

 private:
  View view_;
  int width_;
  const ElasParams& params_;
  DensePrior known_;
  Penalty penalty_;
};

}  // namespace

cv::Mat1b find_textured(const DescriptorImage& image, const ElasParams& params, const cv::Mat1b& memory) {
  const int width = image.width();
  const int height = image.height();
  const int radius = params.texture_radius_px;
  const int window = 2 * radius + 1;
  cv::Mat1b textured = make_padded_rows({width, height}, memory);
  // Some rows at a time: what is in between stays in the cache.
  constexpr int kRows = 128;
  tbb::parallel_for(tbb::blocked_range<int>(0, height, kRows), [&](const tbb::blocked_range<int>& rows) {
    const int first = std::max(rows.begin() - radius, 0);
    cv::Mat1s texture(std::min(rows.end() + radius, height) - first, width);
    for (int i = 0; i < texture.rows; ++i) compute_texture_row(image.samples(first + i), width, texture[i]);
    // The picture's border is repeated outside.
    const auto texture_at = [&](int v) { return texture[std::clamp(v, 0, height - 1) - first]; };
    const auto border = static_cast<std::size_t>(radius);
    const auto size = static_cast<std::size_t>(width);
    const std::vector<std::int16_t> nothing(size, 0);
    std::vector<std::int32_t> sums(size + 2 * border + kRowPadding, 0);
    std::int32_t* const columns = sums.data() + radius;
    for (int k = -radius; k <= radius; ++k) slide_column_sums(texture_at(rows.begin() + k), nothing.data(), width, columns);
    for (int v = rows.begin(); v < rows.end(); ++v) {
      std::fill_n(sums.begin(), border, columns[0]);
      std::fill_n(columns + width, border, columns[width - 1]);
      mark_windows(columns, width, radius, params.match_texture * window * window, textured[v]);
      if (v + 1 < rows.end()) slide_column_sums(texture_at(v + 1 + radius), texture_at(v - radius), width, columns);
    }
  });
  return textured;
}

std::vector<PriorPlane> fit_planes(View view, const std::vector<SupportPoint>& points, const std::vector<Triangle>& triangles) {
  std::vector<PriorPlane> planes;
  planes.reserve(triangles.size());
  for (const Triangle& triangle : triangles) {
    const auto [p, q, r] = corners_of(triangle, points);
    const cv::Vec3d pq(q.u - p.u, q.v - p.v, q.disparity - p.disparity);
    const cv::Vec3d pr(r.u - p.u, r.v - p.v, r.disparity - p.disparity);
    const cv::Vec3d normal = pq.cross(pr);  // normal[2] is twice the area of the triangle, hence not 0
    const double a = -normal[0] / normal[2];
    const double b = -normal[1] / normal[2];
    const double c = p.disparity - a * p.u - b * p.v;
    // Put u_left = u_right + d into the plane to see its slope in the other view.
    const double other_slope = view == View::left ? a / (1.0 - a) : a / (1.0 + a);
    const bool reliable = std::abs(a) < kMaxSlope && std::abs(other_slope) < kMaxSlope;
    planes.push_back({static_cast<float>(a), static_cast<float>(b), static_cast<float>(c), reliable});
  }
  return planes;
}

CandidateGrid make_candidate_grid(const std::vector<SupportPoint>& points, cv::Size size, const ElasParams& params) {
  const int cell = params.grid_size_px;
  const int rows = (size.height + cell - 1) / cell;
  CandidateGrid grid;
  grid.cell_px = cell;
  grid.columns = (size.width + cell - 1) / cell;
  grid.words = static_cast<std::size_t>(params.max_disparity) / 64 + 1;
  const std::size_t cells = static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(rows);
  grid.bits.assign(cells * grid.words + 1, 0);
  grid.cells.resize(cells);
  for (std::size_t k = 0; k < cells; ++k) grid.cells[k] = {k * grid.words, params.max_disparity + 1, -1};
  for (const SupportPoint& point : points) {
    const int first = std::max(point.disparity - 1, 0);
    const int last = std::min(point.disparity + 1, params.max_disparity);
    for (int j = std::max(point.v / cell - 1, 0); j <= std::min(point.v / cell + 1, rows - 1); ++j) {
      for (int i = std::max(point.u / cell - 1, 0); i <= std::min(point.u / cell + 1, grid.columns - 1); ++i) {
        CandidateGrid::Cell& near = grid.cells[grid.index(i, j)];
        near.first = std::min(near.first, first);
        near.last = std::max(near.last, last);
        for (int d = first; d <= last; ++d)
          grid.bits[near.word + static_cast<std::size_t>(d) / 64] |= std::uint64_t{1} << static_cast<unsigned>(d % 64);
      }
    }
  }
  return grid;
}

Penalty make_penalty(const ElasParams& params) {
  static constexpr double kMost = 16000.0;  // nearly the largest cost: cost and penalty together stay below 2^15
  const auto penalty = [&params](double gauss) {
    const double cost = (std::log(params.gamma + 1.0) - std::log(params.gamma + gauss)) / params.beta;
    return static_cast<std::int16_t>(std::lround(std::min(Penalty::kUnits * cost, kMost)));
  };
  const int radius = std::max(static_cast<int>(std::ceil(params.sigma_px * params.prior_radius)), 2);
  Penalty result;
  for (int x = 0; x <= radius; ++x) {
    result.near_plane.push_back(penalty(std::exp(-x * x / (2.0 * params.sigma_px * params.sigma_px))));
  }
  result.elsewhere = penalty(0.0);
  return result;
}

DensePrior make_dense_prior(View view, const DescriptorImage& image, const std::vector<SupportPoint>& points,
                            const ElasParams& params, const DensePrior& memory) {
  const cv::Size size(image.width(), image.height());
  const std::vector<Triangle> triangles = triangulate(points);
  return {.expected = expect_disparities(points, triangles, fit_planes(view, points, triangles), size, memory.expected),
          .textured = find_textured(image, params, memory.textured),
          .grid = make_candidate_grid(points, size, params)};
}

cv::Mat1f match_dense(View view, const DescriptorImage& image, const DescriptorImage& other,
                      const std::vector<SupportPoint>& points, const ElasParams& params) {
  const ViewMatcher matcher(view, image, points, params);
  cv::Mat1f disparity(image.height(), image.width());
  tbb::parallel_for(tbb::blocked_range<int>(0, disparity.rows), [&](const tbb::blocked_range<int>& rows) {
    DescriptorRow row;
    DescriptorRow other_row;
    RowSearch search;
    for (int v = rows.begin(); v < rows.end(); ++v)
      matcher.match_row(v, row.gather(image, v), other_row.gather(other, v), search, disparity[v]);
  });
  return disparity;
}

cv::Mat1f match_both_views(const DescriptorImage& left, const DescriptorImage& right, const std::vector<SupportPoint>& points,
                           const ElasParams& params, DenseMemory& memory) {
  std::optional<ViewMatcher> left_matcher;
  std::optional<ViewMatcher> right_matcher;
  tbb::parallel_invoke([&] { left_matcher.emplace(View::left, left, points, params, memory.left); },
                       [&] { right_matcher.emplace(View::right, right, move_to_right_view(points), params, memory.right); });

  const int width = left.width();
  const auto threshold = static_cast<float>(params.consistency_threshold_px);
  cv::Mat1f disparity(left.height(), width);
  tbb::parallel_for(tbb::blocked_range<int>(0, disparity.rows), [&](const tbb::blocked_range<int>& rows) {
    DenseMemory::Row& row = memory.rows.local();
    row.left_disparity.resize(static_cast<std::size_t>(width));
    row.right_disparity.resize(static_cast<std::size_t>(width));
    for (int v = rows.begin(); v < rows.end(); ++v) {
      const Descriptor* const of_left = row.left.gather(left, v);
      const Descriptor* const of_right = row.right.gather(right, v);
      left_matcher->match_row(v, of_left, of_right, row.search, row.left_disparity.data());
      right_matcher->match_row(v, of_right, of_left, row.search, row.right_disparity.data());
      check_consistency_row(row.left_disparity.data(), row.right_disparity.data(), width, threshold, disparity[v]);
    }
  });
  memory.left = left_matcher->known();
  memory.right = right_matcher->known();
  return disparity;
}

}  // namespace brink
