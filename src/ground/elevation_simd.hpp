#pragma once

namespace brink {

/// Heights over the ground of the pixels of a row, m: h (1 - d_ground / d); NaN where the disparity is not above 0. Equal to
/// the plain twin in tests/reference/elevation.hpp for every target.
/// @param first disparity of the ground at column 0, px. @param step by which it grows with each column.
void compute_elevation_row(const float* disparity, int width, float height_m, float first, float step, float* elevation);

}  // namespace brink
