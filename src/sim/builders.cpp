#include "sim/builders.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace brink::sim {
namespace {

constexpr double kTau = 2.0 * std::numbers::pi;

int add_vertex(Mesh& mesh, const Eigen::Vector3d& p) {
  mesh.vertices.emplace_back(p.cast<float>());
  return static_cast<int>(mesh.vertices.size()) - 1;
}

void add_quad(Mesh& mesh, int a, int b, int c, int d) {
  mesh.triangles.emplace_back(a, b, c);
  mesh.triangles.emplace_back(a, c, d);
}

void add_fan(Mesh& mesh, const Ring& corners) {
  const int first = static_cast<int>(mesh.vertices.size());
  for (const Eigen::Vector3d& p : corners) add_vertex(mesh, p);
  for (int i = 2; i < static_cast<int>(corners.size()); ++i) mesh.triangles.emplace_back(first, first + i - 1, first + i);
}

/// Convex openings, each with its bounds for a quick answer.
struct Cut {
  Polygon polygon;
  Eigen::AlignedBox2d bounds;
};

std::vector<Cut> make_cuts(const std::vector<Polygon>& openings) {
  std::vector<Cut> cuts;
  for (const Polygon& opening : openings) {
    for (Polygon& part : split_into_convex(opening)) {
      Eigen::AlignedBox2d bounds = compute_bounds(part);
      cuts.push_back({std::move(part), bounds});
    }
  }
  return cuts;
}

/// Adds what the cuts leave of a triangle.
void add_cut_triangle(Mesh& mesh, const Eigen::Vector3i& triangle, const std::vector<Cut>& cuts) {
  std::array<Eigen::Vector3d, 3> corner;
  for (int i = 0; i < 3; ++i)
    corner.at(static_cast<std::size_t>(i)) = mesh.vertices[static_cast<std::size_t>(triangle[i])].cast<double>();
  const Polygon whole{corner[0].head<2>(), corner[1].head<2>(), corner[2].head<2>()};
  const Eigen::AlignedBox2d bounds = compute_bounds(whole);
  std::vector<Polygon> pieces{whole};
  for (const Cut& cut : cuts) {
    if (!cut.bounds.intersects(bounds)) continue;
    std::vector<Polygon> left;
    for (const Polygon& piece : pieces) {
      for (Polygon& part : subtract(piece, cut.polygon)) left.push_back(std::move(part));
    }
    pieces = std::move(left);
  }
  if (pieces.size() == 1 && pieces[0] == whole) {
    mesh.triangles.push_back(triangle);
    return;
  }
  const Eigen::Vector3d normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
  for (const Polygon& piece : pieces) {
    Ring ring;
    for (const Eigen::Vector2d& p : piece) {
      const double z = corner[0].z() - normal.head<2>().dot(p - corner[0].head<2>()) / normal.z();
      ring.emplace_back(p.x(), p.y(), z);
    }
    add_fan(mesh, ring);
  }
}

}  // namespace

Mesh make_sheet(const Eigen::AlignedBox2d& area, const Eigen::Vector2d& cell, const std::vector<Polygon>& openings,
                const HeightFunction& height) {
  const Eigen::Vector2d size = area.sizes();
  const int columns = std::max(1, static_cast<int>(std::ceil(size.x() / cell.x() - 1e-6)));
  const int rows = std::max(1, static_cast<int>(std::ceil(size.y() / cell.y() - 1e-6)));
  Mesh mesh;
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      const double x = i == columns ? area.max().x() : area.min().x() + size.x() * i / columns;
      const double y = j == rows ? area.max().y() : area.min().y() + size.y() * j / rows;
      add_vertex(mesh, {x, y, height ? height(x, y) : 0.0});
    }
  }
  const std::vector<Cut> cuts = make_cuts(openings);
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const int a = j * (columns + 1) + i;
      const int d = a + columns + 1;
      add_cut_triangle(mesh, {a, a + 1, d + 1}, cuts);
      add_cut_triangle(mesh, {a, d + 1, d}, cuts);
    }
  }
  return mesh;
}

Mesh make_patch(const Polygon& outline, double z, int rings) {
  const Eigen::Vector2d center = compute_centroid(outline);
  std::vector<Ring> lines;
  for (int k = 0; k < rings; ++k) {
    Ring line;
    for (const Eigen::Vector2d& p : outline) {
      const Eigen::Vector2d q = p + (center - p) * k / rings;
      line.emplace_back(q.x(), q.y(), z);
    }
    lines.push_back(std::move(line));
  }
  Mesh mesh = make_loft(lines);
  const int middle = add_vertex(mesh, {center.x(), center.y(), z});
  const int count = static_cast<int>(outline.size());
  const int first = (rings - 1) * count;
  for (int i = 0; i < count; ++i) mesh.triangles.emplace_back(middle, first + i, first + (i + 1) % count);
  return mesh;
}

Mesh make_loft(const std::vector<Ring>& rings) {
  Mesh mesh;
  for (const Ring& ring : rings) {
    for (const Eigen::Vector3d& p : ring) add_vertex(mesh, p);
  }
  for (int k = 1; k < static_cast<int>(rings.size()); ++k) {
    const int count = static_cast<int>(rings[0].size());
    const int above = (k - 1) * count;
    const int below = k * count;
    for (int i = 0; i < count; ++i) add_quad(mesh, above + i, above + (i + 1) % count, below + (i + 1) % count, below + i);
  }
  return mesh;
}

