#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace brink::sim {

/// Corners in the x-y plane, counter-clockwise, without repeating the first.
using Polygon = std::vector<Eigen::Vector2d>;

double signed_area(const Polygon& polygon);
Eigen::Vector2d compute_centroid(const Polygon& polygon);  ///< mean of the corners
Eigen::AlignedBox2d compute_bounds(const Polygon& polygon);
bool contains(const Polygon& polygon, const Eigen::Vector2d& point);
double distance_to_segment(const Eigen::Vector2d& point, const Eigen::Vector2d& a, const Eigen::Vector2d& b);
/// To the outline, or 0 inside.
double distance_to_polygon(const Polygon& polygon, const Eigen::Vector2d& point);
/// To the open line through the points.
double distance_to_line(const std::vector<Eigen::Vector2d>& line, const Eigen::Vector2d& point);
double line_length(const std::vector<Eigen::Vector2d>& line);

/// The polygon itself when it is convex, else its triangles around the centroid, from where all of it must be visible.
std::vector<Polygon> split_into_convex(const Polygon& polygon);
/// What is left of a convex piece outside a convex polygon, as convex pieces.
std::vector<Polygon> subtract(const Polygon& piece, const Polygon& convex);

/// The same outline with corners added until no side is longer.
Polygon refine(const Polygon& polygon, double longest_side);

Polygon make_rectangle(const Eigen::Vector2d& low, const Eigen::Vector2d& high);
Polygon make_circle(const Eigen::Vector2d& center, double radius, int corners);

}  // namespace brink::sim
