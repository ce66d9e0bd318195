#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>

#include <opencv2/core.hpp>

#include "ego_motion/refinement_simd.hpp"

namespace brink::reference {

using Levels = std::array<float, kPatchPixels>;

inline float dot(const Levels& a, const Levels& b) { return std::inner_product(a.begin(), a.end(), b.begin(), 0.0F); }

/// Levels of the warped square around a position, bilinear, less their mean.
inline Levels naive_sample(const cv::Mat1b& picture, const Eigen::Vector2f& centre, const Eigen::Matrix2f& step) {
  Levels levels;
  std::size_t i = 0;
  for (int y = -kPatchRadius; y <= kPatchRadius; ++y) {
    for (int x = -kPatchRadius; x <= kPatchRadius; ++x, ++i) {
      const float u = centre.x() + step(0, 0) * static_cast<float>(x) + step(0, 1) * static_cast<float>(y);
      const float v = centre.y() + step(1, 0) * static_cast<float>(x) + step(1, 1) * static_cast<float>(y);
      const int column = std::clamp(static_cast<int>(u), 0, picture.cols - 2);
      const int row = std::clamp(static_cast<int>(v), 0, picture.rows - 2);
      const float a = u - static_cast<float>(column);
      const float b = v - static_cast<float>(row);
      const uchar* upper = picture[row] + column;
      const uchar* lower = picture[row + 1] + column;
      levels[i] = (1 - b) * ((1 - a) * upper[0] + a * upper[1]) + b * ((1 - a) * lower[0] + a * lower[1]);
    }
  }
  const float mean = std::accumulate(levels.begin(), levels.end(), 0.0F) / kPatchPixels;
  for (float& level : levels) level -= mean;
  return levels;
}

/// compare_patches, patch by patch.
inline PatchComparison naive_comparison(const std::array<PatchPixels, kPatchPixels>& patches, const PatchPlaces& places,
                                        const cv::Mat1b& picture) {
  PatchComparison comparison;
  for (std::size_t lane = 0; lane < kPatchLanes; ++lane) {
    Eigen::Matrix2f step;
    step << places.u_by_x[lane], places.u_by_y[lane], places.v_by_x[lane], places.v_by_y[lane];
    const Levels found = naive_sample(picture, {places.u[lane], places.v[lane]}, step);
    for (std::size_t i = 0; i < found.size(); ++i) {
      const float difference = found[i] - patches[i].level[lane];
      comparison.gradient_u[lane] += difference * patches[i].gradient_u[lane];
      comparison.gradient_v[lane] += difference * patches[i].gradient_v[lane];
      comparison.squares[lane] += difference * difference;
      comparison.correlation[lane] += patches[i].level[lane] * found[i];
      comparison.contrast[lane] += found[i] * found[i];
    }
  }
  return comparison;
}

/// align_patches for one of them.
inline std::optional<Alignment> naive_alignment(const PatchSearch& search, const cv::Mat1b& picture, double reach) {
  const Patch& patch = *search.patch;
  Eigen::Vector2d position = search.start;
  for (int iteration = 0; iteration < 12; ++iteration) {
    const Eigen::Vector2d half = kPatchRadius * search.warp.cwiseAbs().rowwise().sum();
    if ((position - half).minCoeff() < 0.0 || position.x() + half.x() >= picture.cols - 1 ||
        position.y() + half.y() >= picture.rows - 1) {
      return std::nullopt;
    }
    const Levels found = naive_sample(picture, position.cast<float>(), search.warp.cast<float>());
    Eigen::Vector2f gradient = Eigen::Vector2f::Zero();
    float squares = 0.0F;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const float difference = found[i] - patch.level[i];
      gradient += difference * Eigen::Vector2f(patch.gradient_u[i], patch.gradient_v[i]);
      squares += difference * difference;
    }
    const Eigen::Vector2d step = search.warp * (patch.inverse_hessian * gradient).cast<double>();
    position -= step;
    if ((position - search.start).norm() > reach) return std::nullopt;
    if (step.norm() > 0.005) continue;
    const float correlation = dot(patch.level, found) / std::sqrt(std::max(patch.contrast * dot(found, found), 1e-6F));
    if (correlation < 0.75F) return std::nullopt;
    const float variance = squares / (kPatchPixels - 3) + 0.5F;
    return Alignment{position, search.warp * (variance * patch.inverse_hessian).cast<double>() * search.warp.transpose()};
  }
  return std::nullopt;
}

}  // namespace brink::reference
