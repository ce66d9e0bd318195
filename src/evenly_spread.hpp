#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/core.hpp>

#include "scan.hpp"

namespace brink {

/// About so many pixels of a mask on an even grid, row by row; all of them when it has fewer.
/// @param mask 255 = pixel.
inline std::vector<cv::Point> spread_evenly(const cv::Mat1b& mask, int target) {
  const cv::Rect box = find_box(mask);
  const int step = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(cv::countNonZero(mask)) / target)));
  std::vector<cv::Point> pixels;
  for (int v = box.y; v < box.br().y; v += step) {
    for (int u = box.x; u < box.br().x; u += step) {
      if (mask(v, u) != 0) pixels.emplace_back(u, v);
    }
  }
  return pixels;
}

}  // namespace brink
