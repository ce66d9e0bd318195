#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <opencv2/core.hpp>
#include <tbb/enumerable_thread_specific.h>

#include "brink/disparity.hpp"
#include "disparity/delaunay.hpp"
#include "disparity/descriptors.hpp"
#include "disparity/padded_rows.hpp"
#include "disparity/support_points.hpp"

namespace brink {

/// The view whose pixels are matched; the counterpart lies at u - d for the left and at u + d for the right view.
enum class View : std::uint8_t { left, right };

/// The disparities expected inside a triangle: d(u, v) = a u + b v + c, px.
struct PriorPlane {
  float a = 0.0F;
  float b = 0.0F;
  float c = 0.0F;
  bool reliable = false;  ///< not too slanted in either view to be one surface
  [[nodiscard]] float disparity(int u, int v) const { return a * static_cast<float>(u) + b * static_cast<float>(v) + c; }
  static constexpr float kFar = 10000.0F;  ///< whole_disparity is no more, either way
  /// Rounded; a plane that is nearly upright may expect any number.
  [[nodiscard]] int whole_disparity(int u, int v) const {
    // Shifted to what is positive, where truncating rounds down: std::floor is slow without SSE 4.1.
    return static_cast<int>(std::clamp(disparity(u, v), -kFar, kFar) + (kFar + 0.5F)) - static_cast<int>(kFar);
  }
};

/// The plane through the corners of each triangle.
std::vector<PriorPlane> fit_planes(View view, const std::vector<SupportPoint>& points, const std::vector<Triangle>& triangles);

/// Disparities near each part of the picture, whatever the planes say: for each cell a set of bits, bit d = disparity d.
struct CandidateGrid {
  struct Cell {
    std::size_t word = 0;  ///< its first, of `words`
    int first = 0;         ///< smallest and largest disparity of its set; last = -1 when that is empty
    int last = -1;
  };
  int cell_px = 1;
  int columns = 0;
  std::vector<Cell> cells;          ///< row by row
  std::size_t words = 1;            ///< of a cell
  std::vector<std::uint64_t> bits;  ///< cell by cell, and one word more

  /// Where the cell in a column and row of cells stands.
  [[nodiscard]] std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(i);
  }
  /// The cell that a pixel lies in.
  [[nodiscard]] const Cell& at(int u, int v) const { return cells[index(u / cell_px, v / cell_px)]; }
  [[nodiscard]] const std::uint64_t* words_of(const Cell& cell) const { return bits.data() + cell.word; }
  [[nodiscard]] const std::uint64_t* words_at(int u, int v) const { return words_of(at(u, v)); }
};

/// The disparities of the support points in a cell and in its up to 8 neighbours, each with d - 1 and d + 1.
CandidateGrid make_candidate_grid(const std::vector<SupportPoint>& points, cv::Size size, const ElasParams& params);

/// How much a disparity that lies x = 0, 1, .. px off its plane costs more than one on the plane: the logarithm of the prior
/// gamma + exp(-x^2 / 2 sigma^2) (ACCV 2010, eq. 5 and 9), in units of a quarter of the matching cost.
struct Penalty {
  static constexpr int kUnits = 4;       ///< of a matching cost of 1
  std::vector<std::int16_t> near_plane;  ///< of x = 0 up to the radius of the search
  std::int16_t elsewhere = 0;            ///< without a prior
};
Penalty make_penalty(const ElasParams& params);

/// Where the mean texture of the window around a pixel is at least match_texture: 255, elsewhere 0. A single pixel on a weakly
/// textured surface may have none by chance, and one without any surface may have some by noise; their surroundings tell.
/// @param memory an earlier result, whose memory is used again. @return kRowPadding more pixels can be read behind every row.
cv::Mat1b find_textured(const DescriptorImage& image, const ElasParams& params, const cv::Mat1b& memory = {});

/// What is known of the pixels of a view before they are matched.
struct DensePrior {
  cv::Mat1s expected;  ///< expect_disparities
  cv::Mat1b textured;  ///< find_textured
  CandidateGrid grid;
};
/// @param memory an earlier one, whose memory is used again.
DensePrior make_dense_prior(View view, const DescriptorImage& image, const std::vector<SupportPoint>& points,
                            const ElasParams& params, const DensePrior& memory = {});

/// The most probable disparity of every pixel of a view, given its plane and the descriptors (ACCV 2010, section 4;
/// algorithms.md A.6). @param points of that view.
/// @return kInvalidDisparity without texture, where the match is ambiguous, and where there is no candidate.
cv::Mat1f match_dense(View view, const DescriptorImage& image, const DescriptorImage& other,
                      const std::vector<SupportPoint>& points, const ElasParams& params);

/// What the search found for the pixels of a row.
struct RowSearch {
  static constexpr std::int16_t kNoEnergy = std::numeric_limits<std::int16_t>::max();

  std::vector<std::int16_t> energy;      ///< least; kNoEnergy = there was no candidate
  std::vector<std::int16_t> rival;       ///< least of those that lie more than 1 px away from the best
  std::vector<std::int16_t> disparity;   ///< of the best
  std::vector<std::int16_t> cost_below;  ///< matching costs of the disparity - 1, itself, and + 1
  std::vector<std::int16_t> cost;
  std::vector<std::int16_t> cost_above;
};

/// Memory of match_both_views that is used again for the next pair.
struct DenseMemory {
  struct Row {
    DescriptorRow left;
    DescriptorRow right;
    RowSearch search;
    std::vector<float> left_disparity;
    std::vector<float> right_disparity;
  };

  DensePrior left;
  DensePrior right;
  tbb::enumerable_thread_specific<Row> rows;
};

/// check_consistency of what match_dense finds in the left and in the right view, row by row while the descriptors of the row
/// are at hand. @param points of the left view.
cv::Mat1f match_both_views(const DescriptorImage& left, const DescriptorImage& right, const std::vector<SupportPoint>& points,
                           const ElasParams& params, DenseMemory& memory);

}  // namespace brink
