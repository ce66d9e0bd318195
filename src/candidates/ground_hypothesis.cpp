#include "candidates/ground_hypothesis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace brink {
namespace {

constexpr int kRadius = 3;  // px, half of the compared window
constexpr int kWidth = 2 * kRadius + 1;
constexpr double kApart = 1.0;     // px between the hypotheses, at least: nearer ones cannot be told apart
constexpr double kSlack = 0.25;    // px that either hypothesis may be off
constexpr double kContrast = 1.0;  // grey levels, standard deviation in a window, at least: less is noise
constexpr int kFewest = 20;

/// Whether a window of the left picture has contrast: without it, it looks alike everywhere.
bool has_contrast(const cv::Mat1b& picture, int u, int v) {
  if (u < kRadius || v < kRadius || u + kRadius >= picture.cols || v + kRadius >= picture.rows) return false;
  int sum = 0;
  int squares = 0;
  for (int dv = -kRadius; dv <= kRadius; ++dv) {
    const uchar* const row = picture[v + dv] + u - kRadius;
    for (int k = 0; k < kWidth; ++k) {
      sum += row[k];
      squares += row[k] * row[k];
    }
  }
  constexpr int kPixels = kWidth * kWidth;
  return kPixels * squares - sum * sum >= kContrast * kContrast * kPixels * kPixels;
}

/// Mean absolute difference of the window around (u, v) in the left picture to that at u - disparity in the right one, their
/// means set equal; empty where a window leaves its picture.
std::optional<double> compare(const Frame& frame, int u, int v, double disparity) {
  const double right_u = u - disparity;
  const int first = static_cast<int>(std::floor(right_u)) - kRadius;
  const double part = right_u - std::floor(right_u);
  if (u < kRadius || v < kRadius || u + kRadius >= frame.left.cols || v + kRadius >= frame.left.rows) return std::nullopt;
  if (first < 0 || first + kWidth >= frame.right.cols) return std::nullopt;
  std::array<double, static_cast<std::size_t>(kWidth) * kWidth> differences{};
  double mean = 0.0;
  std::size_t i = 0;
  for (int dv = -kRadius; dv <= kRadius; ++dv) {
    const uchar* left = frame.left[v + dv] + u - kRadius;
    const uchar* right = frame.right[v + dv] + first;
    for (int k = 0; k < kWidth; ++k, ++i) {
      differences.at(i) = left[k] - ((1.0 - part) * right[k] + part * right[k + 1]);
      mean += differences.at(i) / static_cast<double>(differences.size());
    }
  }
  double sum = 0.0;
  for (const double difference : differences) sum += std::abs(difference - mean);
  return sum / static_cast<double>(differences.size());
}

/// The best comparison with the hypothesis a little off to either side.
std::optional<double> compare_around(const Frame& frame, int u, int v, double disparity) {
  std::optional<double> best;
  for (const double off : {-kSlack, 0.0, kSlack}) {
    const std::optional<double> cost = compare(frame, u, v, disparity + off);
    if (cost && (!best || *cost < *best)) best = cost;
  }
  return best;
}

}  // namespace

double compute_ground_misfit(const Frame& frame, const std::vector<cv::Point>& pixels, const cv::Mat1f& disparity,
                             const cv::Mat1f& elevation, const GroundPose& pose) {
  if (frame.right.empty()) return 1.0;
  int judged = 0;
  double own_sum = 0.0;
  double ground_sum = 0.0;
  for (const cv::Point& p : pixels) {
    const double d = disparity(p);
    const double ground = d * (1.0 - elevation(p) / pose.height_m);  // e = h (1 - d_ground / d)
    if (ground - d < kApart || !has_contrast(frame.left, p.x, p.y)) continue;
    const std::optional<double> own = compare_around(frame, p.x, p.y, d);
    const std::optional<double> grounds = compare_around(frame, p.x, p.y, ground);
    if (!own || !grounds) continue;
    ++judged;
    own_sum += *own;
    ground_sum += *grounds;
  }
  if (judged < kFewest || ground_sum == 0.0) return 1.0;
  return std::max(0.0, 1.0 - own_sum / ground_sum);
}

}  // namespace brink
