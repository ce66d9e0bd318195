#include "candidates/agreement.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "evenly_spread.hpp"

namespace brink {
namespace {

constexpr int kRadius = 3;          // px, half of a window
constexpr double kContrast = 1.0;   // grey levels, standard deviation in the left window, at least: less is noise
constexpr int kTargetPixels = 400;  // of a region, evenly spread
constexpr std::size_t kFewest = 20;

/// Correlation of the window around (u, v) in the left picture with that at u - disparity in the right one; empty where a
/// window leaves its picture or has no contrast.
std::optional<double> correlate(const Frame& frame, int u, int v, double disparity) {
  const double right_u = u - disparity;
  const int middle = static_cast<int>(std::floor(right_u));
  const double part = right_u - middle;
  if (u < kRadius || v < kRadius || u + kRadius >= frame.left.cols || v + kRadius >= frame.left.rows) return std::nullopt;
  if (middle < kRadius || middle + kRadius + 1 >= frame.right.cols) return std::nullopt;
  double n = 0.0;
  double sum_l = 0.0;
  double sum_r = 0.0;
  double sum_ll = 0.0;
  double sum_rr = 0.0;
  double sum_lr = 0.0;
  for (int dv = -kRadius; dv <= kRadius; ++dv) {
    for (int du = -kRadius; du <= kRadius; ++du) {
      const double left = frame.left(v + dv, u + du);
      const double right = (1.0 - part) * frame.right(v + dv, middle + du) + part * frame.right(v + dv, middle + du + 1);
      n += 1.0;
      sum_l += left;
      sum_r += right;
      sum_ll += left * left;
      sum_rr += right * right;
      sum_lr += left * right;
    }
  }
  const double variance_l = sum_ll / n - sum_l * sum_l / (n * n);
  const double variance_r = sum_rr / n - sum_r * sum_r / (n * n);
  if (variance_l < kContrast * kContrast) return std::nullopt;
  if (variance_r <= 0.0) return 0.0;
  return (sum_lr / n - sum_l * sum_r / (n * n)) / std::sqrt(variance_l * variance_r);
}

}  // namespace

double compute_agreement(const Frame& frame, const cv::Mat1b& deep, const cv::Mat1f& disparity) {
  if (frame.right.empty()) return 1.0;
  std::vector<double> correlations;
  for (const cv::Point& p : spread_evenly(deep, kTargetPixels)) {
    if (const std::optional<double> window = correlate(frame, p.x, p.y, disparity(p))) correlations.push_back(*window);
  }
  if (correlations.size() < kFewest) return 1.0;
  const auto quarter = correlations.begin() + static_cast<std::ptrdiff_t>(correlations.size() / 4);
  std::ranges::nth_element(correlations, quarter);
  return *quarter;
}

}  // namespace brink
