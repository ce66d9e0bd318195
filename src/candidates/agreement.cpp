#include "candidates/agreement.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace brink {
namespace {

constexpr int kRadius = 3;         // px, half of a window
constexpr double kContrast = 1.0;  // grey levels, standard deviation in the left window, at least: less is noise
constexpr std::size_t kFewest = 20;

/// Correlation of the window around (u, v) in the left picture with that at u - disparity in the right one; empty where a
/// window leaves its picture or has no contrast.
std::optional<double> correlate(const Frame& frame, int u, int v, double disparity) {
  const double right_u = u - disparity;
  const int middle = static_cast<int>(std::floor(right_u));
  const double part = right_u - middle;
  if (u < kRadius || v < kRadius || u + kRadius >= frame.left.cols || v + kRadius >= frame.left.rows) return std::nullopt;
  if (middle < kRadius || middle + kRadius + 1 >= frame.right.cols) return std::nullopt;
  int left_sum = 0;
  int left_squares = 0;
  for (int dv = -kRadius; dv <= kRadius; ++dv) {
    for (int du = -kRadius; du <= kRadius; ++du) {
      const int left = frame.left(v + dv, u + du);
      left_sum += left;
      left_squares += left * left;
    }
  }
  constexpr double kPixels = (2.0 * kRadius + 1.0) * (2.0 * kRadius + 1.0);
  const double sum_l = left_sum;
  const double variance_l = left_squares / kPixels - sum_l * sum_l / (kPixels * kPixels);
  if (variance_l < kContrast * kContrast) return std::nullopt;
  double sum_r = 0.0;
  double sum_rr = 0.0;
  double sum_lr = 0.0;
  for (int dv = -kRadius; dv <= kRadius; ++dv) {
    for (int du = -kRadius; du <= kRadius; ++du) {
      const double right = (1.0 - part) * frame.right(v + dv, middle + du) + part * frame.right(v + dv, middle + du + 1);
      sum_r += right;
      sum_rr += right * right;
      sum_lr += frame.left(v + dv, u + du) * right;
    }
  }
  const double variance_r = sum_rr / kPixels - sum_r * sum_r / (kPixels * kPixels);
  if (variance_r <= 0.0) return 0.0;
  return (sum_lr / kPixels - sum_l * sum_r / (kPixels * kPixels)) / std::sqrt(variance_l * variance_r);
}

}  // namespace

double compute_agreement(const Frame& frame, const std::vector<cv::Point>& pixels, const cv::Mat1f& disparity) {
  if (frame.right.empty()) return 1.0;
  std::vector<double> correlations;
  for (const cv::Point& p : pixels) {
    if (const std::optional<double> window = correlate(frame, p.x, p.y, disparity(p))) correlations.push_back(*window);
  }
  if (correlations.size() < kFewest) return 1.0;
  const auto quarter = correlations.begin() + static_cast<std::ptrdiff_t>(correlations.size() / 4);
  std::ranges::nth_element(correlations, quarter);
  return *quarter;
}

}  // namespace brink
