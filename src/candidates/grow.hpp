#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

namespace brink {

/// What a pixel is after growing.
enum class Growth : std::uint8_t {
  none = 0,
  ring = 1,     ///< beside what has grown
  grown = 255,  ///< where it began, or reached from there
};

/// Grows a mask step by step, each time to the eight neighbours that are passable.
/// @param start 255 = where it begins, passable or not. @param passable 255 = may be grown through; of the same size.
/// @return a Growth for each pixel.
cv::Mat1b grow(const cv::Mat1b& start, const cv::Mat1b& passable, int steps);

}  // namespace brink
