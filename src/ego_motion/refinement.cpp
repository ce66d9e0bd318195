#include "ego_motion/refinement.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include <Eigen/LU>
#include <opencv2/imgproc.hpp>

namespace brink {
namespace {

constexpr int kMaxIterations = 12;
constexpr double kSettled = 0.005;          // px: a tenth of the noise
constexpr float kLeastCurvature = 400.0F;   // smaller eigenvalue of the Hessian, grey levels^2: noise alone stays below
constexpr float kLeastCorrelation = 0.75F;  // of levels, patch and picture

using Levels = std::array<float, kPatchPixels>;

void subtract_mean(Levels& values) {
  const float mean = std::accumulate(values.begin(), values.end(), 0.0F) / kPatchPixels;
  for (float& value : values) value -= mean;
}

float dot(const Levels& a, const Levels& b) { return std::inner_product(a.begin(), a.end(), b.begin(), 0.0F); }

/// Levels of the warped square around a position, bilinear, less their mean; empty when it is not inside the picture.
std::optional<Levels> sample(const cv::Mat1b& picture, const Eigen::Vector2d& position, const Eigen::Matrix2d& warp) {
  const Eigen::Vector2d half = kPatchRadius * warp.cwiseAbs().rowwise().sum();
  if (!((position - half).minCoeff() >= 0.0 && position.x() + half.x() < picture.cols - 1 &&
        position.y() + half.y() < picture.rows - 1)) {
    return std::nullopt;
  }
  const Eigen::Matrix2f step = warp.cast<float>();
  const Eigen::Vector2f centre = position.cast<float>();
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
  subtract_mean(levels);
  return levels;
}

/// Least-squares shift of the patch, in its own coordinates, that explains the difference.
Eigen::Vector2f compute_shift(const Patch& patch, const Levels& levels) {
  Eigen::Vector2f gradient = Eigen::Vector2f::Zero();
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const float difference = levels[i] - patch.level[i];
    gradient += difference * Eigen::Vector2f(patch.gradient_u[i], patch.gradient_v[i]);
  }
  return patch.inverse_hessian * gradient;
}

/// The covariance that the remaining differences tell; empty when they are too great.
std::optional<Eigen::Matrix2d> judge(const Patch& patch, const Levels& levels, const Eigen::Matrix2d& warp) {
  const float correlation = dot(patch.level, levels) / std::sqrt(std::max(patch.contrast * dot(levels, levels), 1e-6F));
  if (correlation < kLeastCorrelation) return std::nullopt;
  float squares = 0.0F;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const float difference = levels[i] - patch.level[i];
    squares += difference * difference;
  }
  const float variance = squares / (kPatchPixels - 3) + 0.5F;  // at least what rounding to whole levels leaves
  return warp * (variance * patch.inverse_hessian).cast<double>() * warp.transpose();
}

}  // namespace

std::optional<Patch> make_patch(const cv::Mat1b& smooth, cv::Point centre) {
  const int reach = kPatchRadius + 1;
  if (centre.x < reach || centre.y < reach || centre.x >= smooth.cols - reach || centre.y >= smooth.rows - reach) {
    return std::nullopt;
  }
  Patch patch;
  patch.centre = centre;
  std::size_t i = 0;
  for (int y = centre.y - kPatchRadius; y <= centre.y + kPatchRadius; ++y) {
    for (int x = centre.x - kPatchRadius; x <= centre.x + kPatchRadius; ++x, ++i) {
      patch.level[i] = smooth(y, x);
      patch.gradient_u[i] = 0.5F * static_cast<float>(smooth(y, x + 1) - smooth(y, x - 1));
      patch.gradient_v[i] = 0.5F * static_cast<float>(smooth(y + 1, x) - smooth(y - 1, x));
    }
  }
  subtract_mean(patch.level);
  subtract_mean(patch.gradient_u);
  subtract_mean(patch.gradient_v);
  patch.contrast = dot(patch.level, patch.level);
  Eigen::Matrix2f hessian;
  hessian << dot(patch.gradient_u, patch.gradient_u), dot(patch.gradient_u, patch.gradient_v),
      dot(patch.gradient_u, patch.gradient_v), dot(patch.gradient_v, patch.gradient_v);
  const float half_trace = 0.5F * hessian.trace();
  const float least = half_trace - std::sqrt(std::max(half_trace * half_trace - hessian.determinant(), 0.0F));
  if (least < kLeastCurvature) return std::nullopt;
  patch.inverse_hessian = hessian.inverse();
  return patch;
}

std::optional<Alignment> align_patch(const Patch& patch, const cv::Mat1b& smooth, const Eigen::Vector2d& start,
                                     const Eigen::Matrix2d& warp, double reach) {
  Eigen::Vector2d position = start;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const std::optional<Levels> levels = sample(smooth, position, warp);
    if (!levels) return std::nullopt;
    const Eigen::Vector2d step = warp * compute_shift(patch, *levels).cast<double>();
    position -= step;
    if (!((position - start).norm() <= reach)) return std::nullopt;
    if (step.norm() > kSettled) continue;
    const std::optional<Eigen::Matrix2d> covariance = judge(patch, *levels, warp);
    if (!covariance) return std::nullopt;
    return Alignment{position, *covariance};
  }
  return std::nullopt;
}

cv::Mat1b smooth_for_patches(const cv::Mat1b& picture) {
  cv::Mat1b smooth;
  cv::GaussianBlur(picture, smooth, {5, 5}, 0.8);
  return smooth;
}

}  // namespace brink
