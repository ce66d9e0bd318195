#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "ground/v_disparity.hpp"

namespace brink::reference {

/// VDisparity, with the counts of single bins.
class NaiveVDisparity {
 public:
  NaiveVDisparity(const std::vector<DisparitySample>& samples, double tan_roll, int height) : height_(height) {
    double last = 0.0;
    for (const DisparitySample& s : samples) {
      first_ = std::min(first_, s.v + tan_roll * s.u);
      last = std::max(last, s.v + tan_roll * s.u);
    }
    rows_ = static_cast<int>((last - first_) / 4.0) + 1;
    for (const DisparitySample& s : samples) {
      const int row = static_cast<int>((s.v + tan_roll * s.u - first_) / 4.0);
      ++counts_[{row, static_cast<int>(s.d / 0.5)}];
    }
  }

  [[nodiscard]] double support(double slope, double offset, double relative_tolerance, double tolerance_px) const {
    double sum = 0.0;
    for (int row = 0; row < rows_; ++row) {
      const double v = first_ + (row + 0.5) * 4.0;
      const double d = slope * v + offset;
      if (d <= 0.0) continue;
      const double tolerance = std::max(tolerance_px, relative_tolerance * d);
      int count = 0;
      for (const auto& [place, samples] : counts_) {
        const bool touches =
            place.second >= std::floor((d - tolerance) / 0.5) && place.second < std::ceil((d + tolerance) / 0.5);
        if (place.first == row && touches) count += samples;
      }
      sum += row_weight(v, height_) * count;
    }
    return sum;
  }

 private:
  int height_;
  double first_ = 0.0;
  int rows_ = 0;
  std::map<std::pair<int, int>, int> counts_;  ///< of row and bin
};

}  // namespace brink::reference
