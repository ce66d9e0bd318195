#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "brink/ground.hpp"
#include "ground/elevation_simd.hpp"

namespace brink {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;

}  // namespace

double GroundPose::elevation(const Eigen::Vector3d& point) const { return height_m - down.dot(point); }

double GroundPose::distance(const Eigen::Vector3d& point) const { return (point - down.dot(point) * down).norm(); }

double GroundPose::bearing_deg(const Eigen::Vector3d& point) const {
  return std::atan2(right.dot(point), forward.dot(point)) * kDegPerRad;
}

std::optional<Eigen::Vector3d> GroundPose::intersect(double u, double v, const StereoCamera& camera) const {
  const Eigen::Vector3d ray((u - camera.cx) / camera.focal, (v - camera.cy) / camera.focal, 1.0);
  const double descent = down.dot(ray);
  if (descent <= 0.0) return std::nullopt;
  return ray * (height_m / descent);
}

// With eq. 2 the plane d = a u + b v + c becomes N . X = f * baseline, N = (a f, b f, a cx + b cy + c): N points down and the
// camera stands f * baseline / |N| above it.
GroundPose compute_ground_pose(const GroundPlane& plane, const StereoCamera& camera) {
  const Eigen::Vector3d normal(plane.a * camera.focal, plane.b * camera.focal,
                               plane.a * camera.cx + plane.b * camera.cy + plane.c);
  const double length = normal.norm();
  if (!std::isfinite(length) || length == 0.0) {
    throw std::invalid_argument(
        fmt::format("ground plane = ({}, {}, {}), must be finite and not all zero", plane.a, plane.b, plane.c));
  }
  GroundPose pose;
  pose.height_m = camera.focal * camera.baseline / length;
  pose.down = normal / length;
  pose.pitch_deg = std::asin(std::clamp(pose.down.z(), -1.0, 1.0)) * kDegPerRad;
  pose.roll_deg = std::atan2(pose.down.x(), pose.down.y()) * kDegPerRad;
  // Looking straight down there is no forward; the image's up direction takes its place.
  const bool straight_down = std::abs(pose.down.z()) > 1.0 - 1e-9;
  const Eigen::Vector3d axis = straight_down ? Eigen::Vector3d(0.0, -1.0, 0.0) : Eigen::Vector3d(0.0, 0.0, 1.0);
  pose.forward = (axis - axis.dot(pose.down) * pose.down).normalized();
  pose.right = pose.down.cross(pose.forward);
  return pose;
}

GroundPlane make_ground_plane(double height_m, double pitch_deg, double roll_deg, const StereoCamera& camera) {
  if (!(height_m > 0.0)) throw std::invalid_argument(fmt::format("height_m = {}, must be > 0", height_m));
  const double pitch = pitch_deg / kDegPerRad;
  const double roll = roll_deg / kDegPerRad;
  const Eigen::Vector3d down(std::sin(roll) * std::cos(pitch), std::cos(roll) * std::cos(pitch), std::sin(pitch));
  GroundPose pose;
  pose.height_m = height_m;
  pose.down = down;
  return make_ground_plane(pose, camera);
}

GroundPlane make_ground_plane(const GroundPose& pose, const StereoCamera& camera) {
  if (!(pose.height_m > 0.0)) throw std::invalid_argument(fmt::format("height_m = {}, must be > 0", pose.height_m));
  const double b_over_h = camera.baseline / pose.height_m;
  GroundPlane plane;
  plane.a = pose.down.x() * b_over_h;
  plane.b = pose.down.y() * b_over_h;
  plane.c = pose.down.z() * camera.focal * b_over_h - plane.a * camera.cx - plane.b * camera.cy;
  return plane;
}

// Axes right, down, forward from the foot of the perpendicular: X = axes p + h down, with the same p before and after.
Eigen::Isometry3d compute_ground_motion(const GroundPose& previous, const GroundPose& current) {
  const auto axes = [](const GroundPose& pose) {
    Eigen::Matrix3d columns;
    columns << pose.right, pose.down, pose.forward;
    return columns;
  };
  Eigen::Isometry3d current_from_previous = Eigen::Isometry3d::Identity();
  current_from_previous.linear() = axes(current) * axes(previous).transpose();
  current_from_previous.translation() = (current.height_m - previous.height_m) * current.down;
  return current_from_previous;
}

std::string to_string(GroundState state) {
  switch (state) {
    case GroundState::seen:
      return "seen";
    case GroundState::uncertain:
      return "uncertain";
    case GroundState::not_visible:
      break;
  }
  return "not_visible";
}

// On one viewing ray, height over the ground is h (1 - d_ground / d): both depths follow from eq. 2, and height is linear in
// depth. So no 3D point is needed.
cv::Mat1f compute_elevation(const cv::Mat1f& disparity, const GroundPlane& ground, const StereoCamera& camera) {
  const auto height = static_cast<float>(compute_ground_pose(ground, camera).height_m);
  cv::Mat1f elevation(disparity.size());
  const auto step = static_cast<float>(ground.a);
  tbb::parallel_for(0, disparity.rows, [&](int v) {
    const auto first = static_cast<float>(ground.disparity(0.0, v));
    compute_elevation_row(disparity[v], disparity.cols, height, first, step, elevation[v]);
  });
  return elevation;
}

}  // namespace brink
