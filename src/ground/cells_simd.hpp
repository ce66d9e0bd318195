#pragma once

#include <Eigen/Core>

#include "brink/camera.hpp"
#include "brink/ground.hpp"

namespace brink {

/// The ground seen from above in square cells: x along GroundPose::right, y along GroundPose::forward, m. They are counted row
/// by row.
struct CellGrid {
  double cell_m = 0.0;
  double left_m = 0.0;  ///< x of the first column's edge; rows begin at y = 0
  int columns = 0;
  int rows = 0;
};

/// Every step-th pixel of a row of the picture, from the first one on.
struct PixelRow {
  const float* disparity;  ///< of these pixels
  int v;
  int first;
  int step;
  int count;
};

/// For each pixel of the row its cell and its elevation, m; the cell is -1 without a disparity, out of the grid, or at
/// `highest_m` above or below the plane and farther. Equal to the plain twin in tests/reference/cells.hpp for every target.
void place_in_cells(const PixelRow& row, const StereoCamera& camera, const GroundPose& pose, const CellGrid& grid,
                    double highest_m, int* cells, float* elevation_m);

}  // namespace brink
