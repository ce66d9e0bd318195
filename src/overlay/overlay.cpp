#include "brink/overlay.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "brink/disparity.hpp"
#include "overlay/marks.hpp"
#include "overlay/writing.hpp"

namespace brink {
namespace {

/// Disparities as grey, near = bright, none = black, where there is no picture to draw on.
cv::Mat1b grey_disparity(const cv::Mat1f& disparity) {
  double largest = 0.0;
  cv::minMaxLoc(disparity, nullptr, &largest);
  cv::Mat1b grey;
  disparity.convertTo(grey, CV_8U, largest > 0.0 ? 255.0 / largest : 0.0);
  return grey;
}

cv::Mat3b left_picture(const Frame& frame) {
  if (!frame.left_color.empty()) return frame.left_color.clone();
  cv::Mat3b picture;
  const cv::Mat1b grey = frame.left.empty() && !frame.disparity.empty() ? grey_disparity(frame.disparity) : frame.left;
  if (!grey.empty()) cv::cvtColor(grey, picture, cv::COLOR_GRAY2BGR);
  return picture;
}

void tint(cv::Vec3b& pixel, const cv::Scalar& color, double share) {
  for (int channel = 0; channel < 3; ++channel) {
    pixel[channel] = cv::saturate_cast<uchar>((1.0 - share) * pixel[channel] + share * color[channel]);
  }
}

void write_ground_state(cv::Mat3b& picture, const Detection& detection) {
  const Pen pen(picture);
  write_fitting(picture, describe_ground(detection), {0, 0}, pen.text, pen.line, kWhite);
}

using Contours = std::vector<std::vector<cv::Point>>;

void outline(cv::Mat3b& picture, const Candidate& candidate, const cv::Scalar& color, int line) {
  if (!candidate.contour.empty()) cv::polylines(picture, Contours{candidate.contour}, true, color, line, cv::LINE_AA);
}

const cv::Scalar& color_of(CandidateType type) { return type == CandidateType::below_ground ? kCyan : kMagenta; }

// 256 colours, far first.
cv::Mat3b disparity_colors() {
  cv::Mat1b levels(256, 1);
  std::iota(levels.begin(), levels.end(), uchar{0});
  cv::Mat3b colors;
  cv::applyColorMap(levels, colors, cv::COLORMAP_TURBO);
  return colors;
}

// Beside the contour, at the right unless there is no room; in the middle of a wide one, whose sides are far away.
void write_beside(cv::Mat3b& picture, Labels& labels, const Candidate& candidate, const std::string& text, double scale,
                  int line, const cv::Scalar& color) {
  if (candidate.contour.empty()) return;
  const cv::Rect box = cv::boundingRect(candidate.contour);
  const cv::Size size = text_size(text, scale, line);
  const bool fits_right = box.br().x + 3 * line + size.width < picture.cols;
  const bool is_wide = box.width > picture.cols / 4 && box.width > 2 * size.width;
  int x = fits_right ? box.br().x + 3 * line : box.x - 3 * line - size.width;
  if (is_wide) x = box.x + box.width / 2 - size.width / 2;
  write(picture, text, labels.place({x, box.y + box.height / 2 - size.height / 2}, size), scale, line, color);
}

// The disparities that 1 % of the valid pixels lie below and above: single wild ones do not use up the colours.
std::pair<float, float> robust_range(const cv::Mat1f& disparity) {
  std::vector<float> values;
  values.reserve(disparity.total());
  std::copy_if(disparity.begin(), disparity.end(), std::back_inserter(values), [](float value) { return value >= 0.0F; });
  if (values.empty()) return {0.0F, 1.0F};
  const auto tail = static_cast<std::ptrdiff_t>(values.size() / 100);
  std::nth_element(values.begin(), values.begin() + tail, values.end());
  const float smallest = values[static_cast<std::size_t>(tail)];
  std::nth_element(values.begin(), values.end() - 1 - tail, values.end());
  const float greatest = *(values.end() - 1 - tail);
  return {smallest, std::max(greatest, smallest + 1.0F)};
}

}  // namespace

cv::Mat3b draw_ground(const Frame& frame, const Detection& detection, const CandidateParams& params) {
  cv::Mat3b picture = left_picture(frame);
  if (picture.empty()) return picture;
  constexpr double kShare = 0.45;
  for (int v = 0; v < detection.elevation.rows; ++v) {
    for (int u = 0; u < detection.elevation.cols; ++u) {
      const double elevation = detection.elevation(v, u);  // NaN, where there is none, is neither
      if (elevation <= -params.min_depth_m) {
        tint(picture(v, u), kRed, kShare);
      } else if (std::abs(elevation) < params.ground_tolerance_m) {
        tint(picture(v, u), kGreen, kShare);
      }
    }
  }
  write_ground_state(picture, detection);
  return picture;
}

cv::Mat3b draw_disparity(const cv::Mat1f& disparity) {
  cv::Mat3b picture;
  if (disparity.empty()) return picture;
  const auto [smallest, greatest] = robust_range(disparity);
  const double scale = 255.0 / (greatest - smallest);
  cv::Mat1b levels;
  disparity.convertTo(levels, CV_8U, scale, -scale * smallest);
  cv::applyColorMap(levels, picture, cv::COLORMAP_TURBO);
  picture.setTo(kBlack, disparity < 0.0F);
  draw_color_scale(picture, disparity_colors(), fmt::format("{:.0f} px", smallest), fmt::format("{:.0f} px", greatest));
  return picture;
}

cv::Mat3b draw_candidates(const Frame& frame, const Detection& detection) {
  cv::Mat3b picture = left_picture(frame);
  if (picture.empty()) return picture;
  const Pen pen(picture);
  for (const Candidate& candidate : detection.rejected) {
    outline(picture, candidate, kGrey, 1);
    if (!candidate.rejection || candidate.contour.empty()) continue;
    const cv::Rect box = cv::boundingRect(candidate.contour);
    write(picture, candidate.rejection->rule, box.tl() + cv::Point(box.width + 2, 0), 0.7 * pen.text, 1, kLightGrey);
  }
  for (const Candidate& candidate : detection.candidates) outline(picture, candidate, color_of(candidate.type), pen.line);
  return picture;
}

cv::Mat3b draw_obstacles(const Frame& frame, const Detection& detection) {
  cv::Mat3b picture = left_picture(frame);
  if (picture.empty()) return picture;
  const Pen pen(picture);
  cv::Mat1b filled(picture.size(), uchar{0});
  for (const NegativeObstacle& obstacle : detection.obstacles) {
    if (!obstacle.candidate.contour.empty()) cv::fillPoly(filled, Contours{obstacle.candidate.contour}, cv::Scalar(255));
  }
  picture.forEach([&filled](cv::Vec3b& pixel, const int* at) {
    if (filled(at[0], at[1]) != 0) tint(pixel, kRed, 0.4);
  });
  for (const NegativeObstacle& track : detection.tracks) outline(picture, track.candidate, kBlue, 1);
  for (const NegativeObstacle& obstacle : detection.obstacles) outline(picture, obstacle.candidate, kRed, pen.line);
  Labels labels;
  for (const NegativeObstacle& obstacle : detection.obstacles) {
    write_beside(picture, labels, obstacle.candidate, label_of(obstacle), pen.text, pen.line, kWhite);
  }
  for (const NegativeObstacle& track : detection.tracks) {
    write_beside(picture, labels, track.candidate, label_of(track), 0.7 * pen.text, 1, kBlue);
  }
  write_ground_state(picture, detection);
  return picture;
}

}  // namespace brink
