// Is the simulated ground as hard to match as the real one? The same figures for real pictures and for simulated ones, taken by
// the same camera from the same height and angle.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "brink/disparity.hpp"
#include "brink/ground.hpp"
#include "brink/sequence.hpp"
#include "brink/sim/render.hpp"
#include "test_data.hpp"

namespace brink::sim {
namespace {

/// A pair of pictures and where in the left one there is ground that both eyes see.
struct GroundView {
  std::string name;
  Frame frame;
  cv::Mat1b ground;
};

struct MatchFigures {
  double density_percent = 0.0;    ///< valid share of the ground
  double agreement_percent = 0.0;  ///< of those: the right view's disparity agrees within 1 px
  double plane_residual_px = 0.0;  ///< median over 21x21 px windows: distance from the fitted plane, root mean square
};

struct PictureFigures {
  double local_contrast = 0.0;  ///< median over 15x15 px windows: standard deviation over mean
  double gradient_p50 = 0.0;    ///< Sobel magnitude over the mean, percent a pixel
  double gradient_p90 = 0.0;
  double gradient_p99 = 0.0;
  double noise = 0.0;  ///< left against warped right, grey levels, as the standard deviation of one eye
};

double percentile(std::vector<float> values, double share) {
  if (values.empty()) return std::nan("");
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, place);
  return *place;
}

cv::Mat1f compute_right_disparity(const Frame& frame, const DisparityParams& params) {
  cv::Mat1b left;
  cv::Mat1b right;
  cv::flip(frame.right, left, 1);
  cv::flip(frame.left, right, 1);
  cv::Mat1f disparity;
  cv::flip(compute_disparity(left, right, params), disparity, 1);
  return disparity;
}

/// Root mean square distance of a window's disparities from their plane; NaN unless all are valid.
double window_residual(const cv::Mat1f& window) {
  const int count = static_cast<int>(window.total());
  cv::Mat1d system(count, 3);
  cv::Mat1d values(count, 1);
  int row = 0;
  for (int v = 0; v < window.rows; ++v) {
    for (int u = 0; u < window.cols; ++u, ++row) {
      if (window(v, u) == kInvalidDisparity) return std::nan("");
      system(row, 0) = u;
      system(row, 1) = v;
      system(row, 2) = 1.0;
      values(row, 0) = window(v, u);
    }
  }
  cv::Mat1d plane;
  cv::solve(system, values, plane, cv::DECOMP_NORMAL);
  return cv::norm(system * plane, values, cv::NORM_L2) / std::sqrt(static_cast<double>(count));
}

MatchFigures measure_matching(const GroundView& view, Matcher matcher) {
  DisparityParams params;
  params.matcher = matcher;
  const cv::Mat1f left = compute_disparity(view.frame.left, view.frame.right, params);
  const cv::Mat1f right = compute_right_disparity(view.frame, params);
  double known = 0.0;
  double valid = 0.0;
  double agreeing = 0.0;
  std::vector<float> residuals;
  constexpr int kReach = 10;
  for (int v = 0; v < left.rows; ++v) {
    for (int u = 0; u < left.cols; ++u) {
      if (view.ground(v, u) == 0) continue;
      known += 1.0;
      const float d = left(v, u);
      if (d == kInvalidDisparity) continue;
      valid += 1.0;
      const int partner = u - static_cast<int>(std::lround(d));
      if (partner >= 0 && right(v, partner) != kInvalidDisparity && std::abs(right(v, partner) - d) <= 1.0F) agreeing += 1.0;
      const cv::Rect window(u - kReach, v - kReach, 2 * kReach + 1, 2 * kReach + 1);
      if (u % 16 != 0 || v % 16 != 0 || (window & cv::Rect({0, 0}, left.size())) != window) continue;
      const double residual = window_residual(left(window));
      if (!std::isnan(residual)) residuals.push_back(static_cast<float>(residual));
    }
  }
  return {100.0 * valid / known, 100.0 * agreeing / valid, percentile(residuals, 0.5)};
}

PictureFigures measure_picture(const GroundView& view) {
  cv::Mat1f left;
  cv::Mat1f right;
  view.frame.left.convertTo(left, CV_32F);
  view.frame.right.convertTo(right, CV_32F);
  const double brightness = cv::mean(left, view.ground)[0];
  right *= brightness / cv::mean(right, view.ground)[0];
  cv::Mat1f mean;
  cv::Mat1f square;
  cv::blur(left, mean, {15, 15});
  cv::blur(left.mul(left), square, {15, 15});
  cv::Mat1f gradient_u;
  cv::Mat1f gradient_v;
  cv::Sobel(left, gradient_u, CV_32F, 1, 0, 3, 0.125);
  cv::Sobel(left, gradient_v, CV_32F, 0, 1, 3, 0.125);
  const cv::Mat1f disparity = compute_disparity(view.frame.left, view.frame.right);
  std::vector<float> contrasts;
  std::vector<float> gradients;
  std::vector<float> differences;
  for (int v = 0; v < left.rows; ++v) {
    for (int u = 0; u < left.cols; ++u) {
      if (view.ground(v, u) == 0) continue;
      contrasts.push_back(std::sqrt(std::max(0.0F, square(v, u) - mean(v, u) * mean(v, u))) / std::max(1.0F, mean(v, u)));
      gradients.push_back(static_cast<float>(100.0 * std::hypot(gradient_u(v, u), gradient_v(v, u)) / brightness));
      const float partner = static_cast<float>(u) - disparity(v, u);
      const int first = static_cast<int>(partner);
      if (disparity(v, u) == kInvalidDisparity || partner < 0.0F || first + 1 >= left.cols) continue;
      const float share = partner - static_cast<float>(first);
      differences.push_back(std::abs(left(v, u) - (1.0F - share) * right(v, first) - share * right(v, first + 1)));
    }
  }
  return {percentile(contrasts, 0.5), percentile(gradients, 0.5), percentile(gradients, 0.9), percentile(gradients, 0.99),
          1.4826 / std::numbers::sqrt2 * percentile(differences, 0.5)};
}

}  // namespace
}  // namespace brink::sim
