#pragma once

#include <optional>
#include <random>
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

/// v-disparity histogram (Labayrade et al. 2002) of a picture turned back by a roll angle: the ground, a plane in disparity
/// space with slopes a / b = tan(roll), becomes the straight line d = b v' + c' over the sheared row v' = v + tan(roll) u.
class VDisparity {
 public:
  /// @param samples u from the principal point. @param height rows of the picture, px.
  VDisparity(const std::vector<DisparitySample>& samples, double tan_roll, int height);

  /// Sum over the sheared rows of the samples within +-tolerance of a line, each row weighted by weight(v').
  /// @param relative_tolerance share of the disparity. @param tolerance_px never less than this.
  [[nodiscard]] double support(double slope, double offset, double relative_tolerance, double tolerance_px) const;

 private:
  [[nodiscard]] int count_between(int row, double low, double high) const;

  double first_row_ = 0.0;  ///< v' of the upper edge of row 0
  int bins_ = 0;            ///< disparity bins per row
  cv::Mat1i cumulative_;    ///< per row: number of samples in all bins before this one; bins_ + 1 columns
  std::vector<double> row_weight_;
};

/// Weight of a picture row as evidence of the ground: of two parallel surfaces (platform and track bed) the ground is the one
/// under the feet, which explains the bottom of the picture.
double row_weight(double v, int height);

}  // namespace brink
