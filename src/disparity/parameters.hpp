#pragma once

#include <stdexcept>
#include <string_view>

#include <fmt/format.h>
#include <opencv2/core.hpp>

namespace brink {

/// @throws std::invalid_argument "name = value, must be expected" unless valid.
template <typename Value>
void require_parameter(bool valid, std::string_view name, const Value& value, std::string_view expected) {
  if (!valid) throw std::invalid_argument(fmt::format("{} = {}, must be {}", name, value, expected));
}

/// @throws std::invalid_argument "name = value, must be least to most" unless it is.
template <typename Value>
void require_between(std::string_view name, Value value, Value least, Value most) {
  require_parameter(value >= least && value <= most, name, value, fmt::format("{} to {}", least, most));
}

/// OpenCV's 16-bit fixed-point disparities end here, px.
inline constexpr int kLargestDisparity = 2047;

/// @throws std::invalid_argument unless the two pictures of a pair have one size.
inline void require_equal_sizes(const cv::Mat1b& left, const cv::Mat1b& right) {
  if (left.size() == right.size()) return;
  throw std::invalid_argument(
      fmt::format("pictures differ in size: left {}x{}, right {}x{} px", left.cols, left.rows, right.cols, right.rows));
}

}  // namespace brink
