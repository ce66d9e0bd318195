#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "brink/ground.hpp"

namespace brink {

/// A pixel that has a disparity. u is counted from the principal point, so that a roll turns about the optical axis.
struct DisparitySample {
  float u = 0.0F;
  float v = 0.0F;
  float d = 0.0F;
};

/// Every step-th valid pixel in each direction with a disparity of at least min_disparity, row by row.
std::vector<DisparitySample> sample_disparities(const cv::Mat1f& disparity, double cx, double min_disparity, int step);

/// Samples as the histograms of all roll angles need them.
class BinnedSamples {
 public:
  /// @param samples u from the principal point, row by row.
  explicit BinnedSamples(std::vector<DisparitySample> samples);

  [[nodiscard]] const std::vector<DisparitySample>& samples() const { return samples_; }

 private:
  friend class VDisparity;
  std::vector<DisparitySample> samples_;
  std::vector<int> bins_;              ///< of their disparities
  std::vector<DisparitySample> ends_;  ///< the first and the last one of each row
  int bin_count_ = 1;
};

/// v-disparity histogram (Labayrade et al. 2002) of a picture turned back by a roll angle: the ground, a plane in disparity
/// space with slopes a / b = tan(roll), becomes the straight line d = b v' + c' over the sheared row v' = v + tan(roll) u.
class VDisparity {
 public:
  /// @param height rows of the picture, px.
  VDisparity(const BinnedSamples& samples, double tan_roll, int height);

  /// Sum over the sheared rows of the samples within +-tolerance of a line, each row weighted by weight(v').
  /// @param relative_tolerance share of the disparity. @param tolerance_px never less than this.
  /// @param least empty when the sum is less than this.
  [[nodiscard]] std::optional<double> support(double slope, double offset, double relative_tolerance, double tolerance_px,
                                              double least);

 private:
  int bins_ = 0;                 ///< of disparity
  std::vector<int> cumulative_;  ///< CumulativeCounts
  std::vector<double> row_v_;    ///< v' in the middle of a row
  std::vector<double> row_weight_;
  double weight_ = 0.0;           ///< of all samples
  std::vector<int> band_counts_;  ///< of the last line
};

/// Weight of a picture row as evidence of the ground: of two parallel surfaces (platform and track bed) the ground is the one
/// under the feet, which explains the bottom of the picture.
double row_weight(double v, int height);

}  // namespace brink
