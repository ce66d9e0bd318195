#include <algorithm>
#include <numbers>

#include "sim/families/common.hpp"
#include "sim/families/decoys.hpp"
#include "sim/families/surroundings.hpp"

namespace brink::sim {
namespace {

void add_manhole(Site& site, const Eigen::Vector2d& center, double radius, double depth) {
  const Polygon rim = make_circle(center, radius, 32);
  const int id = site.add_instance("manhole", depth, rim);
  const bool black = depth > 2.0;  // wet, sooty walls swallow what light gets in
  const int wall = site.add_material(materials::varied(black ? materials::soot() : materials::concrete(), site.random));
  const int floor = site.add_material(materials::varied(black ? materials::soot() : materials::soil(), site.random));
  const int frame = site.add_material(materials::varied(materials::iron(), site.random));
  add_shaft(site, rim, true, depth, wall, id);
  site.add(make_patch(rim, -depth), floor, id);
  const auto ring_at = [&](double r) {
    Ring ring;
    for (const Eigen::Vector2d& p : make_circle(center, r, 32)) ring.emplace_back(p.x(), p.y(), 0.002);
    return ring;
  };
  if (site.random.chance(0.7)) site.add(make_loft({ring_at(radius + 0.002), ring_at(radius + 0.07)}), frame);
  site.openings.push_back(rim);
}

/// A lower area or a trench with its long side along or across the way.
void add_lower_area(Site& site, const Hazard& hazard, bool trench) {
  const double depth = site.random.uniform(trench ? 0.35 : 0.2, 0.6);
  const Polygon rim = make_rectangle(hazard.center - hazard.half_size, hazard.center + hazard.half_size);
  const int id = site.add_instance(trench ? "trench" : "lower_ground", depth, rim);
  const Material ground = trench ? materials::soil() : materials::gravel();
  const int wall = site.add_material(materials::varied(trench ? materials::soil() : materials::concrete(), site.random));
  add_shaft(site, rim, true, depth, wall, id);
  site.add(make_patch(rim, -depth), site.add_material(materials::varied(ground, site.random)), id);
  site.openings.push_back(rim);
}

std::vector<Hazard> place_hazards(Site& site) {
  Random& random = site.random;
  const double spacing = std::clamp(site.path_length() / 3.6, 3.0, 5.0);
  std::vector<int> order{0, 1, 2};
  for (std::size_t i = 2; i > 0; --i)
    std::swap(order[i], order[static_cast<std::size_t>(random.integer(0, static_cast<int>(i)))]);
  std::vector<Hazard> hazards;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Eigen::Vector2d center(static_cast<double>(i) * (spacing + 0.6), random.uniform(-0.5, 0.5));
    const double radius = random.uniform(0.3, 0.4);
    if (order[i] == 0) add_manhole(site, center, radius, random.uniform(0.4, 0.8));
    if (order[i] == 1) add_manhole(site, center, radius, random.uniform(2.5, 4.0));
    Hazard hazard{.center = center, .half_size = Eigen::Vector2d::Constant(radius), .aside_y = 0.0};
    if (order[i] == 2) {
      const bool trench = random.chance(0.4);
      hazard.half_size = trench ? Eigen::Vector2d(random.uniform(0.25, 0.4), random.uniform(0.9, 1.6))
                                : Eigen::Vector2d(random.uniform(0.6, 0.9), random.uniform(0.7, 1.1));
      add_lower_area(site, hazard, trench);
    }
    hazard.aside_y = center.y() + random.sign() * (hazard.half_size.y() + random.uniform(0.6, 0.85));
    hazards.push_back(hazard);
  }
  return hazards;
}

Material pick_ground(Random& random) {
  const int kind = random.integer(0, 3);
  if (kind == 0) return materials::asphalt();
  if (kind == 1) return materials::gravel();
  if (kind == 2) return materials::concrete();
  return materials::soil();
}

}  // namespace

void build_manholes(Site& site) {
  std::vector<Hazard> hazards = place_hazards(site);
  const Hazard last = hazards.back();
  hazards.pop_back();
  Line approach = weave_past({-5.0, 0.0}, hazards);
  approach.emplace_back(last.center.x() - last.half_size.x() - 0.9, last.center.y());
  const double side = site.random.sign() * 3.4;
  const double end = approach.back().x();
  site.set_path(approach,
                {{end, 0.5 * side}, {end - 1.0, side}, {approach.front().x() - 0.5, side}, {approach.front().x() - 1.0, 0.0}});

  const Eigen::AlignedBox2d area(Eigen::Vector2d(approach.front().x() - 6.0, -7.0), Eigen::Vector2d(end + 14.0, 7.0));
  const Eigen::AlignedBox2d rough(Eigen::Vector2d(area.min().x() + 3.0, -5.0), Eigen::Vector2d(area.max().x() - 8.0, 5.0));
  add_surroundings(site, area);
  add_decoys(site, rough, {.solids = site.random.integer(3, 6), .flats = site.random.integer(4, 7), .people = 2});

  const int ground = site.add_material(materials::varied(pick_ground(site.random), site.random));
  const HeightFunction height =
      make_rough_height(site, rough, site.random.uniform(0.01, 0.02), site.random.integer(0, 1 << 20));
  site.add(make_sheet(rough, {0.13, 0.13}, site.openings, height), ground);
  add_ground_around(site, area, rough, ground);
}

}  // namespace brink::sim
