#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "brink/disparity.hpp"
#include "disparity/descriptors.hpp"
#include "disparity/valid_bits_simd.hpp"

// The naive twins of the disparity kernels: the definition, pixel by pixel, however slow.
namespace brink::reference {

/// Grey level with the border pixels repeated outside.
inline int grey(const cv::Mat1b& image, int u, int v) {
  return image(std::clamp(v, 0, image.rows - 1), std::clamp(u, 0, image.cols - 1));
}

/// Sobel response / 4, rounded half to even, + 128, saturated.
inline std::uint8_t gradient(const cv::Mat1b& image, int u, int v, bool horizontal) {
  int sum = 0;
  for (int k = -1; k <= 1; ++k) {
    const int weight = k == 0 ? 2 : 1;
    sum += weight * (horizontal ? grey(image, u + 1, v + k) - grey(image, u - 1, v + k)
                                : grey(image, u + k, v + 1) - grey(image, u + k, v - 1));
  }
  return static_cast<std::uint8_t>(std::clamp(static_cast<int>(std::nearbyint(sum / 4.0)) + 128, 0, 255));
}

inline Descriptor describe(const cv::Mat1b& image, int u, int v) {
  constexpr std::array<std::array<int, 2>, 12> kHorizontal = {
      {{0, -2}, {-2, -1}, {0, -1}, {2, -1}, {-1, 0}, {0, 0}, {0, 0}, {1, 0}, {-2, 1}, {0, 1}, {2, 1}, {0, 2}}};
  constexpr std::array<std::array<int, 2>, 4> kVertical = {{{0, -1}, {-1, 0}, {1, 0}, {0, 1}}};
  Descriptor descriptor{};
  std::size_t i = 0;
  for (const auto& [du, dv] : kHorizontal) descriptor[i++] = gradient(image, u + du, v + dv, true);
  for (const auto& [du, dv] : kVertical) descriptor[i++] = gradient(image, u + du, v + dv, false);
  return descriptor;
}

/// Spreads the smallest pixel number through every segment until nothing changes, then counts.
inline cv::Mat1f remove_speckles(const cv::Mat1f& disparity, float similarity_px, int min_size_px) {
  cv::Mat1i number(disparity.size());
  for (int v = 0; v < disparity.rows; ++v) {
    for (int u = 0; u < disparity.cols; ++u) number(v, u) = v * disparity.cols + u;
  }
  const cv::Rect picture(cv::Point(), disparity.size());
  const std::vector<cv::Point> steps = {{0, -1}, {-1, 0}, {1, 0}, {0, 1}};
  for (bool changed = true; changed;) {
    changed = false;
    for (int v = 0; v < disparity.rows; ++v) {
      for (int u = 0; u < disparity.cols; ++u) {
        const cv::Point at(u, v);
        for (const cv::Point& step : steps) {
          const cv::Point to = at + step;
          if (!picture.contains(to) || disparity(at) == kInvalidDisparity || disparity(to) == kInvalidDisparity) continue;
          if (std::abs(disparity(at) - disparity(to)) > similarity_px || number(to) >= number(at)) continue;
          number(at) = number(to);
          changed = true;
        }
      }
    }
  }
  cv::Mat1f result = disparity.clone();
  for (int v = 0; v < disparity.rows; ++v) {
    for (int u = 0; u < disparity.cols; ++u) {
      if (cv::countNonZero(number == number(v, u)) < min_size_px) result(v, u) = kInvalidDisparity;
    }
  }
  return result;
}

/// find_valid_bits, pixel by pixel.
inline ValidBits find_valid_bits(const std::vector<float>& row, float similarity_px) {
  ValidBits bits{PixelBits((row.size() + 63) / 64, 0), PixelBits((row.size() + 63) / 64, 0)};
  for (std::size_t u = 0; u < row.size(); ++u) {
    if (row[u] == kInvalidDisparity) continue;
    const std::uint64_t bit = std::uint64_t{1} << (u % 64);
    bits.valid[u / 64] |= bit;
    if (u + 1 == row.size() || row[u + 1] == kInvalidDisparity) continue;
    if (std::abs(row[u + 1] - row[u]) <= similarity_px) bits.joined[u / 64] |= bit;
  }
  return bits;
}

/// algorithms.md A.7.2 along one line: runs of invalid pixels between two valid ones.
inline std::vector<float> fill_gaps(std::vector<float> line, int max_width, bool across_steps) {
  const auto most = static_cast<std::size_t>(max_width);
  std::optional<std::size_t> last_valid;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const float after = line[i];
    if (after == kInvalidDisparity) continue;
    const std::size_t width = last_valid ? i - *last_valid - 1 : 0;
    if (width > 0 && width <= most) {
      const float before = line[*last_valid];
      const bool one_surface = std::abs(before - after) < 3.0F;
      for (std::size_t k = 1; k <= width; ++k) {
        float& gap = line[*last_valid + k];
        if (one_surface) gap = before + (after - before) / static_cast<float>(width + 1) * static_cast<float>(k);
        if (!one_surface && across_steps) gap = std::min(before, after);
      }
    }
    last_valid = i;
  }
  return line;
}

/// algorithms.md A.7.4 along one line, as it is meant.
inline std::vector<float> adaptive_mean(const std::vector<float>& line) {
  std::vector<float> result = line;
  const int size = static_cast<int>(line.size());
  for (int i = 0; i < size; ++i) {
    const float center = line[static_cast<std::size_t>(i)];
    if (center == kInvalidDisparity) continue;
    float sum = 0.0F;
    float weights = 0.0F;
    for (int k = i - 3; k <= i + 3; ++k) {
      if (k < 0 || k >= size || line[static_cast<std::size_t>(k)] == kInvalidDisparity) continue;
      const float value = line[static_cast<std::size_t>(k)];
      const float weight = std::max(0.0F, 4.0F - std::abs(value - center));
      sum += weight * value;
      weights += weight;
    }
    result[static_cast<std::size_t>(i)] = sum / weights;
  }
  return result;
}

}  // namespace brink::reference
