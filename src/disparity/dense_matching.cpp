#include "disparity/dense_matching.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <optional>

#include <opencv2/imgproc.hpp>
#include <tbb/parallel_for.h>

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

/// How much a disparity that lies x = 0, 1, .. px off the plane costs more than one on the plane, in units of the matching
/// cost: the logarithm of the prior gamma + exp(-x^2 / 2 sigma^2) (ACCV 2010, eq. 5 and 9).
struct Penalty {
  std::vector<float> near_plane;  ///< of x = 0 up to the radius of the search
  float elsewhere = 0.0F;         ///< without a prior
};

Penalty make_penalty(const ElasParams& params) {
  const auto penalty = [&params](double gauss) {
    return static_cast<float>((std::log(params.gamma + 1.0) - std::log(params.gamma + gauss)) / params.beta);
  };
  const int radius = std::max(static_cast<int>(std::ceil(params.sigma_px * params.prior_radius)), 2);
  Penalty result;
  for (int x = 0; x <= radius; ++x) {
    result.near_plane.push_back(penalty(std::exp(-x * x / (2.0 * params.sigma_px * params.sigma_px))));
  }
  result.elsewhere = penalty(0.0);
  return result;
}

/// Matches the pixels of one row, one after the other.
class RowMatcher {
 public:
  RowMatcher(View view, const DescriptorImage& image, const DescriptorImage& other, int v, const Penalty& penalty,
             const ElasParams& params)
      : direction_(view == View::left ? -1 : 1),
        width_(image.width()),
        image_(image.row(v)),
        other_(other.row(v)),
        penalty_(penalty),
        params_(params) {}

  /// @param expected disparity of the plane, px; none outside all triangles.
  /// @param reliable whether the plane is.
  /// @param nearby disparities to be tried besides those near the plane, ascending.
  float match(int u, std::optional<float> expected, bool reliable, const std::vector<int>& nearby) {
    const int largest = std::min(params_.max_disparity, direction_ < 0 ? u : width_ - 1 - u);
    const cv::Range planar = expected ? range_around(*expected, largest) : cv::Range(0, 0);
    energies_.clear();
    for (const int d : nearby) {
      if (d <= largest && (d < planar.start || d >= planar.end)) add(d, cost(u, d), penalty_.elsewhere);
    }
    for (int d = planar.start; d < planar.end; ++d) {
      const auto off_plane = static_cast<std::size_t>(std::abs(d - round(*expected)));
      add(d, cost(u, d), reliable ? penalty_.near_plane[off_plane] : penalty_.elsewhere);
    }
    if (energies_.empty()) return kInvalidDisparity;
    const Energy best = *std::min_element(energies_.begin(), energies_.end(),
                                          [](const Energy& a, const Energy& b) { return a.energy < b.energy; });
    if (is_ambiguous(best)) return kInvalidDisparity;
    return params_.subpixel ? refine(u, best.disparity, largest) : static_cast<float>(best.disparity);
  }

 private:
  struct Energy {
    int disparity = 0;
    float energy = 0.0F;  ///< cost + penalty, >= 0
  };

  /// A plane that is nearly upright may expect any number.
  static int round(float disparity) { return static_cast<int>(std::lround(std::clamp(disparity, -1e6F, 1e6F))); }

  [[nodiscard]] cv::Range range_around(float expected, int largest) const {
    const int radius = static_cast<int>(penalty_.near_plane.size()) - 1;
    return {std::max(round(expected) - radius, 0), std::min(round(expected) + radius, largest) + 1};
  }

  [[nodiscard]] int cost(int u, int d) const { return compute_cost(image_[u], other_[u + direction_ * d]); }

  void add(int d, int cost, float penalty) { energies_.push_back({d, static_cast<float>(cost) + penalty}); }

  /// Whether a disparity further than 1 px away would do nearly as well.
  [[nodiscard]] bool is_ambiguous(const Energy& best) const {
    if (params_.match_margin <= 0.0) return false;
    return std::any_of(energies_.begin(), energies_.end(), [&](const Energy& rival) {
      return std::abs(rival.disparity - best.disparity) > 1 && best.energy >= (1.0 - params_.match_margin) * rival.energy;
    });
  }

