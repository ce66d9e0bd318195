#pragma once

#include <opencv2/core.hpp>

namespace brink {

/// So many pixels behind a row can be read and written, for vectors that reach beyond its end.
inline constexpr int kRowPadding = 64;

/// An image of this size that does, with arbitrary pixels. @param memory an earlier one, whose memory is used again.
template <typename Pixel>
cv::Mat_<Pixel> make_padded_rows(cv::Size size, cv::Mat_<Pixel> memory) {
  if (!memory.empty()) memory.adjustROI(0, 0, 0, kRowPadding);
  memory.create(size.height, size.width + kRowPadding);
  return memory.colRange(0, size.width);
}

}  // namespace brink
