#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "brink/sim/scene.hpp"
#include "sim/polygon.hpp"
#include "sim/random.hpp"

namespace brink::sim {

/// Mesh primitives, metres. Material, obstacle and body are left at their defaults for the caller to set.

using Ring = std::vector<Eigen::Vector3d>;                     ///< a closed line in space
using HeightFunction = std::function<double(double, double)>;  ///< z over (x, y)

/// Ground over a rectangle in cells of about the given size, with polygonal openings cut out exactly. Where the ground is not
/// level, an opening's outline lies on the surface between the grid's corners.
Mesh make_sheet(const Eigen::AlignedBox2d& area, const Eigen::Vector2d& cell, const std::vector<Polygon>& openings,
                const HeightFunction& height);
/// A flat polygon, visible from its centroid, in `rings` concentric rings (so that it can follow bent ground).
Mesh make_patch(const Polygon& outline, double z, int rings = 1);
/// The band between closed lines of equal length, one after the other.
Mesh make_loft(const std::vector<Ring>& rings);
/// A vertical wall over a line of corners.
Mesh make_wall(const std::vector<Eigen::Vector2d>& line, bool closed, double bottom, double top);
/// A wall around an outline and a lid on it; the bottom is open.
Mesh make_prism(const Polygon& outline, double bottom, double top);
Mesh make_box(const Eigen::Vector3d& low, const Eigen::Vector3d& high);
/// A round bar between two points, with both ends closed.
Mesh make_bar(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double radius, int sides = 10);
Mesh make_post(const Eigen::Vector3d& foot, double radius, double height, int sides = 12);
Mesh make_ellipsoid(const Eigen::Vector3d& center, const Eigen::Vector3d& radii, int sides = 12);
/// A flat four-cornered pane.
Mesh make_pane(const Eigen::Vector3d& corner, const Eigen::Vector3d& first_side, const Eigen::Vector3d& second_side);
/// Risers and treads that go down (rise > 0) along +x from the origin, y from 0 to width; the last tread is landing long.
Mesh make_steps(int steps, double rise, double tread, double width, double landing);
/// Leaf-sized panes strewn in an ellipsoid; flat on the ground when its height is 0.
Mesh make_leaves(Random& random, const Eigen::Vector3d& center, const Eigen::Vector3d& radii, int count, double size);
/// An outline around a circle whose radius varies by about +- raggedness.
Polygon make_blob(Random& random, const Eigen::Vector2d& center, double radius, double raggedness, int corners);

void append(Mesh& mesh, const Mesh& other);
/// Turns about the z axis through the origin, then shifts.
Mesh moved(Mesh mesh, double yaw, const Eigen::Vector3d& shift);
Polygon moved(Polygon polygon, double yaw, const Eigen::Vector2d& shift);

}  // namespace brink::sim
