#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <opencv2/core.hpp>

namespace brink::reference {

struct FilteredPixel {
  int blob = 0;
  int corner = 0;
  int gradient_u = 0;
  int gradient_v = 0;
};

/// The 5x5 filters of filter_row as they are defined.
inline FilteredPixel naive_filters(const cv::Mat1b& picture, cv::Point place) {
  constexpr int kDerivative[] = {-1, -2, 0, 2, 1};  // NOLINT(modernize-avoid-c-arrays)
  constexpr int kSmooth[] = {1, 4, 6, 4, 1};        // NOLINT(modernize-avoid-c-arrays)
  FilteredPixel result;
  int along = 0;
  int down = 0;
  for (int y = -2; y <= 2; ++y) {
    for (int x = -2; x <= 2; ++x) {
      const int level = picture(place.y + y, place.x + x);
      const int ring = std::max(std::abs(x), std::abs(y));
      result.blob += (ring == 0 ? 8 : ring == 1 ? 1 : -1) * level;
      result.corner += (x > 0 ? 1 : x < 0 ? -1 : 0) * (y > 0 ? 1 : y < 0 ? -1 : 0) * level;
      along += kDerivative[x + 2] * kSmooth[y + 2] * level;
      down += kSmooth[x + 2] * kDerivative[y + 2] * level;
    }
  }
  result.gradient_u = 128 + static_cast<int>(std::nearbyint(along / 128.0));
  result.gradient_v = 128 + static_cast<int>(std::nearbyint(down / 128.0));
  return result;
}

/// find_row_extrema for one pixel.
inline bool naive_is_extremum(const cv::Mat1s& response, cv::Point place, int radius, int least_strength) {
  const int value = response(place);
  bool least = value <= -least_strength;
  bool greatest = value >= least_strength;
  for (int v = place.y - radius; v <= place.y + radius; ++v) {
    for (int u = place.x - radius; u <= place.x + radius; ++u) {
      least = least && response(v, u) >= value;
      greatest = greatest && response(v, u) <= value;
    }
  }
  return least || greatest;
}

}  // namespace brink::reference
