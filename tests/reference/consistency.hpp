#pragma once

#include <cmath>

#include <opencv2/core.hpp>

#include "brink/frame.hpp"

namespace brink::reference {

/// check_consistency, pixel by pixel.
inline cv::Mat1f naive_consistency(const cv::Mat1f& left, const cv::Mat1f& right, float threshold_px) {
  cv::Mat1f checked(left.size(), kInvalidDisparity);
  for (int v = 0; v < left.rows; ++v) {
    for (int u = 0; u < left.cols; ++u) {
      const float d = left(v, u);
      if (d == kInvalidDisparity) continue;
      const float counterpart = static_cast<float>(u) - d + 0.5F;
      if (counterpart < 0.0F || counterpart >= static_cast<float>(right.cols)) continue;
      const float back = right(v, static_cast<int>(counterpart));
      if (back != kInvalidDisparity && std::abs(d - back) <= threshold_px) checked(v, u) = d;
    }
  }
  return checked;
}

}  // namespace brink::reference
