#pragma once

#include <array>
#include <vector>

#include "disparity/support_points.hpp"

namespace brink {

/// Indices of the three corners of a triangle, counter-clockwise when v points up.
using Triangle = std::array<int, 3>;

/// The points as the right view sees them, column u - disparity, ordered by row and column. Where two coincide the larger
/// disparity stays: the nearer surface hides the other.
std::vector<SupportPoint> move_to_right_view(const std::vector<SupportPoint>& points);

/// Delaunay triangulation of the points' (u, v): no point lies inside the circle through the corners of a triangle. Of several
/// on one circle always the same triangles, but which ones is not told.
/// @param points no two at one pixel.
/// @return no triangle when there are fewer than three points or all lie on one line.
std::vector<Triangle> triangulate(const std::vector<SupportPoint>& points);

}  // namespace brink