Mesh make_wall(const std::vector<Eigen::Vector2d>& line, bool closed, double bottom, double top) {
  Mesh mesh;
  const std::size_t sides = closed ? line.size() : line.size() - 1;
  for (std::size_t i = 0; i < sides; ++i) {
    const Eigen::Vector2d& a = line[i];
    const Eigen::Vector2d& b = line[(i + 1) % line.size()];
    add_fan(mesh, {{a.x(), a.y(), bottom}, {b.x(), b.y(), bottom}, {b.x(), b.y(), top}, {a.x(), a.y(), top}});
  }
  return mesh;
}

Mesh make_prism(const Polygon& outline, double bottom, double top) {
  Mesh mesh = make_wall(outline, true, bottom, top);
  append(mesh, make_patch(outline, top));
  return mesh;
}

Mesh make_box(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  const Polygon outline = make_rectangle(low.head<2>(), high.head<2>());
  Mesh mesh = make_prism(outline, low.z(), high.z());
  append(mesh, make_patch(outline, low.z()));
  return mesh;
}

Mesh make_bar(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double radius, int sides) {
  const Eigen::Vector3d along = (to - from).normalized();
  const Eigen::Vector3d side = along.unitOrthogonal();
  const Eigen::Vector3d other = along.cross(side);
  Ring first;
  Ring last;
  for (int i = 0; i < sides; ++i) {
    const Eigen::Vector3d offset = radius * (std::cos(kTau * i / sides) * side + std::sin(kTau * i / sides) * other);
    first.emplace_back(from + offset);
    last.emplace_back(to + offset);
  }
  Mesh mesh = make_loft({first, last});
  add_fan(mesh, first);
  add_fan(mesh, last);
  return mesh;
}

Mesh make_post(const Eigen::Vector3d& foot, double radius, double height, int sides) {
  return make_bar(foot, foot + Eigen::Vector3d(0.0, 0.0, height), radius, sides);
}

Mesh make_ellipsoid(const Eigen::Vector3d& center, const Eigen::Vector3d& radii, int sides) {
  const int levels = sides / 2;
  std::vector<Ring> rings;
  for (int k = 0; k <= levels; ++k) {
    const double polar = std::numbers::pi * k / levels;
    Ring ring;
    for (int i = 0; i < sides; ++i) {
      const Eigen::Vector3d unit(std::sin(polar) * std::cos(kTau * i / sides), std::sin(polar) * std::sin(kTau * i / sides),
                                 std::cos(polar));
      ring.emplace_back(center + radii.cwiseProduct(unit));
    }
    rings.push_back(std::move(ring));
  }
  return make_loft(rings);
}

Mesh make_pane(const Eigen::Vector3d& corner, const Eigen::Vector3d& first_side, const Eigen::Vector3d& second_side) {
  Mesh mesh;
  add_fan(mesh, {corner, corner + first_side, corner + first_side + second_side, corner + second_side});
  return mesh;
}

Mesh make_steps(int steps, double rise, double tread, double width, double landing) {
  Mesh mesh;
  for (int i = 0; i < steps; ++i) {
    const Eigen::Vector3d edge(i * tread, 0.0, -i * rise);
    const Eigen::Vector3d across(0.0, width, 0.0);
    const double deep = i + 1 == steps ? landing : tread;
    append(mesh, make_pane(edge, across, {0.0, 0.0, -rise}));
    append(mesh, make_pane(edge - Eigen::Vector3d(0.0, 0.0, rise), {deep, 0.0, 0.0}, across));
  }
  return mesh;
}

Mesh make_leaves(Random& random, const Eigen::Vector3d& center, const Eigen::Vector3d& radii, int count, double size) {
  Mesh mesh;
  while (count > 0) {
    const Eigen::Vector3d unit(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
    const double turn = random.uniform(0.0, kTau);
    const double tilt = random.uniform(-0.8, 0.8);
    const double half = random.uniform(0.35, 0.65) * size;
    if (unit.squaredNorm() > 1.0) continue;
    const bool flat = radii.z() <= 0.0;
    const Eigen::Vector3d along(std::cos(turn), std::sin(turn), flat ? 0.0 : tilt);
    const Eigen::Vector3d across(-std::sin(turn), std::cos(turn), 0.0);
    const Eigen::Vector3d lift(0.0, 0.0, flat ? 0.004 * (1.0 + unit.z()) : 0.0);
    append(mesh, make_pane(center + radii.cwiseProduct(unit) + lift - half * along - 0.35 * half * across, 2.0 * half * along,
                           0.7 * half * across));
    --count;
  }
  return mesh;
}

Polygon make_blob(Random& random, const Eigen::Vector2d& center, double radius, double raggedness, int corners) {
  const double phase_two = random.uniform(0.0, kTau);
  const double phase_three = random.uniform(0.0, kTau);
  Polygon blob;
  for (int i = 0; i < corners; ++i) {
    const double angle = kTau * i / corners;
    const double wave = 0.5 * std::sin(2.0 * angle + phase_two) + 0.3 * std::sin(3.0 * angle + phase_three);
    const double r = radius * (1.0 + raggedness * (wave + random.uniform(-0.3, 0.3)));
    blob.emplace_back(center + r * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  return blob;
}

void append(Mesh& mesh, const Mesh& other) {
  const int first = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const Eigen::Vector3i& t : other.triangles) mesh.triangles.emplace_back(t + Eigen::Vector3i::Constant(first));
}

Mesh moved(Mesh mesh, double yaw, const Eigen::Vector3d& shift) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  for (Eigen::Vector3f& p : mesh.vertices) p = (turn * p.cast<double>() + shift).cast<float>();
  return mesh;
}

Polygon moved(Polygon polygon, double yaw, const Eigen::Vector2d& shift) {
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(yaw).toRotationMatrix();
  for (Eigen::Vector2d& p : polygon) p = turn * p + shift;
  return polygon;
}

}  // namespace brink::sim
