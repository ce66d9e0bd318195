#include "ground/roughness.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "evenly_spread.hpp"

namespace brink {
namespace {

constexpr int kRadius = 3;           // px, half of a window
constexpr int kFewest = 20;          // pixels in a window
constexpr int kTargetWindows = 400;  // in a region, evenly spread

/// Root mean square distance from the plane through the disparities around a pixel; empty when there are too few.
std::optional<double> scatter(const cv::Mat1b& deep, const cv::Mat1f& disparity, const cv::Point& middle) {
  const cv::Rect window =
      cv::Rect(middle.x - kRadius, middle.y - kRadius, 2 * kRadius + 1, 2 * kRadius + 1) & cv::Rect(cv::Point(), deep.size());
  int xx = 0;
  int xy = 0;
  int yy = 0;
  int sum_x = 0;
  int sum_y = 0;
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double squares = 0.0;
  int count = 0;
  for (int v = window.y; v < window.br().y; ++v) {
    for (int u = window.x; u < window.br().x; ++u) {
      if (deep(v, u) == 0) continue;
      const int x = u - middle.x;
      const int y = v - middle.y;
      const double d = disparity(v, u) - disparity(middle);
      xx += x * x;
      xy += x * y;
      yy += y * y;
      sum_x += x;
      sum_y += y;
      right += Eigen::Vector3d(x, y, 1.0) * d;
      squares += d * d;
      ++count;
    }
  }
  if (count < kFewest) return std::nullopt;
  Eigen::Matrix3d normal;
  normal << xx, xy, sum_x, xy, yy, sum_y, sum_x, sum_y, count;
  return std::sqrt(std::max(0.0, squares - right.dot(normal.ldlt().solve(right))) / count);
}

}  // namespace

double compute_roughness_px(const cv::Mat1b& deep, const cv::Mat1f& disparity) {
  std::vector<double> scatters;
  for (const cv::Point& p : spread_evenly(deep, kTargetWindows)) {
    if (const std::optional<double> window = scatter(deep, disparity, p)) scatters.push_back(*window);
  }
  if (scatters.empty()) return 0.0;
  const auto middle = scatters.begin() + static_cast<std::ptrdiff_t>(scatters.size() / 2);
  std::ranges::nth_element(scatters, middle);
  return *middle;
}

}  // namespace brink
