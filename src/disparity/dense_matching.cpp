#include "disparity/dense_matching.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include <opencv2/imgproc.hpp>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "disparity/dense_matching_simd.hpp"
#include "disparity/descriptors_simd.hpp"

namespace brink {
namespace {

/// Slope along u from which a triangle is taken to span two surfaces.
constexpr float kMaxSlope = 0.7F;

/// floor(a / b) and ceil(a / b), b > 0.
int divide_down(int a, int b) { return a >= 0 ? a / b : -((-a + b - 1) / b); }
int divide_up(int a, int b) { return -divide_down(-a, b); }

/// First and last column of a row that lie inside a triangle or on its edges.
cv::Range span_of_row(const std::array<SupportPoint, 3>& corners, int v, int width) {
  int first = 0;
  int last = width - 1;
  for (std::size_t k = 0; k < 3; ++k) {
    const SupportPoint& p = corners[k];
    const SupportPoint& q = corners[(k + 1) % 3];
    // Inside: (q - p) x (x - p) >= 0, that is rise * (u - p.u) <= run * (v - p.v).
    const int rise = q.v - p.v;
    const int bound = (q.u - p.u) * (v - p.v);
    if (rise > 0) last = std::min(last, p.u + divide_down(bound, rise));
    if (rise < 0) first = std::max(first, p.u + divide_up(-bound, -rise));
  }
  return {first, last};
}

std::array<SupportPoint, 3> corners_of(const Triangle& triangle, const std::vector<SupportPoint>& points) {
  const auto corner = [&](std::size_t k) { return points[static_cast<std::size_t>(triangle[k])]; };
  return {corner(0), corner(1), corner(2)};
}

/// Which pixels of a row are matched: those with texture, in a triangle unless all are.
void want_row(const uchar* textured, const int* labels, bool outside, RowPrior& prior) {
  const int least_label = outside ? std::numeric_limits<int>::min() : 0;
  std::uint8_t* const wanted = prior.wanted.data();
  for (int u = 0; u < prior.width; ++u)
    wanted[u] = static_cast<std::uint8_t>((textured[u] != 0 ? 1 : 0) & (labels[u] >= least_label ? 1 : 0));
}

}  // namespace

cv::Mat1b find_textured(const DescriptorImage& image, const ElasParams& params) {
  cv::Mat1s texture(image.height(), image.width());
  tbb::parallel_for(0, texture.rows, [&](int v) { compute_texture_row(image.row(v), image.width(), texture[v]); });
  const int window = 2 * params.texture_radius_px + 1;
  cv::Mat1i sum;
  cv::boxFilter(texture, sum, CV_32S, {window, window}, {-1, -1}, false, cv::BORDER_REPLICATE);
  cv::Mat1b textured;
  cv::compare(sum, params.match_texture * window * window, textured, cv::CMP_GE);
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

cv::Mat1i label_triangles(const std::vector<SupportPoint>& points, const std::vector<Triangle>& triangles, cv::Size size) {
  cv::Mat1i labels(size, -1);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const std::array<SupportPoint, 3> corners = corners_of(triangles[i], points);
    const auto [low, high] = std::minmax({corners[0].v, corners[1].v, corners[2].v});
    for (int v = std::max(low, 0); v <= std::min(high, size.height - 1); ++v) {
      const cv::Range span = span_of_row(corners, v, size.width);
      if (span.start <= span.end) std::fill(labels[v] + span.start, labels[v] + span.end + 1, static_cast<int>(i));
    }
  }
  return labels;
}

CandidateGrid make_candidate_grid(const std::vector<SupportPoint>& points, cv::Size size, const ElasParams& params) {
  const int cell = params.grid_size_px;
  const int rows = (size.height + cell - 1) / cell;
  CandidateGrid grid;
  grid.cell_px = cell;
  grid.columns = (size.width + cell - 1) / cell;
  grid.words = static_cast<std::size_t>(params.max_disparity) / 64 + 1;
  grid.bits.assign(static_cast<std::size_t>(grid.columns * rows) * grid.words, 0);
  for (const SupportPoint& point : points) {
    for (int j = std::max(point.v / cell - 1, 0); j <= std::min(point.v / cell + 1, rows - 1); ++j) {
      for (int i = std::max(point.u / cell - 1, 0); i <= std::min(point.u / cell + 1, grid.columns - 1); ++i) {
        std::uint64_t* const bits = grid.bits.data() + static_cast<std::size_t>(j * grid.columns + i) * grid.words;
        for (int d = std::max(point.disparity - 1, 0); d <= std::min(point.disparity + 1, params.max_disparity); ++d) {
          bits[d / 64] |= std::uint64_t{1} << static_cast<unsigned>(d % 64);
        }
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
                            const ElasParams& params) {
  const cv::Size size(image.width(), image.height());
  const std::vector<Triangle> triangles = triangulate(points);
  return {.planes = fit_planes(view, points, triangles),
          .labels = label_triangles(points, triangles, size),
          .grid = make_candidate_grid(points, size, params),
          .textured = find_textured(image, params)};
}

cv::Mat1f match_dense(View view, const DescriptorImage& image, const DescriptorImage& other,
                      const std::vector<SupportPoint>& points, const ElasParams& params) {
  const cv::Size size(image.width(), image.height());
  const DensePrior known = make_dense_prior(view, image, points, params);
  const Penalty penalty = make_penalty(params);

  cv::Mat1f disparity(size);
  tbb::parallel_for(tbb::blocked_range<int>(0, size.height), [&](const tbb::blocked_range<int>& rows) {
    RowPrior prior(size.width);
    RowSearch search;
    for (int v = rows.begin(); v < rows.end(); ++v) {
      expect_row(known.labels[v], known.planes, v, prior);
      want_row(known.textured[v], known.labels[v], params.match_outside, prior);
      search_row(view, image, other, v, prior, known.grid, penalty, params, search);
      finish_row(view, search, prior, params, disparity[v]);
    }
  });
  return disparity;
}

}  // namespace brink
