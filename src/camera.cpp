#include "brink/camera.hpp"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace brink {
namespace {

void require(bool valid, const char* name, double value, const char* expected) {
  if (!valid) throw std::invalid_argument(fmt::format("camera {} = {}, must be {}", name, value, expected));
}

}  // namespace

void StereoCamera::validate() const {
  constexpr double kLargest = 1e6;
  require(focal >= 1.0 && focal <= kLargest, "focal", focal, "1 to 1e6 px");
  require(std::abs(cx) <= kLargest, "cx", cx, "-1e6 to 1e6 px");
  require(std::abs(cy) <= kLargest, "cy", cy, "-1e6 to 1e6 px");
  require(baseline >= 0.001 && baseline <= 10.0, "baseline", baseline, "0.001 to 10 m");
}

Eigen::Vector3d StereoCamera::triangulate(double u, double v, double disparity) const {
  const double z = focal * baseline / disparity;  // eq. 2
  return {(u - cx) * z / focal, (v - cy) * z / focal, z};
}

Eigen::Vector3d StereoCamera::project(const Eigen::Vector3d& point) const {
  return {focal * point.x() / point.z() + cx, focal * point.y() / point.z() + cy, focal * baseline / point.z()};
}

}  // namespace brink
