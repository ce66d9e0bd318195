#pragma once

#include <string>

#include <opencv2/core.hpp>

namespace brink {

/// Sizes of text and lines grow with the picture, so that it reads the same in a paper or on a phone.
struct Pen {
  double text = 0.0;  ///< font scale
  int line = 1;       ///< px
  explicit Pen(const cv::Mat& picture);
};

/// Size of a line of text, with what goes below the base line, px.
cv::Size text_size(const std::string& text, double scale, int line);

/// Text with a dark outline, its top left corner near `corner`, moved as far as needed to stay inside the picture.
void write(cv::Mat3b& picture, const std::string& text, cv::Point corner, double scale, int line, const cv::Scalar& color);

}  // namespace brink
