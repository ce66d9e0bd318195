#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "brink/truth.hpp"
#include "io/rim_plane.hpp"

namespace brink {
namespace {

/// What one camera sees of one frame.
struct View {
  const StereoCamera& camera;
  const cv::Size& size;
  const cv::Mat1f& disparity;  // truth, px, 0 = none; may be empty
};

/// A point is hidden when all that is seen around its pixel stands clearly in front of it: a post, a handrail, a person.
bool is_visible(const Eigen::Vector3d& point, const View& view) {
  constexpr double kNearest = 0.05;            // m along the optical axis
  constexpr double kTolerance = 0.05;          // m that what is seen may be nearer
  constexpr double kRelativeTolerance = 0.02;  // ... or this share of the distance
  if (!(point.z() > kNearest)) return false;
  const Eigen::Vector3d pixel = view.camera.project(point);
  const double column = std::round(pixel.x());
  const double row = std::round(pixel.y());
  if (!(column >= 0.0 && column < view.size.width && row >= 0.0 && row < view.size.height)) return false;
  if (view.disparity.empty()) return true;
  const double nearest_allowed = point.z() - std::max(kTolerance, kRelativeTolerance * point.z());
  const double focal_baseline = view.camera.focal * view.camera.baseline;
  const cv::Rect around(static_cast<int>(column) - 1, static_cast<int>(row) - 1, 3, 3);
  const cv::Mat1f window = view.disparity(around & cv::Rect({0, 0}, view.size));
  // Depth f B / d >= nearest_allowed; where there is no disparity nothing stands in front.
  return std::ranges::any_of(cv::Mat1f(window.clone()), [&](float d) { return d * nearest_allowed <= focal_baseline; });
}

GroundPose require_rim_plane(const std::vector<Eigen::Vector3d>& opening) {
  const std::optional<GroundPose> pose = fit_rim_plane(opening);
  if (!pose) throw std::invalid_argument(fmt::format("opening of {} points has no plane", opening.size()));
  return *pose;
}

/// A point laid onto the plane: metres to the right and ahead of the foot of the camera's perpendicular.
Eigen::Vector2d in_plane(const Eigen::Vector3d& point, const GroundPose& pose) {
  return {pose.right.dot(point), pose.forward.dot(point)};
}

/// Point of the segment that is nearest to the foot of the camera's perpendicular.
Eigen::Vector3d find_closest(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const GroundPose& pose) {
  const Eigen::Vector2d start = in_plane(a, pose);
  const Eigen::Vector2d along = in_plane(b, pose) - start;
  const double length = along.squaredNorm();
  return a + (b - a) * (length > 0.0 ? std::clamp(-start.dot(along) / length, 0.0, 1.0) : 0.0);
}

/// Walks from `start` to `end`, which leads away from the camera, to the first point that is seen.
/// @param limit m: beyond this distance nothing is looked for.
std::optional<Eigen::Vector3d> find_first_visible(const Eigen::Vector3d& start, const Eigen::Vector3d& end,
                                                  const GroundPose& pose, const View& view, double limit) {
  constexpr double kSmallestStep = 0.002;  // m
  constexpr double kRelativeStep = 0.003;  // of the distance: 1 cm at 3 m, and few steps however long the rim is
  const double length = (end - start).norm();
  for (double at = 0.0; true;) {
    const Eigen::Vector3d point = at < length ? Eigen::Vector3d(start + (end - start) * (at / length)) : end;
    const double distance = pose.distance(point);
    if (!(distance < limit)) return std::nullopt;
    if (is_visible(point, view)) return point;
    if (!(at < length)) return std::nullopt;
    at += std::max(kSmallestStep, kRelativeStep * distance);
  }
}

}  // namespace

std::optional<GroundPose> fit_rim_plane(const std::vector<Eigen::Vector3d>& opening) {
  if (opening.size() < 3) return std::nullopt;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : opening) centre += point / static_cast<double>(opening.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& point : opening) scatter += (point - centre) * (point - centre).transpose();
  if (!scatter.allFinite()) return std::nullopt;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(scatter);  // eigenvalues ascend
  constexpr double kFlattest = 1e-10;                                  // squared: a rim 1 m long is wider than 0.01 mm
  if (!(axes.eigenvalues()[1] > kFlattest * axes.eigenvalues()[2])) return std::nullopt;
  GroundPose pose;
  pose.down = axes.eigenvectors().col(0);
  if (pose.down.dot(centre) < 0.0) pose.down = -pose.down;
  pose.height_m = pose.down.dot(centre);
  // Looking straight down there is no forward; the picture's up direction takes its place, as in compute_ground_pose.
  const bool straight_down = std::abs(pose.down.z()) > 1.0 - 1e-9;
  const Eigen::Vector3d axis = straight_down ? Eigen::Vector3d(-Eigen::Vector3d::UnitY()) : Eigen::Vector3d::UnitZ();
  pose.forward = (axis - axis.dot(pose.down) * pose.down).normalized();
  pose.right = pose.down.cross(pose.forward);
  return pose;
}

RimSighting find_nearest_rim(const std::vector<Eigen::Vector3d>& opening, const StereoCamera& camera, const cv::Size& size,
                             const cv::Mat1f& disparity) {
  const GroundPose pose = require_rim_plane(opening);
  if (!disparity.empty() && disparity.size() != size) {
    throw std::invalid_argument(
        fmt::format("disparity is {}x{} px, must be {}x{}", disparity.cols, disparity.rows, size.width, size.height));
  }
  const View view{camera, size, disparity};
  constexpr double kFar = std::numeric_limits<double>::infinity();
  RimSighting nearest{kFar, 0.0, false};
  RimSighting nearest_visible{kFar, 0.0, true};
  for (std::size_t i = 0; i < opening.size(); ++i) {
    const Eigen::Vector3d& a = opening[i];
    const Eigen::Vector3d& b = opening[(i + 1) % opening.size()];
    const Eigen::Vector3d closest = find_closest(a, b, pose);
    if (pose.distance(closest) < nearest.distance_m) nearest = {pose.distance(closest), pose.bearing_deg(closest), false};
    // From there the distance grows to both sides, so the first point that is seen is the nearest of its side.
    for (const Eigen::Vector3d& end : {a, b}) {
      const auto seen = find_first_visible(closest, end, pose, view, nearest_visible.distance_m);
      if (seen) nearest_visible = {pose.distance(*seen), pose.bearing_deg(*seen), true};
    }
  }
  return std::isfinite(nearest_visible.distance_m) ? nearest_visible : nearest;
}

RimPlace locate_rim(const std::vector<Eigen::Vector3d>& opening) {
  const GroundPose pose = require_rim_plane(opening);
  RimPlace place;
  place.distance_m = std::numeric_limits<double>::infinity();
  std::vector<cv::Point2f> polygon;
  for (std::size_t i = 0; i < opening.size(); ++i) {
    const Eigen::Vector3d closest = find_closest(opening[i], opening[(i + 1) % opening.size()], pose);
    const double distance = pose.distance(closest);
    if (distance < place.distance_m) {
      place.distance_m = distance;
      place.bearing_deg = pose.bearing_deg(closest);
    }
    polygon.emplace_back(in_plane(opening[i], pose).cast<float>().x(), in_plane(opening[i], pose).cast<float>().y());
  }
  place.is_inside = cv::pointPolygonTest(polygon, {0.0F, 0.0F}, false) > 0.0;
  // `down` points from the camera to the plane: upwards when the camera is below it.
  place.height_m = std::copysign(pose.height_m, pose.down.y());
  return place;
}

}  // namespace brink
