#include "ground/v_disparity.hpp"

#include <algorithm>
#include <cmath>

namespace brink {
namespace {

constexpr double kRowStep = 4.0;  // px of v' per histogram row
constexpr double kBin = 0.5;      // px of disparity per bin

}  // namespace

std::vector<DisparitySample> sample_disparities(const cv::Mat1f& disparity, double cx, double min_disparity, int step) {
  std::vector<DisparitySample> samples;
  for (int v = step / 2; v < disparity.rows; v += step) {
    const float* row = disparity[v];
    for (int u = step / 2; u < disparity.cols; u += step) {
      if (row[u] > 0.0F && row[u] >= static_cast<float>(min_disparity)) {
        samples.push_back({static_cast<float>(u - cx), static_cast<float>(v), row[u]});
      }
    }
  }
  return samples;
}

double row_weight(double v, int height) {
  const double share = std::clamp((v + 1.0) / height, 0.0, 1.0);
  return share * share;
}

VDisparity::VDisparity(const std::vector<DisparitySample>& samples, double tan_roll, int height) {
  double first = 0.0;
  double last = 0.0;
  float largest = 0.0F;
  for (const DisparitySample& s : samples) {
    const double v = s.v + tan_roll * s.u;
    first = std::min(first, v);
    last = std::max(last, v);
    largest = std::max(largest, s.d);
  }
  first_row_ = first;
  bins_ = static_cast<int>(largest / kBin) + 1;
  const int rows = static_cast<int>((last - first) / kRowStep) + 1;
  cumulative_ = cv::Mat1i::zeros(rows, bins_ + 1);
  for (const DisparitySample& s : samples) {
    const int row = static_cast<int>((s.v + tan_roll * s.u - first) / kRowStep);
    ++cumulative_(row, static_cast<int>(s.d / kBin) + 1);
  }
  for (int row = 0; row < rows; ++row) {
    for (int bin = 0; bin < bins_; ++bin) cumulative_(row, bin + 1) += cumulative_(row, bin);
    row_weight_.push_back(row_weight(first + (row + 0.5) * kRowStep, height));
  }
}

int VDisparity::count_between(int row, double low, double high) const {
  const int first = std::clamp(static_cast<int>(std::floor(low / kBin)), 0, bins_);
  const int last = std::clamp(static_cast<int>(std::ceil(high / kBin)), 0, bins_);
  return cumulative_(row, last) - cumulative_(row, first);
}

double VDisparity::support(double slope, double offset, double relative_tolerance, double tolerance_px) const {
  double sum = 0.0;
  for (int row = 0; row < cumulative_.rows; ++row) {
    const double d = slope * (first_row_ + (row + 0.5) * kRowStep) + offset;
    if (d <= 0.0) continue;
    const double tolerance = std::max(tolerance_px, relative_tolerance * d);
    sum += row_weight_[static_cast<std::size_t>(row)] * count_between(row, d - tolerance, d + tolerance);
  }
  return sum;
}

}  // namespace brink
