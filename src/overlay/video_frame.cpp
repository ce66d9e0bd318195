#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "brink/overlay.hpp"
#include "overlay/marks.hpp"
#include "overlay/writing.hpp"

namespace brink {
namespace {

// Where everything stands.
const cv::Rect kLeftPanel(0, 0, 960, 540);
const cv::Rect kWordsPanel(0, 540, 960, 180);
const cv::Rect kDisparityPanel(960, 0, 320, 180);
const cv::Rect kElevationPanel(1280, 0, 320, 180);
const cv::Rect kTopPanel(960, 180, 640, 540);

constexpr double kTextScale = 0.6;
constexpr double kCaptionScale = 0.45;

// The greatest size of the same proportions that fits.
cv::Size fitting_size(const cv::Size& size, const cv::Rect& panel) {
  const double scale = std::min(panel.width / static_cast<double>(size.width), panel.height / static_cast<double>(size.height));
  return {std::max(1, cvRound(scale * size.width)), std::max(1, cvRound(scale * size.height))};
}

template <typename Pixels>
Pixels resized_to(const Pixels& image, const cv::Rect& panel, int interpolation) {
  Pixels resized;
  if (!image.empty()) cv::resize(image, resized, fitting_size(image.size(), panel), 0.0, 0.0, interpolation);
  return resized;
}

void put_into(cv::Mat3b& canvas, const cv::Rect& panel, const cv::Mat3b& picture) {
  if (picture.empty()) return;
  const cv::Point margin((panel.width - picture.cols) / 2, (panel.height - picture.rows) / 2);
  picture.copyTo(canvas(cv::Rect(panel.tl() + margin, picture.size())));
}

std::vector<NegativeObstacle> scaled(std::vector<NegativeObstacle> obstacles, double across, double down) {
  for (NegativeObstacle& obstacle : obstacles) {
    for (cv::Point& point : obstacle.candidate.contour) point = {cvRound(point.x * across), cvRound(point.y * down)};
  }
  return obstacles;
}

// Drawn at the size of the panel, not resized afterwards: text and lines stay sharp for any picture.
cv::Mat3b draw_left(const Frame& frame, const Detection& detection) {
  Frame small;
  small.left = resized_to(frame.left, kLeftPanel, cv::INTER_AREA);
  small.left_color = resized_to(frame.left_color, kLeftPanel, cv::INTER_AREA);
  if (frame.left.empty()) small.disparity = resized_to(frame.disparity, kLeftPanel, cv::INTER_NEAREST);
  if (frame.size().empty()) small.left = cv::Mat1b(kLeftPanel.size(), uchar{0});
  Detection told;
  told.status = detection.status;
  told.reason = detection.reason;
  told.ground = detection.ground;
  const double across = small.size().width / std::max(1.0, static_cast<double>(frame.size().width));
  const double down = small.size().height / std::max(1.0, static_cast<double>(frame.size().height));
  told.obstacles = scaled(detection.obstacles, across, down);
  told.tracks = scaled(detection.tracks, across, down);
  return draw_obstacles(small, told);
}

// What a walker would ask first, and its colour.
std::pair<std::string, cv::Scalar> headline_of(const Detection& detection) {
  if (detection.status != FrameStatus::ok) return {"cannot tell: no usable picture", kYellow};
  if (!detection.ground.plane) return {"cannot tell: ground not visible", kYellow};
  if (detection.obstacles.empty()) return {"no drop reported", kWhite};
  const auto nearest = std::min_element(
      detection.obstacles.begin(), detection.obstacles.end(),
      [](const auto& one, const auto& other) { return one.candidate.distance_m < other.candidate.distance_m; });
  const double bearing = nearest->candidate.bearing_deg;
  constexpr double kStraight = 5.0;  // degrees
  const std::string where = std::abs(bearing) < kStraight
                                ? "ahead"
                                : fmt::format("{:.0f} deg to the {}", std::abs(bearing), bearing < 0 ? "left" : "right");
  return {fmt::format("drop in {:.1f} m, {}", nearest->candidate.distance_m, where), cv::Scalar(80, 80, 255)};
}

void draw_legend(cv::Mat3b& canvas, cv::Point corner) {
  struct Entry {
    const char* text;
    cv::Scalar color;
    bool filled;
  };
  static const std::array<Entry, 6> entries{{{"drop, reported", kRed, true},
                                             {"seen, not reported", kBlue, false},
                                             {"ground", cv::Scalar(kGroundSeen), true},
                                             {"below ground", cv::Scalar(kBelowSeen), true},
                                             {"not seen", kGrey, false},
                                             {"camera and path", kYellow, true}}};
  constexpr int kSide = 16;  // px
  for (const Entry& entry : entries) {
    cv::rectangle(canvas, {corner.x, corner.y, kSide, kSide}, entry.color, entry.filled ? cv::FILLED : 1);
    write(canvas, entry.text, corner + cv::Point(kSide + 6, -1), 0.5, 1, kLightGrey);
    corner.x += kSide + 6 + text_size(entry.text, 0.5, 1).width + 20;
  }
}

void draw_words(cv::Mat3b panel, const Detection& detection, const std::string& ego_motion) {
  constexpr int kIndent = 16;  // px
  const auto [headline, color] = headline_of(detection);
  write(panel, headline, {kIndent, 14}, 1.3, 2, color);
  const std::string words = fmt::format("frame {}   {:.2f} s   {}", detection.frame, detection.time, ego_motion);
  write_fitting(panel, words, {kIndent, 78}, kTextScale, 1, kWhite);
  draw_legend(panel, {kIndent, 136});
}

void write_caption(cv::Mat3b& canvas, const cv::Rect& panel, const std::string& text) {
  write(canvas, text, panel.tl() + cv::Point(6, 4), kCaptionScale, 1, kWhite);
}

}  // namespace

cv::Mat3b draw_video_frame(const Frame& frame, const Detection& detection, const std::vector<Eigen::Vector3d>& path,
                           const std::string& ego_motion, const CandidateParams& params) {
  cv::Mat3b canvas(kVideoHeight, kVideoWidth, cv::Vec3b(0, 0, 0));
  put_into(canvas, kLeftPanel, draw_left(frame, detection));
  put_into(canvas, kDisparityPanel, draw_disparity(resized_to(detection.disparity, kDisparityPanel, cv::INTER_NEAREST)));
  put_into(canvas, kElevationPanel, draw_elevation(resized_to(detection.elevation, kElevationPanel, cv::INTER_NEAREST)));
  put_into(canvas, kTopPanel, draw_top_view(frame, detection, path, kTopPanel.size(), params));
  write_caption(canvas, kDisparityPanel, detection.disparity.empty() ? "disparity: none" : "disparity");
  write_caption(canvas, kElevationPanel, detection.elevation.empty() ? "height over ground: not known" : "height over ground");
  write_caption(canvas, kTopPanel, "from above");
  draw_words(canvas(kWordsPanel), detection, ego_motion);
  for (const cv::Rect& panel : {kDisparityPanel, kElevationPanel, kTopPanel}) cv::rectangle(canvas, panel, kGrey * 0.5, 1);
  return canvas;
}

}  // namespace brink
