#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "brink/overlay.hpp"
#include "overlay/marks.hpp"
#include "overlay/writing.hpp"

namespace brink {
namespace {

constexpr double kAhead = 5.7;      // m from the camera to the upper edge: the ring at 5 m and the text over it
constexpr double kBehind = 1.5;     // m to the lower edge: the path
constexpr double kFarthest = 50.0;  // m: rays near the horizon meet the ground farther away than can be drawn

const cv::Scalar kRing(110, 110, 110);

using Polygon = std::vector<cv::Point>;

// Between the ground plane and the picture: forward is up, the foot of the camera near the bottom.
class Map {
 public:
  Map(GroundPose pose, const cv::Size& size)
      : pose_(std::move(pose)),
        pixels_per_m_(size.height / (kAhead + kBehind)),
        foot_(size.width / 2.0, kAhead * pixels_per_m_) {}

  [[nodiscard]] double pixels_per_m() const { return pixels_per_m_; }
  [[nodiscard]] cv::Point place(double right, double forward) const {
    return {cvRound(foot_.x + right * pixels_per_m_), cvRound(foot_.y - forward * pixels_per_m_)};
  }
  [[nodiscard]] cv::Point place(const Eigen::Vector3d& point) const {
    return place(point.dot(pose_.right), point.dot(pose_.forward));
  }
  // The point of the ground under a pixel of the map, left camera frame.
  [[nodiscard]] Eigen::Vector3d ground_at(int column, int row) const {
    const double right = (column - foot_.x) / pixels_per_m_;
    const double forward = (foot_.y - row) / pixels_per_m_;
    return pose_.height_m * pose_.down + right * pose_.right + forward * pose_.forward;
  }
  // Where the ray through a pixel of the left picture meets the ground.
  [[nodiscard]] std::optional<cv::Point> place_pixel(double u, double v, const StereoCamera& camera) const {
    const auto point = pose_.intersect(u, v, camera);
    if (!point || pose_.distance(*point) > kFarthest) return std::nullopt;
    return place(*point);
  }

