#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/families/common.hpp"
#include "sim/families/decoys.hpp"
#include "sim/families/surroundings.hpp"

namespace brink::sim {
namespace {

constexpr double kCellX = 0.2;  // m; ramps bend along x

/// A ramp up, a level stretch, a ramp down, all gently rounded.
HeightFunction make_ramps(Random& random, double begin) {
  constexpr double kRounding = 2.0;  // m along which the slope comes and goes
  const double slope = std::tan(random.uniform(3.0, 8.0) * std::numbers::pi / 180.0);
  const double run = random.uniform(2.2, 4.0);
  const double level = random.uniform(2.2, 5.0);
  const auto bend = [slope](double t) {
    if (t <= 0.0) return 0.0;
    return slope * (t < kRounding ? t * t / (2.0 * kRounding) : t - 0.5 * kRounding);
  };
  return [=](double x, double) {
    const double t = x - begin;
    return bend(t) - bend(t - run) - bend(t - run - level) + bend(t - 2.0 * run - level);
  };
}

/// A pavement higher than the walker's ground on one side.
void add_kerb_up(Site& site, const Eigen::AlignedBox2d& area, double side) {
  const double height = site.random.uniform(0.08, 0.18);
  const double kerb = side > 0.0 ? area.max().y() : area.min().y();
  const double wall = kerb + side * 2.5;
  Line line;
  double x = area.min().x();
  while (x < area.max().x() + 0.5 * kCellX) {
    line.emplace_back(x, kerb);
    x += kCellX;
  }
  site.add(make_wall(line, false, -0.2, height), site.add_material(materials::varied(materials::concrete(), site.random)));
  const Eigen::Vector2d low(area.min().x(), std::min(kerb, wall));
  const Eigen::Vector2d high(line.back().x(), std::max(kerb, wall));
  site.add(moved(make_sheet({low, high}, {kCellX, 2.5}, {}, {}), 0.0, {0.0, 0.0, height}), add_pavement_material(site));
}

void add_white_wall(Site& site, const Eigen::AlignedBox2d& area) {
  const auto spot = site.take_spot(area, 1.3, true);
  if (!spot) return;
  const double height = site.random.uniform(0.8, 2.2);
  site.add(moved(make_box({-1.2, -0.1, -0.4}, {1.2, 0.1, height}), site.random.uniform(0.0, std::numbers::pi),
                 {spot->x(), spot->y(), 0.0}),
           site.add_material(materials::white_wall()));
}

}  // namespace

void build_open_place(Site& site, const OpenPlace& place) {
  Random& random = site.random;
  const auto [low, high] = std::ranges::minmax(place.approach, {}, [](const Eigen::Vector2d& p) { return p.x(); });
  const double begin = low.x();
  const double end = high.x();
  const double side = random.sign();
  site.set_path(place.approach, {{end + 1.5, 1.5 * side}, {end, 3.2 * side}, {begin, 3.2 * side}, {begin - 1.5, 1.5 * side}});
  if (place.ramps) site.profile = make_ramps(random, random.uniform(std::max(begin, end - site.path_length()), end - 6.0));

  const Eigen::AlignedBox2d ground(Eigen::Vector2d(begin - 6.0, -4.5), Eigen::Vector2d(end + 12.0, 4.5));
  const Eigen::AlignedBox2d area(Eigen::Vector2d(ground.min().x(), -7.0), Eigen::Vector2d(ground.max().x(), 7.0));
  add_surroundings(site, area);
  for (const double edge : {1.0, -1.0}) add_kerb_up(site, ground, edge);
  add_stairs_up(site, {end + 5.0, -1.6}, {4.0, random.uniform(2.0, 3.2)}, random.integer(4, 9));
  const Eigen::AlignedBox2d inner(ground.min().array() + 0.5, ground.max().array() - Eigen::Array2d(7.5, 0.5));
  add_white_wall(site, inner);
  add_decoys(site, inner, {.solids = place.solids, .flats = place.flats, .people = place.people});
  site.add(make_sheet(ground, {kCellX, 1.5}, {}, {}), add_pavement_material(site));
}

void build_control(Site& site) {
  Random& random = site.random;
  const double length = std::clamp(site.path_length(), 10.0, 40.0);
  Line approach{{0.0, random.uniform(-0.8, 0.8)}};
  while (approach.back().x() < length) {
    approach.emplace_back(approach.back().x() + random.uniform(4.0, 7.0), random.uniform(-1.4, 1.4));
  }
  build_open_place(site, {.approach = approach, .solids = random.integer(6, 10), .flats = random.integer(8, 13), .people = 4});
}

}  // namespace brink::sim
