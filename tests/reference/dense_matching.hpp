#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "brink/disparity.hpp"
#include "disparity/delaunay.hpp"
#include "disparity/dense_matching.hpp"
#include "disparity/descriptors.hpp"
#include "disparity/expected_disparities_simd.hpp"

// The naive twins of disparity/dense_matching_simd.cpp and expected_disparities_simd.cpp: pixel by pixel, in the words of their
// headers.
namespace brink::reference {

class PixelMatcher {
 public:
  PixelMatcher(View view, const DescriptorImage& image, const DescriptorImage& other, const Penalty& penalty,
               const ElasParams& params)
      : direction_(view == View::left ? -1 : 1), image_(image), other_(other), penalty_(penalty), params_(params) {}

  /// @param plane none outside all triangles. @param nearby of the pixel's cell.
  [[nodiscard]] float match(int u, int v, const std::optional<PriorPlane>& plane, const std::uint64_t* nearby) const {
    std::optional<int> expected;
    if (plane) expected = plane->whole_disparity(u, v);
    const int radius = static_cast<int>(penalty_.near_plane.size()) - 1;
    const int largest = std::min(params_.max_disparity, direction_ < 0 ? u : image_.width() - 1 - u);

    std::vector<Candidate> candidates;
    for (int d = 0; d <= largest; ++d) {
      const bool is_nearby = ((nearby[d / 64] >> static_cast<unsigned>(d % 64)) & 1U) != 0;
      const bool on_plane = expected && std::abs(d - *expected) <= radius;
      if (!is_nearby && !on_plane) continue;
      const int penalty = on_plane && plane->reliable ? penalty_.near_plane[static_cast<std::size_t>(std::abs(d - *expected))]
                                                      : penalty_.elsewhere;
      candidates.push_back({d, Penalty::kUnits * cost(u, v, d) + penalty});
    }
    if (candidates.empty()) return kInvalidDisparity;
    const Candidate best = *std::min_element(candidates.begin(), candidates.end(),
                                             [](const Candidate& a, const Candidate& b) { return a.energy < b.energy; });
    if (is_ambiguous(best, candidates)) return kInvalidDisparity;
    return params_.subpixel ? refine(u, v, best.disparity, largest) : static_cast<float>(best.disparity);
  }

 private:
  struct Candidate {
    int disparity = 0;
    int energy = 0;
  };

  [[nodiscard]] int cost(int u, int v, int d) const { return compute_cost(image_.at(u, v), other_.at(u + direction_ * d, v)); }

  [[nodiscard]] bool is_ambiguous(const Candidate& best, const std::vector<Candidate>& candidates) const {
    if (params_.match_margin <= 0.0) return false;
    const auto keep = static_cast<float>(1.0 - params_.match_margin);
    return std::any_of(candidates.begin(), candidates.end(), [&](const Candidate& rival) {
      return std::abs(rival.disparity - best.disparity) > 1 &&
             static_cast<float>(best.energy) >= keep * static_cast<float>(rival.energy);
    });
  }

  [[nodiscard]] float refine(int u, int v, int d, int largest) const {
    const auto whole = static_cast<float>(d);
    if (d < 1 || d >= largest) return whole;
    const int below = cost(u, v, d - 1);
    const int above = cost(u, v, d + 1);
    const int rise = std::max(below, above) - cost(u, v, d);
    if (rise <= 0) return whole;
    return whole + std::clamp(static_cast<float>(below - above) / static_cast<float>(2 * rise), -0.5F, 0.5F);
  }

  int direction_;
  const DescriptorImage& image_;
  const DescriptorImage& other_;
  const Penalty& penalty_;
  const ElasParams& params_;
};

/// Whether the mean texture around each pixel is large enough; the border pixels are repeated outside.
inline cv::Mat1b find_textured(const DescriptorImage& image, const ElasParams& params) {
  const int radius = params.texture_radius_px;
  cv::Mat1b textured(image.height(), image.width(), std::uint8_t{0});
  for (int v = 0; v < textured.rows; ++v) {
    for (int u = 0; u < textured.cols; ++u) {
      int sum = 0;
      for (int y = v - radius; y <= v + radius; ++y) {
        for (int x = u - radius; x <= u + radius; ++x) {
          sum += compute_texture(image.at(std::clamp(x, 0, textured.cols - 1), std::clamp(y, 0, textured.rows - 1)));
        }
      }
      if (sum >= params.match_texture * (2 * radius + 1) * (2 * radius + 1)) textured(v, u) = 255;
    }
  }
  return textured;
}

/// Which triangle each pixel lies in, -1 = none. A pixel on an edge belongs to the later of the two triangles.
inline cv::Mat1i label_triangles(const std::vector<SupportPoint>& points, const std::vector<Triangle>& triangles,
                                 cv::Size size) {
  cv::Mat1i labels(size, -1);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto corner = [&](std::size_t k) { return points[static_cast<std::size_t>(triangles[i][k % 3])]; };
    for (int v = 0; v < size.height; ++v) {
      for (int u = 0; u < size.width; ++u) {
        int left_of = 0;
        int right_of = 0;
        for (std::size_t k = 0; k < 3; ++k) {
          const SupportPoint p = corner(k);
          const SupportPoint q = corner(k + 1);
          const int side = (q.u - p.u) * (v - p.v) - (q.v - p.v) * (u - p.u);
          if (side < 0) ++left_of;
          if (side > 0) ++right_of;
        }
        if (left_of == 0 || right_of == 0) labels(v, u) = static_cast<int>(i);
      }
    }
  }
  return labels;
}

inline cv::Mat1s expect_disparities(const std::vector<SupportPoint>& points, const std::vector<Triangle>& triangles,
                                    const std::vector<PriorPlane>& planes, cv::Size size) {
  cv::Mat1s expected(size, ExpectedDisparity::kNoPlane);
  const cv::Mat1i labels = label_triangles(points, triangles, size);
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      if (labels(v, u) < 0) continue;
      const PriorPlane& plane = planes[static_cast<std::size_t>(labels(v, u))];
      expected(v, u) = ExpectedDisparity::encode(plane.whole_disparity(u, v), plane.reliable);
    }
  }
  return expected;
}

inline cv::Mat1f match_dense(View view, const DescriptorImage& image, const DescriptorImage& other,
                             const std::vector<SupportPoint>& points, const ElasParams& params) {
  const cv::Size size(image.width(), image.height());
  const std::vector<Triangle> triangles = triangulate(points);
  const std::vector<PriorPlane> planes = fit_planes(view, points, triangles);
  const cv::Mat1i labels = label_triangles(points, triangles, size);
  const cv::Mat1b textured = brink::find_textured(image, params);
  const CandidateGrid grid = make_candidate_grid(points, size, params);
  const Penalty penalty = make_penalty(params);
  const PixelMatcher matcher(view, image, other, penalty, params);

  cv::Mat1f disparity(size, kInvalidDisparity);
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      if (textured(v, u) == 0) continue;
      std::optional<PriorPlane> plane;
      if (labels(v, u) >= 0) plane = planes[static_cast<std::size_t>(labels(v, u))];
      if (plane || params.match_outside) disparity(v, u) = matcher.match(u, v, plane, grid.words_at(u, v));
    }
  }
  return disparity;
}

}  // namespace brink::reference
