#include "overlay/marks.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "overlay/writing.hpp"

namespace brink {

std::string label_of(const NegativeObstacle& obstacle) {
  std::string distance = fmt::format("{:.1f} m", obstacle.candidate.distance_m);
  if (obstacle.track_length <= 1) return distance;
  return fmt::format("{}  #{} age {}", distance, obstacle.id, obstacle.track_length);
}

cv::Point Labels::place(cv::Point corner, const cv::Size& size) {
  const auto covered = [&](const cv::Rect& other) { return (cv::Rect(corner, size) & other).area() > 0; };
  for (auto other = taken_.begin(); other != taken_.end();) {
    other = std::find_if(taken_.begin(), taken_.end(), covered);
    if (other != taken_.end()) corner.y = other->br().y;
  }
  taken_.emplace_back(corner, size);
  return corner;
}

std::string describe_ground(const Detection& detection) {
  if (detection.status != FrameStatus::ok) return to_string(detection.status) + ": " + detection.reason;
  const GroundEstimate& ground = detection.ground;
  std::string text = "ground " + to_string(ground.state);
  std::replace(text.begin(), text.end(), '_', ' ');
  if (ground.plane) text += fmt::format(" {:.2f} m, {:.1f} deg", ground.pose.height_m, ground.pose.pitch_deg);
  if (!ground.reason.empty()) text += ": " + ground.reason;
  return text;
}

void write_fitting(cv::Mat3b& picture, const std::string& text, cv::Point corner, double scale, int line,
                   const cv::Scalar& color) {
  const double room = picture.cols - corner.x - 4.0 * line;
  const double fitting = scale * room / std::max(1, text_size(text, scale, line).width);
  write(picture, text, corner, std::min(scale, fitting), line, color);
}

void draw_color_scale(cv::Mat3b& picture, const cv::Mat3b& colors, const std::string& lowest, const std::string& highest) {
  constexpr int kSmallest = 80;  // px: below that there is no room for a scale
  if (picture.cols < kSmallest || picture.rows < kSmallest) return;
  const Pen pen(picture);
  const cv::Rect strip(picture.cols - picture.cols / 20, picture.rows / 8, std::max(1, picture.cols / 40),
                       picture.rows * 3 / 4);
  cv::Mat3b upright;
  cv::flip(colors, upright, 0);
  cv::resize(upright, picture(strip), strip.size(), 0.0, 0.0, cv::INTER_NEAREST);
  cv::rectangle(picture, strip, kWhite, 1);
  const int height = text_size(highest, pen.text, pen.line).height;
  write(picture, highest, {picture.cols, strip.y - height - 2 * pen.line}, pen.text, pen.line, kWhite);
  write(picture, lowest, {picture.cols, strip.br().y + 2 * pen.line}, pen.text, pen.line, kWhite);
}

}  // namespace brink
