#include "sim/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace brink::sim {
namespace {

constexpr double kSliverM2 = 1e-9;  // smaller pieces are rounding noise

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

const Eigen::Vector2d& corner_after(const Polygon& polygon, std::size_t i) { return polygon[(i + 1) % polygon.size()]; }

bool is_convex(const Polygon& polygon) {
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& b = corner_after(polygon, i);
    const Eigen::Vector2d& c = corner_after(polygon, i + 1);
    if (cross(b - polygon[i], c - b) < 0.0) return false;
  }
  return true;
}

/// The part of a convex piece on the left (side 1) or right (side -1) of the line from a to b; empty when there is hardly any.
Polygon clip(const Polygon& piece, const Eigen::Vector2d& a, const Eigen::Vector2d& b, double side) {
  Polygon kept;
  for (std::size_t i = 0; i < piece.size(); ++i) {
    const Eigen::Vector2d& p = piece[i];
    const Eigen::Vector2d& q = corner_after(piece, i);
    const double at_p = side * cross(b - a, p - a);
    const double at_q = side * cross(b - a, q - a);
    if (at_p >= 0.0) kept.push_back(p);
    if ((at_p > 0.0 && at_q < 0.0) || (at_p < 0.0 && at_q > 0.0)) kept.emplace_back(p + (q - p) * (at_p / (at_p - at_q)));
  }
  if (kept.size() < 3 || std::abs(signed_area(kept)) < kSliverM2) kept.clear();
  return kept;
}

}  // namespace

double signed_area(const Polygon& polygon) {
  double twice = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) twice += cross(polygon[i], corner_after(polygon, i));
  return 0.5 * twice;
}

Eigen::Vector2d compute_centroid(const Polygon& polygon) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& p : polygon) sum += p;
  return sum / static_cast<double>(polygon.size());
}

Eigen::AlignedBox2d compute_bounds(const Polygon& polygon) {
  Eigen::AlignedBox2d bounds;
  for (const Eigen::Vector2d& p : polygon) bounds.extend(p);
  return bounds;
}

bool contains(const Polygon& polygon, const Eigen::Vector2d& point) {
  bool inside = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& a = polygon[i];
    const Eigen::Vector2d& b = corner_after(polygon, i);
    if ((a.y() > point.y()) == (b.y() > point.y())) continue;
    if (point.x() < a.x() + (b.x() - a.x()) * (point.y() - a.y()) / (b.y() - a.y())) inside = !inside;
  }
  return inside;
}

double distance_to_segment(const Eigen::Vector2d& point, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d ab = b - a;
  const double along = std::clamp((point - a).dot(ab) / std::max(ab.squaredNorm(), 1e-12), 0.0, 1.0);
  return (point - a - along * ab).norm();
}

double distance_to_polygon(const Polygon& polygon, const Eigen::Vector2d& point) {
  if (contains(polygon, point)) return 0.0;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    nearest = std::min(nearest, distance_to_segment(point, polygon[i], corner_after(polygon, i)));
  }
  return nearest;
}

double distance_to_line(const std::vector<Eigen::Vector2d>& line, const Eigen::Vector2d& point) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < line.size(); ++i) nearest = std::min(nearest, distance_to_segment(point, line[i - 1], line[i]));
  return nearest;
}

double line_length(const std::vector<Eigen::Vector2d>& line) {
  double length = 0.0;
  for (std::size_t i = 1; i < line.size(); ++i) length += (line[i] - line[i - 1]).norm();
  return length;
}

std::vector<Polygon> split_into_convex(const Polygon& polygon) {
  if (is_convex(polygon)) return {polygon};
  const Eigen::Vector2d center = compute_centroid(polygon);
  std::vector<Polygon> triangles;
  triangles.reserve(polygon.size());
  for (std::size_t i = 0; i < polygon.size(); ++i) triangles.push_back({center, polygon[i], corner_after(polygon, i)});
  return triangles;
}

std::vector<Polygon> subtract(const Polygon& piece, const Polygon& convex) {
  std::vector<Polygon> outside;
  Polygon rest = piece;
  for (std::size_t i = 0; i < convex.size(); ++i) {
    Polygon part = clip(rest, convex[i], corner_after(convex, i), -1.0);
    if (!part.empty()) outside.push_back(std::move(part));
    rest = clip(rest, convex[i], corner_after(convex, i), 1.0);
    if (rest.empty()) return {piece};  // they do not meet: no need to cut
  }
  return outside;
}

Polygon refine(const Polygon& polygon, double longest_side) {
  Polygon refined;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d side = corner_after(polygon, i) - polygon[i];
    const int parts = std::max(1, static_cast<int>(std::ceil(side.norm() / longest_side)));
    for (int k = 0; k < parts; ++k) refined.emplace_back(polygon[i] + side * k / parts);
  }
  return refined;
}

Polygon make_rectangle(const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  return {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
}

Polygon make_circle(const Eigen::Vector2d& center, double radius, int corners) {
  Polygon circle;
  circle.reserve(static_cast<std::size_t>(corners));
  for (int i = 0; i < corners; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / corners;
    circle.emplace_back(center + radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  return circle;
}

}  // namespace brink::sim