 private:
  GroundPose pose_;
  double pixels_per_m_;
  cv::Point2d foot_;
};

// Each pixel of the map looks through the ground plane at its pixel of the left picture: ground, or what lies below it.
void draw_surface(cv::Mat3b& picture, const Map& map, const Detection& detection, const StereoCamera& camera,
                  const CandidateParams& params) {
  const cv::Rect inside({0, 0}, detection.elevation.size());
  picture.forEach([&](cv::Vec3b& pixel, const int* at) {
    const Eigen::Vector3d point = map.ground_at(at[1], at[0]);
    if (point.z() <= 0.0) return;
    const Eigen::Vector3d projected = camera.project(point);
    const cv::Point seen(cvRound(projected.x()), cvRound(projected.y()));
    if (!inside.contains(seen)) return;
    const double elevation = detection.elevation(seen);  // NaN, where there is none, is neither
    if (elevation <= -params.min_depth_m) {
      pixel = kBelowSeen;
    } else if (std::abs(elevation) < params.ground_tolerance_m) {
      pixel = kGroundSeen;
    }
  });
}

// The border of the left picture, laid onto the ground.
void draw_field_of_view(cv::Mat3b& picture, const Map& map, const cv::Size& left, const StereoCamera& camera) {
  constexpr int kStep = 4;  // px
  Polygon border;
  const double right = left.width - 1.0;
  const double bottom = left.height - 1.0;
  std::optional<cv::Point> last;
  const auto go_to = [&](double u, double v) {
    const auto place = map.place_pixel(u, v, camera);
    if (place && last) cv::line(picture, *last, *place, kLightGrey, 1, cv::LINE_AA);
    last = place;
  };
  for (int v = 0; v < left.height; v += kStep) go_to(0.0, v);
  go_to(0.0, bottom);
  go_to(right, bottom);
  for (int v = left.height - 1; v >= 0; v -= kStep) go_to(right, v);
  go_to(right, 0.0);
  go_to(0.0, 0.0);
}

void draw_rings(cv::Mat3b& picture, const Map& map, const Pen& pen) {
  constexpr double kLabelAngle = 1.0;  // rad from straight ahead to the left, beside most cameras' view
  for (int range = 1; range <= 5; ++range) {
    cv::circle(picture, map.place(0.0, 0.0), cvRound(range * map.pixels_per_m()), kRing, 1, cv::LINE_AA);
    const std::string text = fmt::format("{} m", range);
    const cv::Size size = text_size(text, pen.text, pen.line);
    const cv::Point center = map.place(-range * std::sin(kLabelAngle), range * std::cos(kLabelAngle));
    write(picture, text, center - cv::Point(size.width / 2, size.height / 2), pen.text, pen.line, kLightGrey);
  }
}

Polygon opening_of(const Candidate& candidate, const Map& map, const StereoCamera& camera) {
  Polygon opening;
  for (const cv::Point& pixel : candidate.contour) {
    if (const auto place = map.place_pixel(pixel.x, pixel.y, camera)) opening.push_back(*place);
  }
  return opening;
}

void draw_path(cv::Mat3b& picture, const Map& map, const std::vector<Eigen::Vector3d>& path, int line) {
  Polygon places;
  for (const Eigen::Vector3d& position : path) places.push_back(map.place(position));
  const cv::Point foot = map.place(0.0, 0.0);
  places.push_back(foot);
  cv::polylines(picture, places, false, kYellow, 2 * line, cv::LINE_AA);
  const int half = std::max(3, picture.rows / 60);
  cv::fillConvexPoly(picture, Polygon{foot + cv::Point(0, -half), foot + cv::Point(half, half), foot + cv::Point(-half, half)},
                     kYellow, cv::LINE_AA);
}

void draw_openings(cv::Mat3b& picture, const Map& map, const std::vector<NegativeObstacle>& obstacles,
                   const StereoCamera& camera, bool reported, int line) {
  const cv::Scalar& color = reported ? kRed : kBlue;
  for (const NegativeObstacle& obstacle : obstacles) {
    const Polygon opening = opening_of(obstacle.candidate, map, camera);
    if (opening.empty()) continue;
    if (reported) cv::fillPoly(picture, std::vector<Polygon>{opening}, color * 0.7);
    cv::polylines(picture, opening, true, color, line, cv::LINE_AA);
  }
}

void draw_rims(cv::Mat3b& picture, const Map& map, const std::vector<NegativeObstacle>& obstacles, Labels& labels,
               const cv::Scalar& color, const Pen& pen) {
  for (const NegativeObstacle& obstacle : obstacles) {
    const cv::Point rim = map.place(obstacle.candidate.rim_nearest);
    cv::circle(picture, rim, 2 + 2 * pen.line, color, cv::FILLED, cv::LINE_AA);
    const std::string text = label_of(obstacle);
    const cv::Point corner = labels.place(rim + cv::Point(6 * pen.line, 2 * pen.line), text_size(text, pen.text, pen.line));
    write(picture, text, corner, pen.text, pen.line, color);
  }
}

}  // namespace

cv::Mat3b draw_top_view(const Frame& frame, const Detection& detection, const std::vector<Eigen::Vector3d>& path,
                        const cv::Size& size, const CandidateParams& params) {
  cv::Mat3b picture(size, kNothingSeen);
  const Pen pen(picture);
  const bool has_ground = detection.ground.plane.has_value();
  const Map map(has_ground ? detection.ground.pose : GroundPose{}, size);
  if (has_ground) {
    draw_surface(picture, map, detection, frame.camera, params);
    draw_field_of_view(picture, map, frame.size(), frame.camera);
  }
  draw_rings(picture, map, pen);
  if (!has_ground) return picture;
  draw_path(picture, map, path, pen.line);
  draw_openings(picture, map, detection.obstacles, frame.camera, true, 2 * pen.line);
  draw_openings(picture, map, detection.tracks, frame.camera, false, 1);
  Labels labels;
  draw_rims(picture, map, detection.obstacles, labels, kWhite, pen);
  draw_rims(picture, map, detection.tracks, labels, kBlue, pen);
  return picture;
}

}  // namespace brink
