#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <boost/polygon/voronoi.hpp>

#include "disparity/delaunay.hpp"

// The twin of disparity/delaunay.cpp: the dual of the Voronoi diagram of Boost.Polygon.
namespace brink::reference {

using Voronoi = boost::polygon::voronoi_diagram<double>;

/// Indices of the points around a Voronoi vertex, counter-clockwise, the smallest first.
inline std::vector<int> points_around(const Voronoi::vertex_type& vertex) {
  std::vector<int> around;
  const auto* const first = vertex.incident_edge();
  const auto* edge = first;
  do {
    around.push_back(static_cast<int>(edge->cell()->source_index()));
    edge = edge->rot_next();
  } while (edge != first);
  std::rotate(around.begin(), std::min_element(around.begin(), around.end()), around.end());
  return around;
}

/// Twice the signed area of a triangle.
inline std::int64_t signed_area(const SupportPoint& a, const SupportPoint& b, const SupportPoint& c) {
  return std::int64_t{b.u - a.u} * (c.v - a.v) - std::int64_t{b.v - a.v} * (c.u - a.u);
}

inline std::vector<Triangle> triangulate(const std::vector<SupportPoint>& points) {
  if (points.size() < 3) return {};
  std::vector<boost::polygon::point_data<int>> sites;
  sites.reserve(points.size());
  for (const SupportPoint& point : points) sites.emplace_back(point.u, point.v);
  Voronoi diagram;
  boost::polygon::construct_voronoi(sites.begin(), sites.end(), &diagram);

  std::vector<Triangle> triangles;
  triangles.reserve(2 * points.size());
  for (const auto& vertex : diagram.vertices()) {
    const std::vector<int> around = points_around(vertex);
    for (std::size_t i = 2; i < around.size(); ++i) {
      const Triangle triangle = {around[0], around[i - 1], around[i]};
      const auto corner = [&](std::size_t k) { return points[static_cast<std::size_t>(triangle[k])]; };
      if (signed_area(corner(0), corner(1), corner(2)) > 0) triangles.push_back(triangle);
    }
  }
  return triangles;
}

}  // namespace brink::reference
