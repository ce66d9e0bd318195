#pragma once

#include <cmath>
#include <vector>

#include <opencv2/core.hpp>

#include "ground/cells_simd.hpp"

namespace brink::reference {

/// A pixel's cell and its elevation, m.
struct CellPlace {
  int cell = -1;
  float elevation_m = 0.0F;  ///< 0 without a cell
  bool operator==(const CellPlace&) const = default;
};

/// place_in_cells, pixel by pixel.
inline std::vector<CellPlace> naive_cells(const PixelRow& row, const StereoCamera& camera, const GroundPose& pose,
                                          const CellGrid& grid, double highest_m) {
  std::vector<CellPlace> places(static_cast<std::size_t>(row.count));
  for (int i = 0; i < row.count; ++i) {
    const int u = row.first + i * row.step;
    const double d = row.disparity[i];
    if (!(d > 0.0)) continue;
    const Eigen::Vector3d point = camera.triangulate(u, row.v, d);
    const double elevation = pose.elevation(point);
    if (!(std::abs(elevation) < highest_m)) continue;
    const int column = cvRound((pose.right.dot(point) - grid.left_m) / grid.cell_m - 0.5);
    const int line = cvRound(pose.forward.dot(point) / grid.cell_m - 0.5);
    if (column < 0 || column >= grid.columns || line < 0 || line >= grid.rows) continue;
    places[static_cast<std::size_t>(i)] = {line * grid.columns + column, static_cast<float>(elevation)};
  }
  return places;
}

}  // namespace brink::reference