  /// Moves a disparity by up to half a pixel, to the tip of two lines of equal and opposite slope through the costs of it and
  /// its neighbours: an L1 cost is such a wedge, not a parabola.
  [[nodiscard]] float refine(int u, int d, int largest) const {
    const auto whole = static_cast<float>(d);
    if (d < 1 || d >= largest) return whole;
    const int below = cost(u, d - 1);
    const int above = cost(u, d + 1);
    const int rise = std::max(below, above) - cost(u, d);
    if (rise <= 0) return whole;
    return whole + std::clamp(static_cast<float>(below - above) / static_cast<float>(2 * rise), -0.5F, 0.5F);
  }

  int direction_;
  int width_;
  const Descriptor* image_;
  const Descriptor* other_;
  const Penalty& penalty_;
  const ElasParams& params_;
  std::vector<Energy> energies_;
};

}  // namespace

cv::Mat1b find_textured(const DescriptorImage& image, const ElasParams& params) {
  cv::Mat1s texture(image.height(), image.width());
  for (int v = 0; v < texture.rows; ++v) {
    for (int u = 0; u < texture.cols; ++u) texture(v, u) = static_cast<std::int16_t>(compute_texture(image.row(v)[u]));
  }
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
      for (int u = span.start; u <= span.end; ++u) labels(v, u) = static_cast<int>(i);
    }
  }
  return labels;
}

CandidateGrid make_candidate_grid(const std::vector<SupportPoint>& points, cv::Size size, const ElasParams& params) {
  const int cell = params.grid_size_px;
  const int columns = (size.width + cell - 1) / cell;
  const int rows = (size.height + cell - 1) / cell;
  const int disparities = params.max_disparity + 1;
  cv::Mat1b seen(columns * rows, disparities, std::uint8_t{0});
  for (const SupportPoint& point : points) {
    const cv::Range near_d(std::max(point.disparity - 1, 0), std::min(point.disparity + 1, params.max_disparity));
    for (int j = std::max(point.v / cell - 1, 0); j <= std::min(point.v / cell + 1, rows - 1); ++j) {
      for (int i = std::max(point.u / cell - 1, 0); i <= std::min(point.u / cell + 1, columns - 1); ++i) {
        for (int d = near_d.start; d <= near_d.end; ++d) seen(j * columns + i, d) = 1;
      }
    }
  }
  CandidateGrid grid{cell, columns, std::vector<std::vector<int>>(static_cast<std::size_t>(columns * rows))};
  for (int k = 0; k < seen.rows; ++k) {
    for (int d = 0; d < disparities; ++d) {
      if (seen(k, d) != 0) grid.cells[static_cast<std::size_t>(k)].push_back(d);
    }
  }
  return grid;
}

cv::Mat1f match_dense(View view, const DescriptorImage& image, const DescriptorImage& other,
                      const std::vector<SupportPoint>& points, const ElasParams& params) {
  const cv::Size size(image.width(), image.height());
  const std::vector<Triangle> triangles = triangulate(points);
  const std::vector<PriorPlane> planes = fit_planes(view, points, triangles);
  const cv::Mat1i labels = label_triangles(points, triangles, size);
  const CandidateGrid grid = make_candidate_grid(points, size, params);
  const cv::Mat1b textured = find_textured(image, params);
  const Penalty penalty = make_penalty(params);

  cv::Mat1f disparity(size, kInvalidDisparity);
  tbb::parallel_for(0, size.height, [&](int v) {
    RowMatcher row(view, image, other, v, penalty, params);
    for (int u = 0; u < size.width; ++u) {
      if (textured(v, u) == 0) continue;
      if (labels(v, u) >= 0) {
        const PriorPlane& plane = planes[static_cast<std::size_t>(labels(v, u))];
        disparity(v, u) = row.match(u, plane.disparity(u, v), plane.reliable, grid.at(u, v));
      } else if (params.match_outside) {
        disparity(v, u) = row.match(u, std::nullopt, false, grid.at(u, v));
      }
    }
  });
  return disparity;
}

}  // namespace brink
