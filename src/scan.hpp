#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>

#include <opencv2/core.hpp>

namespace brink {

/// The first byte of [begin, end) that is not 0; `end` without one.
inline const uchar* find_set(const uchar* begin, const uchar* end) {
  for (; end - begin >= 8; begin += 8) {
    std::uint64_t eight = 0;
    std::memcpy(&eight, begin, sizeof(eight));
    if (eight != 0) break;
  }
  return std::find_if(begin, end, [](uchar value) { return value != 0; });
}

/// The first byte of [begin, end) with a value; `end` without one.
inline const uchar* find_value(const uchar* begin, const uchar* end, uchar value) {
  const void* const found = begin == end ? nullptr : std::memchr(begin, value, static_cast<std::size_t>(end - begin));
  return found == nullptr ? end : static_cast<const uchar*>(found);
}

/// The smallest box around what is set; empty without any. (cv::boundingRect of 4.6 is a column short where rows begin at odd
/// addresses.)
inline cv::Rect find_box(const cv::Mat1b& mask) {
  int top = mask.rows;
  int bottom = 0;
  int left = mask.cols;
  int right = 0;
  for (int v = 0; v < mask.rows; ++v) {
    const uchar* const row = mask[v];
    const uchar* const end = row + mask.cols;
    const uchar* const first = find_set(row, end);
    if (first == end) continue;
    top = std::min(top, v);
    bottom = v + 1;
    left = std::min(left, static_cast<int>(first - row));
    right = std::max(right, left + 1);
    for (const uchar* set = find_set(row + right, end); set != end; set = find_set(set + 1, end)) {
      right = static_cast<int>(set - row) + 1;
    }
  }
  return right == 0 ? cv::Rect() : cv::Rect(left, top, right - left, bottom - top);
}

}  // namespace brink
