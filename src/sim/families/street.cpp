#include <algorithm>
#include <array>

#include "sim/families/common.hpp"
#include "sim/families/decoys.hpp"
#include "sim/families/surroundings.hpp"

namespace brink::sim {
namespace {

// Across the street: houses, pavement, kerb at y = 0, road, pavement, houses.
constexpr double kHouses = -5.2;
constexpr double kRoadWidth = 6.0;
constexpr double kFarHouses = 9.5;
constexpr double kCurbInside = 3.0;  // m of road that count as the kerb's inside
constexpr double kLane = -1.9;       // where people walk
constexpr int kNotLabelled = 255;

/// Along the street.
struct Extent {
  double begin;
  double end;
};

Mesh make_strip(const Extent& extent, double low, double high, double z) {
  return moved(make_sheet({Eigen::Vector2d(extent.begin, low), Eigen::Vector2d(extent.end, high)}, {1.0, 1.0}, {}, {}), 0.0,
               {0.0, 0.0, z});
}

/// The road below the kerb. What lies farther than kCurbInside is neither inside nor ground: it is not labelled.
void add_road(Site& site, const Extent& extent) {
  const double drop = site.random.uniform(0.08, 0.20);
  const int asphalt = site.add_material(materials::varied(materials::asphalt(), site.random));
  const int stone = site.add_material(materials::varied(materials::concrete(), site.random));
  const Polygon rim = make_rectangle({extent.begin, 0.0}, {extent.end, kCurbInside});
  const int id = site.add_instance("curb", drop, rim);
  site.openings.push_back(make_rectangle({extent.begin, 0.0}, {extent.end, kRoadWidth}));
  add_shaft(site, {{extent.begin, 0.0}, {extent.end, 0.0}}, false, drop, stone, id);
  site.add(make_strip(extent, 0.0, kCurbInside, -drop), asphalt, id);
  site.add(make_strip(extent, kCurbInside, kRoadWidth, -drop), asphalt, kNotLabelled);
  add_shaft(site, {{extent.begin, kRoadWidth}, {extent.end, kRoadWidth}}, false, drop, stone, kNotLabelled);
  site.add(make_strip(extent, -0.15, 0.0, 0.0), stone);
  const int paint = site.add_material(materials::varied(materials::white_paint(), site.random));
  const int dashes = static_cast<int>((extent.end - extent.begin - 3.0) / 5.0) + 1;
  for (int dash = 0; dash < dashes; ++dash) {
    const double x = extent.begin + 1.0 + 5.0 * dash;
    site.add(make_strip({x, x + 2.0}, kCurbInside + 0.05, kCurbInside + 0.17, 0.002 - drop), paint, kNotLabelled);
  }
}

/// Sloped ragged walls and an uneven floor.
Hazard add_pothole(Site& site, double x, bool past_by_houses) {
  Random& random = site.random;
  const double radius = random.uniform(0.25, 0.45);
  const double depth = random.uniform(0.05, 0.25);
  const Eigen::Vector2d center(x, kLane + random.uniform(-0.25, 0.25));
  const Polygon rim = make_blob(random, center, radius, 0.3, 24);
  const int id = site.add_instance("pothole", depth, rim);
  std::vector<Ring> rings(4);
  constexpr std::array<double, 4> kScale{1.0, 0.86, 0.68, 0.35};
  constexpr std::array<double, 4> kShare{0.0, 0.55, 0.9, 1.0};
  for (std::size_t k = 0; k < rings.size(); ++k) {
    for (const Eigen::Vector2d& p : rim) {
      const double ragged = k == 1 || k == 2 ? random.uniform(-0.1, 0.1) : 0.0;
      const Eigen::Vector2d q = center + (kScale.at(k) + 0.5 * ragged) * (p - center);
      rings[k].emplace_back(q.x(), q.y(), -depth * std::min(1.0, kShare.at(k) + ragged));
    }
  }
  Mesh mesh = make_loft(rings);
  Polygon floor;
  for (const Eigen::Vector3d& p : rings.back()) floor.emplace_back(p.head<2>());
  append(mesh, make_patch(floor, -depth));
  const Material inside = random.chance(0.5) ? materials::gravel() : materials::asphalt();
  site.add(std::move(mesh), site.add_material(materials::varied(inside, random)), id);
  site.openings.push_back(rim);
  const Eigen::Vector2d half = 0.5 * compute_bounds(rim).sizes();
  const double aside = past_by_houses || random.chance(0.5) ? std::max(-3.2, center.y() - half.y() - 0.7)
                                                            : std::min(-0.6, center.y() + half.y() + 0.7);
  return {.center = center, .half_size = half, .aside_y = aside};
}

Hazard add_trench(Site& site, double x) {
  Random& random = site.random;
  Hazard hazard{.center = {x, -1.45}, .half_size = {random.uniform(0.2, 0.35), random.uniform(0.6, 0.75)}, .aside_y = -2.95};
  const double depth = random.uniform(0.35, 0.9);
  const Polygon rim = make_rectangle(hazard.center - hazard.half_size, hazard.center + hazard.half_size);
  const int id = site.add_instance("trench", depth, rim);
  const int soil = site.add_material(materials::varied(materials::soil(), random));
  add_shaft(site, rim, true, depth, soil, id);
  site.add(make_patch(rim, -depth), soil, id);
  site.openings.push_back(rim);
  const Eigen::Vector2d heap = hazard.center + Eigen::Vector2d(hazard.half_size.x() + 0.65, 0.2);
  site.add(make_ellipsoid({heap.x(), heap.y(), 0.0}, {0.4, 0.55, random.uniform(0.2, 0.35)}, 20), soil);
  site.take(heap, 0.6, true);
  return hazard;
}

void add_cellar_stairs(Site& site, double x) {
  Random& random = site.random;
  const int steps = random.integer(7, 11);
  const double rise = random.uniform(0.16, 0.19);
  const double tread = random.uniform(0.25, 0.29);
  const double width = random.uniform(0.9, 1.05);
  const double length = (steps - 1) * tread + 0.9;
  const double y = kHouses + 0.08;
  const Polygon rim = make_rectangle({x, y}, {x + length, y + width});
  const int id = site.add_instance("stairs_down", steps * rise, rim);
  const int stone = site.add_material(materials::varied(materials::concrete(), random));
  site.add(moved(make_steps(steps, rise, tread, width, 0.9), 0.0, {x, y, 0.0}), stone, id);
  add_shaft(site, {rim[1], rim[2], rim[3]}, false, steps * rise, stone, id);
  add_shaft(site, {rim[0], rim[1]}, false, steps * rise, stone, id);
  site.openings.push_back(rim);
  if (random.chance(0.5)) add_railing(site, {{x + 0.3, y + width + 0.05}, {x + length, y + width + 0.05}}, 1.0);
}

}  // namespace

void build_street(Site& site) {
  Random& random = site.random;
  const double spacing = std::clamp(site.path_length() / 4.5, 3.2, 5.0);
  const int trench = random.integer(0, 2);
  std::vector<Hazard> hazards;
  hazards.reserve(3);
  for (int i = 0; i < 3; ++i)
    hazards.push_back(i == trench ? add_trench(site, i * spacing) : add_pothole(site, i * spacing, i == 2));
  add_cellar_stairs(site, random.uniform(-0.5, 1.5 * spacing));
  const double end = hazards.back().center.x() + hazards.back().half_size.x() + random.uniform(2.0, 2.8);
  Line approach = weave_past({-5.0, kLane}, hazards);
  approach.emplace_back(end, -0.92);
  const Extent extent{.begin = -11.0, .end = end + 14.0};
  add_road(site, extent);
  site.set_path(approach, {{end + 0.9, -1.8}, {end, -3.45}, {-5.5, -3.45}});

  add_house_row(site, {extent.begin, kHouses}, {extent.end, kHouses});
  add_house_row(site, {extent.end, kFarHouses}, {extent.begin, kFarHouses});
  add_house_row(site, {extent.end, kHouses}, {extent.end, kFarHouses});
  add_house_row(site, {extent.begin, kFarHouses}, {extent.begin, kHouses});
  const Eigen::AlignedBox2d inner(Eigen::Vector2d(extent.begin + 1.0, kHouses + 0.3), Eigen::Vector2d(extent.end - 1.0, -0.3));
  add_decoys(site, inner, {.solids = random.integer(4, 7), .flats = random.integer(4, 7), .people = 2});
  const int pavement = add_pavement_material(site);
  site.add(
      make_sheet({Eigen::Vector2d(extent.begin, kHouses), Eigen::Vector2d(extent.end, -0.15)}, {1.0, 1.0}, site.openings, {}),
      pavement);
  site.add(make_strip(extent, kRoadWidth, kFarHouses, 0.0), pavement);
}

}  // namespace brink::sim
