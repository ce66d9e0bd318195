#include "overlay/writing.hpp"

#include <algorithm>

#include <opencv2/imgproc.hpp>

namespace brink {

Pen::Pen(const cv::Mat& picture) : text(std::max(0.4, picture.cols / 1400.0)), line(std::max(1, picture.cols / 500)) {}

cv::Size text_size(const std::string& text, double scale, int line) {
  int below = 0;
  cv::Size size = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, scale, line, &below);
  size.height += below;
  return size;
}

void write(cv::Mat3b& picture, const std::string& text, cv::Point corner, double scale, int line, const cv::Scalar& color) {
  const cv::Size size = text_size(text, scale, line);
  const int margin = 2 * line;
  corner.x = std::clamp(corner.x, margin, std::max(margin, picture.cols - size.width - margin));
  corner.y = std::clamp(corner.y, margin, std::max(margin, picture.rows - size.height - margin));
  const cv::Point base(corner.x, corner.y + size.height * 3 / 4);
  cv::putText(picture, text, base, cv::FONT_HERSHEY_SIMPLEX, scale, cv::Scalar(0, 0, 0), line + 2 * std::max(1, line),
              cv::LINE_AA);
  cv::putText(picture, text, base, cv::FONT_HERSHEY_SIMPLEX, scale, color, line, cv::LINE_AA);
}

}  // namespace brink
