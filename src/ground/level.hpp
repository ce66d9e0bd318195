#pragma once

#include <cmath>

#include <opencv2/core.hpp>

namespace brink {

/// What of a row lies within a tolerance of the ground, 255 = so. No elevation (NaN) does not.
inline void select_level_row(const float* elevation, int width, float tolerance_m, uchar* level) {
  for (int u = 0; u < width; ++u) level[u] = std::abs(elevation[u]) < tolerance_m ? uchar{255} : uchar{0};
}

inline cv::Mat1b select_level(const cv::Mat1f& elevation, double tolerance_m) {
  cv::Mat1b level(elevation.size());
  for (int v = 0; v < elevation.rows; ++v) {
    select_level_row(elevation[v], elevation.cols, static_cast<float>(tolerance_m), level[v]);
  }
  return level;
}

}  // namespace brink
