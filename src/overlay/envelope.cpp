#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "brink/overlay.hpp"
#include "overlay/marks.hpp"
#include "overlay/writing.hpp"

namespace brink {
namespace {

constexpr int kWidth = 960;  // px
constexpr int kHeight = 560;
const cv::Rect kField(96, 50, 820, 440);
constexpr double kLeast = 0.02;  // m, depth at the top
constexpr double kGreatest = 3.0;
constexpr std::array<double, 8> kDepthLines{0.02, 0.05, 0.10, 0.15, 0.30, 0.60, 1.20, 3.00};
const std::array<cv::Scalar, 2> kColors{kCyan, kYellow};

/// From metres to the diagram.
struct Scale {
  double farthest_m = 1.0;
  [[nodiscard]] int column(double distance_m) const { return kField.x + cvRound(kField.width * distance_m / farthest_m); }
  [[nodiscard]] static int row(double depth_m) {
    return kField.y + cvRound(kField.height * std::log(depth_m / kLeast) / std::log(kGreatest / kLeast));
  }
};

void draw_grid(cv::Mat3b& picture, const Scale& scale, const Pen& pen) {
  const cv::Scalar grid(90, 90, 90);
  for (const double depth : kDepthLines) {
    const int row = Scale::row(depth);
    cv::line(picture, {kField.x, row}, {kField.br().x, row}, grid);
    write(picture, fmt::format("{:.2f} m", depth), {4, row - 8}, pen.text, pen.line, kLightGrey);
  }
  for (int distance = 0; distance <= static_cast<int>(scale.farthest_m); ++distance) {
    const int column = scale.column(distance);
    cv::line(picture, {column, kField.y}, {column, kField.br().y}, grid);
    write(picture, fmt::format("{} m", distance), {column - 14, kField.br().y + 8}, pen.text, pen.line, kLightGrey);
  }
  write(picture, "distance of the rim; below a line: drops that are seen", {kField.x, kHeight - 30}, pen.text, pen.line,
        kWhite);
}

/// The part of a curve between two of its points, with all that lies below it tinted.
void draw_part(cv::Mat3b& picture, const cv::Point& from, const cv::Point& to, const cv::Scalar& color) {
  constexpr double kTint = 0.12;
  cv::Mat3b tinted = picture.clone();
  const std::vector<cv::Point> below{from, {to.x - 1, to.y}, {to.x - 1, kField.br().y}, {from.x, kField.br().y}};
  cv::fillPoly(tinted, std::vector<std::vector<cv::Point>>{below}, color);
  cv::addWeighted(picture, 1.0 - kTint, tinted, kTint, 0.0, picture);
  cv::line(picture, from, to, color, 2, cv::LINE_AA);
}

void draw_curve(cv::Mat3b& picture, const EnvelopeCurve& curve, const Scale& scale, const cv::Scalar& color) {
  std::optional<cv::Point> last;
  for (const EnvelopePoint& point : curve.points) {
    std::optional<cv::Point> place;
    if (point.smallest_depth_m) place = cv::Point(scale.column(point.distance_m), Scale::row(*point.smallest_depth_m));
    if (last && place) draw_part(picture, *last, *place, color);
    if (place) cv::circle(picture, *place, 3, color, cv::FILLED, cv::LINE_AA);
    last = place;
  }
}

}  // namespace

cv::Mat3b draw_envelope(const std::vector<EnvelopeCurve>& curves, const std::string& title) {
  cv::Mat3b picture(kHeight, kWidth, kNothingSeen);
  const Pen pen(picture);
  Scale scale;
  for (const EnvelopeCurve& curve : curves) {
    for (const EnvelopePoint& point : curve.points) scale.farthest_m = std::max(scale.farthest_m, point.distance_m);
  }
  draw_grid(picture, scale, pen);
  write_fitting(picture, title, {kField.x, 14}, pen.text, pen.line, kWhite);
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const cv::Scalar& color = kColors.at(i % kColors.size());
    draw_curve(picture, curves[i], scale, color);
    write(picture, curves[i].name, {kField.x + 16, kField.br().y - 60 + 24 * static_cast<int>(i)}, pen.text, pen.line, color);
  }
  return picture;
}

}  // namespace brink
