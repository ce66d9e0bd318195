#include "tracking/opening.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <opencv2/imgproc.hpp>

namespace brink {
namespace {

constexpr double kNearest = 0.1;  // m ahead of the camera: what is nearer cannot be projected

std::vector<cv::Point2f> seen_from_above(const std::vector<Eigen::Vector3d>& points) {
  std::vector<cv::Point2f> above;
  above.reserve(points.size());
  for (const Eigen::Vector3d& p : points) above.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.z()));
  return above;
}

/// The part of a polygon that lies ahead of the camera.
std::vector<Eigen::Vector3d> cut_off_behind(const std::vector<Eigen::Vector3d>& polygon) {
  std::vector<Eigen::Vector3d> ahead;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector3d& from = polygon[i];
    const Eigen::Vector3d& to = polygon[(i + 1) % polygon.size()];
    if (from.z() >= kNearest) ahead.push_back(from);
    if ((from.z() >= kNearest) == (to.z() >= kNearest)) continue;
    ahead.emplace_back(from + (to - from) * ((kNearest - from.z()) / (to.z() - from.z())));
  }
  return ahead;
}

}  // namespace

std::vector<Eigen::Vector3d> compute_hull(const std::vector<Eigen::Vector3d>& rim) {
  if (rim.size() < 3) return rim;
  std::vector<int> corners;
  cv::convexHull(seen_from_above(rim), corners);
  std::vector<Eigen::Vector3d> hull;
  hull.reserve(corners.size());
  for (const int corner : corners) hull.push_back(rim[static_cast<std::size_t>(corner)]);
  return hull;
}

bool overlap(const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b) {
  if (a.size() < 3 || b.size() < 3) return false;
  const std::vector<cv::Point2f> one = seen_from_above(a);
  const std::vector<cv::Point2f> other = seen_from_above(b);
  std::vector<cv::Point2f> common;
  const double shared = cv::intersectConvexConvex(one, other, common);
  return shared > 0.0 && 2.0 * shared >= std::min(cv::contourArea(one), cv::contourArea(other));
}

std::vector<Eigen::Vector3d> sample_edges(const std::vector<Eigen::Vector3d>& polygon, double spacing_m) {
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector3d edge = polygon[(i + 1) % polygon.size()] - polygon[i];
    const int steps = std::max(1, static_cast<int>(std::ceil(edge.norm() / spacing_m)));
    for (int k = 0; k < steps; ++k) points.emplace_back(polygon[i] + edge * (static_cast<double>(k) / steps));
  }
  return points;
}

bool is_in_view(const Eigen::Vector3d& point, const StereoCamera& camera, const cv::Size& size) {
  if (point.z() < kNearest) return false;
  const Eigen::Vector3d pixel = camera.project(point);
  return pixel.x() >= 0.0 && pixel.y() >= 0.0 && pixel.x() <= size.width - 1 && pixel.y() <= size.height - 1;
}

std::vector<cv::Point> project_opening(const std::vector<Eigen::Vector3d>& hull, const StereoCamera& camera,
                                       const cv::Size& size) {
  std::vector<cv::Point2f> projected;
  for (const Eigen::Vector3d& point : cut_off_behind(hull)) {
    const Eigen::Vector3d pixel = camera.project(point);
    projected.emplace_back(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
  }
  if (projected.size() < 3) return {};
  const auto right = static_cast<float>(size.width - 1);
  const auto bottom = static_cast<float>(size.height - 1);
  const std::vector<cv::Point2f> picture{{0.0F, 0.0F}, {right, 0.0F}, {right, bottom}, {0.0F, bottom}};
  std::vector<cv::Point2f> visible;
  std::vector<cv::Point2f> convex;
  cv::convexHull(projected, convex);
  if (cv::intersectConvexConvex(convex, picture, visible) <= 0.0F) return {};
  std::vector<cv::Point> pixels;
  pixels.reserve(visible.size());
  for (const cv::Point2f& corner : visible) pixels.emplace_back(cvRound(corner.x), cvRound(corner.y));
  return pixels;
}

}  // namespace brink
