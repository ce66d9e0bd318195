#include "ground/v_disparity.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "ground/v_disparity_simd.hpp"

namespace brink {
namespace {

constexpr double kRowStep = 4.0;  // px of v' per histogram row
constexpr double kBin = 0.5;      // px of disparity per bin

}  // namespace

std::vector<DisparitySample> sample_disparities(const cv::Mat1f& disparity, double cx, double min_disparity, int step) {
  std::vector<DisparitySample> samples;
  samples.reserve(static_cast<std::size_t>(disparity.rows / step + 1) * static_cast<std::size_t>(disparity.cols / step + 1));
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

BinnedSamples::BinnedSamples(std::vector<DisparitySample> samples) : samples_(std::move(samples)) {
  bins_.reserve(samples_.size());
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    bins_.push_back(static_cast<int>(samples_[i].d / kBin));
    bin_count_ = std::max(bin_count_, bins_.back() + 1);
    const bool is_first = i == 0 || samples_[i - 1].v != samples_[i].v;
    const bool is_last = i + 1 == samples_.size() || samples_[i + 1].v != samples_[i].v;
    if (is_first || is_last) ends_.push_back(samples_[i]);
  }
}

VDisparity::VDisparity(const BinnedSamples& samples, double tan_roll, int height) : bins_(samples.bin_count_) {
  double first = 0.0;
  double last = 0.0;
  for (const DisparitySample& s : samples.ends_) {
    const double v = s.v + tan_roll * s.u;
    first = std::min(first, v);
    last = std::max(last, v);
  }
  const int rows = static_cast<int>((last - first) / kRowStep) + 1;
  const auto stride = static_cast<std::size_t>(rows);
  cumulative_.resize(stride * (static_cast<std::size_t>(bins_) + 1));
  int* const counts = cumulative_.data() + stride;  // each in the bin after its own
  for (std::size_t i = 0; i < samples.samples_.size(); ++i) {
    const DisparitySample& s = samples.samples_[i];
    ++counts[samples.bins_[i] * rows + static_cast<int>((s.v + tan_roll * s.u - first) / kRowStep)];
  }
  for (std::size_t i = stride; i < cumulative_.size(); ++i) cumulative_[i] += cumulative_[i - stride];
  for (int row = 0; row < rows; ++row) {
    row_v_.push_back(first + (row + 0.5) * kRowStep);
    row_weight_.push_back(row_weight(row_v_.back(), height));
    weight_ += row_weight_.back() * cumulative_[cumulative_.size() - stride + static_cast<std::size_t>(row)];
  }
  band_counts_.resize(stride);
}

// From the bottom, where most of the weight is, and only while the rows above may still make up for what is missing.
std::optional<double> VDisparity::support(double slope, double offset, double relative_tolerance, double tolerance_px,
                                          double least) {
  constexpr double kRounding = 1e-9;  // far more than sums in another order differ by
  constexpr int kRowsAtOnce = 16;
  const auto rows = static_cast<int>(row_v_.size());
  const CumulativeCounts histogram{cumulative_.data(), rows, bins_, 1.0 / kBin};
  const LineBand band{slope, offset, relative_tolerance, tolerance_px};
  const int* const totals = cumulative_.data() + cumulative_.size() - row_v_.size();
  const double* const weights = row_weight_.data();
  int* const counts = band_counts_.data();
  double most = weight_ * (1.0 + kRounding);
  for (int end = rows; end > 0; end -= kRowsAtOnce) {
    const int begin = std::max(0, end - kRowsAtOnce);
    count_rows_in_band(histogram, row_v_.data(), begin, end, band, counts);
    for (int row = begin; row < end; ++row) most -= weights[row] * (totals[row] - counts[row]);
    if (most < least) return std::nullopt;
  }
  return std::inner_product(row_weight_.begin(), row_weight_.end(), band_counts_.begin(), 0.0);
}

}  // namespace brink
