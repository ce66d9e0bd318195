#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "brink/ground.hpp"
#include "candidates/region.hpp"

namespace brink::reference {

/// compute_rim_slope_deg, with the nearest level pixel of every pixel as far around as one counts.
inline double naive_rim_slope_deg(const Region& region, const cv::Mat1b& deep, const cv::Mat1b& level,
                                  const cv::Mat1f& disparity, const StereoCamera& camera, const GroundPose& pose) {
  const int margin = 20 + std::max(region.box.width, region.box.height) / 2;
  const cv::Rect around =
      cv::Rect(region.box.x - margin, region.box.y - margin, region.box.width + 2 * margin, region.box.height + 2 * margin) &
      cv::Rect(cv::Point(0, 0), deep.size());
  cv::Mat1b level_near = level(around).clone();
  const std::vector<std::vector<cv::Point>> outline{trace_contour(region.mask, region.box)};
  cv::drawContours(level_near, outline, -1, cv::Scalar(0), cv::FILLED, cv::LINE_8, cv::noArray(), 0, -around.tl());
  if (cv::countNonZero(level_near) == 0) return 0.0;
  cv::Mat1b deep_here(around.size(), uchar{0});
  const cv::Rect in_picture = region.box & around;
  cv::bitwise_and(deep(in_picture), region.mask(in_picture - region.box.tl()), deep_here(in_picture - around.tl()));
  cv::Mat1b inner;
  cv::erode(deep_here, inner, cv::Mat());
  cv::Mat1f distance;
  cv::Mat1i labels;
  cv::distanceTransform(level_near == 0, distance, labels, cv::DIST_L2, cv::DIST_MASK_5, cv::DIST_LABEL_PIXEL);
  std::vector<cv::Point> places(static_cast<std::size_t>(cv::countNonZero(level_near)) + 1);
  for (int v = 0; v < around.height; ++v) {
    for (int u = 0; u < around.width; ++u) {
      if (level_near(v, u) != 0) places[static_cast<std::size_t>(labels(v, u))] = {u, v};
    }
  }
  const auto triangulate = [&](const cv::Point& p) {
    const cv::Point place = p + around.tl();
    return camera.triangulate(place.x, place.y, disparity(place));
  };
  std::vector<double> slopes;
  for (int v = 0; v < around.height; ++v) {
    for (int u = 0; u < around.width; ++u) {
      if (deep_here(v, u) == 0 || inner(v, u) != 0) continue;
      const Eigen::Vector3d high = triangulate(places[static_cast<std::size_t>(labels(v, u))]);
      const Eigen::Vector3d low = triangulate({u, v});
      const Eigen::Vector3d step = low - high;
      const double gone = (step - pose.down.dot(step) * pose.down).norm();
      slopes.push_back(std::max(0.0, std::atan2(pose.elevation(high) - pose.elevation(low), gone) * 180.0 / std::numbers::pi));
    }
  }
  if (slopes.empty()) return 0.0;
  std::ranges::sort(slopes);
  return slopes[static_cast<std::size_t>(0.75 * static_cast<double>(slopes.size() - 1))];
}

}  // namespace brink::reference
