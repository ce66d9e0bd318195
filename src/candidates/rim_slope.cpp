#include "candidates/rim_slope.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace brink {
namespace {

constexpr int kMarginPx = 20;  // how far around the region level ground is looked for, at least
constexpr double kSteepQuantile = 0.75;

/// The place of the level pixel nearest to every pixel of a cut-out, by label.
struct NearestLevel {
  cv::Mat1i labels;
  std::vector<cv::Point> places;
};

NearestLevel find_nearest_level(const cv::Mat1b& level) {
  NearestLevel nearest;
  const cv::Mat1b other(level == 0);
  cv::Mat1f distance;
  cv::distanceTransform(other, distance, nearest.labels, cv::DIST_L2, cv::DIST_MASK_5, cv::DIST_LABEL_PIXEL);
  nearest.places.resize(static_cast<std::size_t>(cv::countNonZero(level)) + 1);
  for (int v = 0; v < level.rows; ++v) {
    for (int u = 0; u < level.cols; ++u) {
      if (level(v, u) != 0) nearest.places[static_cast<std::size_t>(nearest.labels(v, u))] = {u, v};
    }
  }
  return nearest;
}

double slope_deg(const Eigen::Vector3d& high, const Eigen::Vector3d& low, const GroundPose& pose) {
  const double drop = pose.elevation(high) - pose.elevation(low);
  const Eigen::Vector3d step = low - high;
  const double gone = (step - pose.down.dot(step) * pose.down).norm();
  return std::max(0.0, std::atan2(drop, gone) * 180.0 / std::numbers::pi);
}

}  // namespace

double compute_rim_slope_deg(const Region& region, const cv::Mat1b& deep, const cv::Mat1b& level, const cv::Mat1f& disparity,
                             const StereoCamera& camera, const GroundPose& pose) {
  const int margin = kMarginPx + std::max(region.box.width, region.box.height) / 2;
  const cv::Rect around =
      cv::Rect(region.box.x - margin, region.box.y - margin, region.box.width + 2 * margin, region.box.height + 2 * margin) &
      cv::Rect(cv::Point(0, 0), deep.size());
  // Level specks inside the region are noise; its surroundings begin beyond the outer contour.
  cv::Mat1b level_near = level(around).clone();
  const std::vector<std::vector<cv::Point>> outline{trace_contour(region.mask, region.box)};
  cv::drawContours(level_near, outline, -1, cv::Scalar(0), cv::FILLED, cv::LINE_8, cv::noArray(), 0, -around.tl());
  if (cv::countNonZero(level_near) == 0) return 0.0;

  cv::Mat1b deep_here(around.size(), uchar{0});
  const cv::Rect in_picture = region.box & around;
  cv::bitwise_and(deep(in_picture), region.mask(in_picture - region.box.tl()), deep_here(in_picture - around.tl()));
  cv::Mat1b inner;
  cv::erode(deep_here, inner, cv::Mat());

  const NearestLevel nearest = find_nearest_level(level_near);
  const auto triangulate = [&](const cv::Point& p) {
    const cv::Point place = p + around.tl();
    return camera.triangulate(place.x, place.y, disparity(place));
  };
  std::vector<double> slopes;
  for (int v = 0; v < around.height; ++v) {
    for (int u = 0; u < around.width; ++u) {
      if (deep_here(v, u) == 0 || inner(v, u) != 0) continue;
      const cv::Point& place = nearest.places[static_cast<std::size_t>(nearest.labels(v, u))];
      slopes.push_back(slope_deg(triangulate(place), triangulate({u, v}), pose));
    }
  }
  if (slopes.empty()) return 0.0;
  const auto steep = slopes.begin() + static_cast<std::ptrdiff_t>(kSteepQuantile * static_cast<double>(slopes.size() - 1));
  std::ranges::nth_element(slopes, steep);
  return *steep;
}

}  // namespace brink
