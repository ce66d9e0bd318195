#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <vector>

#include <opencv2/core.hpp>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "brink/ground.hpp"
#include "ground/elevation_simd.hpp"
#include "ground/level.hpp"
#include "ground/roughness.hpp"

namespace brink {
namespace {

/// Bilinear, between the middles of cells.
double sample(const cv::Mat1f& cells, double column, double row) {
  const double x = std::clamp(column, 0.0, std::max(0.0, cells.cols - 1.001));
  const double y = std::clamp(row, 0.0, std::max(0.0, cells.rows - 1.001));
  const int left = static_cast<int>(x);
  const int top = static_cast<int>(y);
  const int right = std::min(left + 1, cells.cols - 1);
  const int bottom = std::min(top + 1, cells.rows - 1);
  const double upper = (1.0 - (x - left)) * cells(top, left) + (x - left) * cells(top, right);
  const double lower = (1.0 - (x - left)) * cells(bottom, left) + (x - left) * cells(bottom, right);
  return (1.0 - (y - top)) * upper + (y - top) * lower;
}

/// What lies within a tolerance of a plane, 255 = so.
cv::Mat1b select_plane(const cv::Mat1f& disparity, const GroundPlane& plane, const StereoCamera& camera, float tolerance_m) {
  const auto height = static_cast<float>(compute_ground_pose(plane, camera).height_m);
  const auto step = static_cast<float>(plane.a);
  cv::Mat1b on_plane(disparity.size());
  tbb::parallel_for(tbb::blocked_range<int>(0, disparity.rows), [&](const tbb::blocked_range<int>& rows) {
    std::vector<float> elevation(static_cast<std::size_t>(disparity.cols));
    for (int v = rows.begin(); v < rows.end(); ++v) {
      const auto first = static_cast<float>(plane.disparity(0.0, v));
      compute_elevation_row(disparity[v], disparity.cols, height, first, step, elevation.data());
      select_level_row(elevation.data(), disparity.cols, tolerance_m, on_plane[v]);
    }
  });
  return on_plane;
}

}  // namespace

double GroundSurface::relief(const Eigen::Vector3d& point) const {
  if (relief_m.empty()) return 0.0;
  const double column = pose.right.dot(point) / cell_m + relief_m.cols / 2.0 - 0.5;
  const double row = pose.forward.dot(point) / cell_m - 0.5;
  if (!std::isfinite(column) || !std::isfinite(row)) return 0.0;  // no disparity to speak of: farther away than numbers reach
  return sample(relief_m, column, row);
}

// Down the ray from the highest to the lowest height that the surface has.
std::optional<Eigen::Vector3d> GroundSurface::intersect(double u, double v, const StereoCamera& camera) const {
  std::optional<Eigen::Vector3d> on_plane = pose.intersect(u, v, camera);
  if (!on_plane || relief_m.empty()) return on_plane;
  constexpr double kStep = 0.02;  // m of height
  const auto at_height = [&](double height) { return Eigen::Vector3d((1.0 - height / pose.height_m) * *on_plane); };
  double above = 0.0;  // of the last point over the surface
  for (double height = std::min(highest_m, 0.9 * pose.height_m);; height -= kStep) {
    const double over = height - relief(at_height(height));
    if (over <= 0.0) return at_height(above > 0.0 ? height - kStep * over / (above - over) : height);
    if (height <= lowest_m) return at_height(height);
    above = over;
  }
}

GroundSurface make_flat_surface(const GroundEstimate& ground, const cv::Mat1f& disparity, const StereoCamera& camera) {
  constexpr float kOnPlane = 0.1F;          // m
  constexpr double kLeastRoughness = 0.03;  // px; given disparities may have none
  if (!ground.plane) throw std::invalid_argument("ground has no plane");
  GroundSurface surface;
  surface.plane = *ground.plane;
  surface.pose = ground.pose;
  const cv::Mat1b on_plane = select_plane(disparity, *ground.plane, camera, kOnPlane);
  surface.roughness_px = std::max(kLeastRoughness, compute_roughness_px(on_plane, disparity));
  const double noise_px = kNoiseOverRoughness * surface.roughness_px;
  surface.disparity_sd_px = std::clamp(ground.residual_px, noise_px, 2.0 * noise_px);
  return surface;
}

cv::Mat1f compute_elevation(const cv::Mat1f& disparity, const GroundSurface& ground, const StereoCamera& camera) {
  cv::Mat1f elevation = compute_elevation(disparity, ground.plane, camera);
  if (ground.relief_m.empty() || (ground.lowest_m == 0.0 && ground.highest_m == 0.0)) return elevation;
  // relief(triangulate(u, v, d)) for every pixel. Along a row both of its coordinates at a depth of 1 are linear in u.
  const double scale = camera.focal * camera.baseline / ground.cell_m;
  tbb::parallel_for(0, elevation.rows, [&](int v) {
    const Eigen::Vector3d first((0.0 - camera.cx) / camera.focal, (v - camera.cy) / camera.focal, 1.0);
    const double right = ground.pose.right.dot(first);
    const double right_step = ground.pose.right.x() / camera.focal;
    const double forward = ground.pose.forward.dot(first);
    const double forward_step = ground.pose.forward.x() / camera.focal;
    for (int u = 0; u < elevation.cols; ++u) {
      if (std::isnan(elevation(v, u))) continue;
      const double depth = scale / disparity(v, u);  // in cells
      const double column = depth * (right + u * right_step) + ground.relief_m.cols / 2.0 - 0.5;
      const double row = depth * (forward + u * forward_step) - 0.5;
      if (!std::isfinite(column) || !std::isfinite(row)) continue;
      elevation(v, u) -= static_cast<float>(sample(ground.relief_m, column, row));
    }
  });
  return elevation;
}

}  // namespace brink
