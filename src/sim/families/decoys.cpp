#include "sim/families/decoys.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "sim/families/surroundings.hpp"

namespace brink::sim {
namespace {

constexpr double kPi = std::numbers::pi;

Eigen::Vector3d lift(const Eigen::Vector2d& p, double z) { return {p.x(), p.y(), z}; }

void add_bollard(Site& site, const Eigen::Vector2d& foot) {
  Random& random = site.random;
  const Material steel = random.chance(0.5) ? materials::dark_steel()
                                            : materials::colored(materials::painted_steel(), materials::random_color(random));
  site.add(make_post(lift(foot, -0.1), random.uniform(0.05, 0.12), random.uniform(0.7, 1.1)), site.add_material(steel));
}

void add_crate(Site& site, const Eigen::Vector2d& center) {
  Random& random = site.random;
  const Eigen::Vector3d half(random.uniform(0.15, 0.35), random.uniform(0.15, 0.35), 0.0);
  const double height = random.uniform(0.2, 0.7);
  const Material wood = random.chance(0.5) ? materials::varied(materials::wood(), random)
                                           : materials::colored(materials::plaster(), materials::random_color(random));
  site.add(
      moved(make_box({-half.x(), -half.y(), -0.1}, {half.x(), half.y(), height}), random.uniform(0.0, kPi), lift(center, 0.0)),
      site.add_material(wood));
}

void add_planter(Site& site, const Eigen::Vector2d& center) {
  const double half = site.random.uniform(0.3, 0.42);
  const Eigen::Vector3d foot = lift(center, 0.0);
  site.add(moved(make_box({-half, -half, -0.1}, {half, half, 0.5}), site.random.uniform(0.0, kPi), foot),
           site.add_material(materials::varied(materials::concrete(), site.random)));
  site.add(make_leaves(site.random, foot + Eigen::Vector3d(0.0, 0.0, 0.75), {half, half, 0.35}, 160, 0.12),
           site.add_material(materials::varied(materials::leaves(), site.random)));
}

void add_solid(Site& site, const Eigen::AlignedBox2d& area) {
  const int kind = site.random.integer(0, 6);
  constexpr std::array<double, 7> kRadii{0.15, 0.5, 0.6, 0.2, 0.25, 0.8, 0.3};
  const auto spot = site.take_spot(area, kRadii.at(static_cast<std::size_t>(kind)), true);
  if (!spot) return;
  if (kind == 0) add_bollard(site, *spot);
  if (kind == 1) add_crate(site, *spot);
  if (kind == 2) add_planter(site, *spot);
  if (kind == 3) add_lamp_post(site, *spot);
  if (kind == 4) add_tree(site, *spot);
  if (kind == 5) add_bench(site, *spot, site.random.uniform(0.0, 2.0 * kPi));
  if (kind == 6) add_bin(site, *spot);
}

/// A flat thing on the ground, fine enough to follow ramps.
void add_flat_thing(Site& site, const Polygon& outline, const Material& material) {
  constexpr double kFineM = 0.12;
  const double size = compute_bounds(outline).sizes().maxCoeff();
  const int rings = std::max(1, static_cast<int>(std::ceil(0.5 * size / kFineM)));
  site.add(make_patch(refine(outline, kFineM), site.next_flat_z(), rings), site.add_material(material));
}

void add_round_cover(Site& site, const Eigen::Vector2d& center) {
  const double radius = site.random.uniform(0.28, 0.4);
  add_flat_thing(site, make_circle(center, radius, 32), materials::varied(materials::iron(), site.random));
}

/// Bars flush with the ground over darkness that is only painted.
void add_grate(Site& site, const Eigen::Vector2d& center) {
  constexpr int kBars = 9;
  const double half = site.random.uniform(0.2, 0.28);
  const double yaw = site.random.uniform(0.0, kPi);
  add_flat_thing(site, moved(make_rectangle({-half, -half}, {half, half}), yaw, center), materials::rubber());
  const double z = site.next_flat_z() + 0.0005;
  Mesh bars;
  for (int i = 0; i < kBars; ++i) {
    const double y = half * (2.0 * i / (kBars - 1) - 1.0);
    append(bars, make_patch(refine(make_rectangle({-half, y - 0.012}, {half, y + 0.012}), 0.1), z));
  }
  site.add(moved(std::move(bars), yaw, lift(center, 0.0)),
           site.add_material(materials::varied(materials::iron(), site.random)));
}

void add_fallen_leaves(Site& site, const Eigen::Vector2d& center, double radius) {
  const Eigen::Vector3f autumn(0.28F, 0.13F, 0.035F);
  const Eigen::Vector3f green(0.10F, 0.16F, 0.04F);
  const Material dry = materials::colored(materials::leaves(), site.random.chance(0.6) ? autumn : green);
  site.add(make_leaves(site.random, lift(center, site.next_flat_z() + 0.001), {radius, radius, 0.0}, 130, 0.09),
           site.add_material(dry));
}

/// Where somebody dug and closed the ground again with something else.
Material pick_repair(Random& random) {
  return materials::varied(random.chance(0.6) ? materials::asphalt() : materials::concrete(), random);
}

void add_flat(Site& site, const Eigen::AlignedBox2d& area) {
  Random& random = site.random;
  const int kind = random.integer(0, 7);
  constexpr std::array<double, 8> kLeast{0.4, 0.42, 0.4, 0.35, 0.35, 0.4, 0.5, 0.6};
  const double least = kLeast.at(static_cast<std::size_t>(kind));
  const double radius = kind == 1 || kind == 2 ? least : random.uniform(least, 1.8 * least);
  const auto spot = site.take_spot(area, radius, false);
  if (!spot) return;
  const double yaw = random.uniform(0.0, kPi);
  const auto rectangle = [&](double half_x, double half_y) {
    return moved(make_rectangle({-half_x, -half_y}, {half_x, half_y}), yaw, *spot);
  };
  if (kind == 0) add_flat_thing(site, rectangle(0.8 * radius, 0.55 * radius), materials::rubber());
  if (kind == 1) add_round_cover(site, *spot);
  if (kind == 2) add_grate(site, *spot);
  if (kind == 3) add_flat_thing(site, make_blob(random, *spot, 0.7 * radius, 0.4, 28), materials::wet_asphalt());
  if (kind == 4) add_flat_thing(site, make_blob(random, *spot, 0.7 * radius, 0.4, 28), materials::oil());
  if (kind == 5) add_fallen_leaves(site, *spot, radius);
  if (kind == 6) add_flat_thing(site, rectangle(radius, 0.08), materials::varied(materials::white_paint(), random));
  if (kind == 7) add_flat_thing(site, rectangle(0.75 * radius, 0.6 * radius), pick_repair(random));
}

/// Whether somebody who walks straight on never comes near people or openings, nor near things while in sight.
bool is_way_clear(const Site& site, const Site::PasserBy& walker, double time_s) {
  constexpr double kStep = 0.1;
  constexpr double kInSight = 9.0;  // s
  double t = 0.0;
  while (t <= site.duration_s) {
    const Eigen::Vector2d p = walker.start + t * walker.velocity;
    const auto person_near = [&](const Site::PasserBy& other) { return (other.start + t * other.velocity - p).norm() < 0.9; };
    const auto opening_near = [&](const Polygon& opening) { return distance_to_polygon(opening, p) < 0.4; };
    const auto solid_near = [&](const Site::Spot& spot) { return spot.solid && (spot.center - p).norm() < spot.radius + 0.35; };
    if ((site.position_on_path(t) - p).norm() < 1.4 || std::ranges::any_of(site.passers_by, person_near)) return false;
    if (std::ranges::any_of(site.openings, opening_near)) return false;
    if (std::abs(t - time_s) < kInSight && std::ranges::any_of(site.spots, solid_near)) return false;
    t += kStep;
  }
  return true;
}

}  // namespace

void add_lamp_post(Site& site, const Eigen::Vector2d& foot) {
  const double height = site.random.uniform(3.0, 5.0);
  const Material steel = site.random.chance(0.5) ? materials::dark_steel() : materials::painted_steel();
  Mesh post = make_post(lift(foot, -0.1), site.random.uniform(0.04, 0.08), height + 0.1);
  append(post, make_ellipsoid(lift(foot, height), {0.25, 0.25, 0.18}));
  site.add(std::move(post), site.add_material(steel));
}

void add_bench(Site& site, const Eigen::Vector2d& center, double yaw) {
  Mesh planks;
  for (int i = 0; i < 4; ++i) append(planks, make_box({-0.7, -0.22 + 0.11 * i, 0.42}, {0.7, -0.13 + 0.11 * i, 0.46}));
  for (int i = 0; i < 2; ++i) append(planks, make_box({-0.7, 0.24, 0.6 + 0.16 * i}, {0.7, 0.27, 0.71 + 0.16 * i}));
  Mesh legs;
  for (const double x : {-0.6, 0.55}) {
    append(legs, make_box({x, -0.2, -0.1}, {x + 0.05, 0.24, 0.42}));
    append(legs, make_box({x, 0.2, 0.42}, {x + 0.05, 0.24, 0.85}));
  }
  site.add(moved(std::move(planks), yaw, lift(center, 0.0)),
           site.add_material(materials::varied(materials::wood(), site.random)));
  site.add(moved(std::move(legs), yaw, lift(center, 0.0)), site.add_material(materials::dark_steel()));
}

void add_bin(Site& site, const Eigen::Vector2d& center) {
  const Material steel = materials::colored(materials::painted_steel(), materials::random_color(site.random));
  site.add(make_post(lift(center, -0.1), 0.24, site.random.uniform(0.8, 1.05), 16), site.add_material(steel));
}

void add_person(Site& site, const Eigen::Vector2d& foot, double yaw, int body) {
  Random& random = site.random;
  const double scale = random.uniform(0.9, 1.08);
  const auto place = [&](Mesh mesh) {
    for (Eigen::Vector3f& p : mesh.vertices) p *= static_cast<float>(scale);
    return moved(std::move(mesh), yaw, lift(foot, 0.0));
  };
  Mesh trousers;
  Mesh jacket = make_ellipsoid({0.0, 0.0, 1.15}, {0.14, 0.22, 0.36}, 16);
  Mesh bare = make_ellipsoid({0.0, 0.0, 1.62}, {0.10, 0.085, 0.13}, 14);
  for (const double y : {-0.1, 0.1}) {
    const double stride = y > 0.0 ? 0.16 : -0.16;
    append(trousers, make_bar({stride, y, 0.05}, {0.0, y, 0.88}, 0.075));
    append(trousers, make_ellipsoid({stride + 0.06, y, 0.05}, {0.14, 0.05, 0.05}));
    append(jacket, make_bar({0.0, 2.3 * y, 1.38}, {-0.7 * stride, 2.6 * y, 0.85}, 0.05));
  }
  append(bare, make_bar({0.0, 0.0, 1.4}, {0.0, 0.0, 1.58}, 0.05));
  const auto clothes = [&] {
    return site.add_material(materials::colored(materials::cloth(), materials::random_color(random)));
  };
  site.add(place(std::move(trousers)), clothes(), 0, body);
  site.add(place(std::move(jacket)), clothes(), 0, body);
  site.add(place(std::move(bare)), site.add_material(materials::skin()), 0, body);
}

void add_passer_by(Site& site) {
  constexpr int kTries = 120;
  Random& random = site.random;
  for (int i = 0; i < kTries; ++i) {
    const double time = random.uniform(0.15, 0.9) * site.duration_s;
    const Eigen::Vector2d here = site.position_on_path(time);
    const Eigen::Vector2d ahead = site.position_on_path(time + 0.5) - here;
    if (ahead.norm() < 1e-6) continue;
    // Along the street or anyhow; where there are ramps, across, because bodies move evenly.
    const bool along = random.chance(0.5);
    const double side = random.sign();
    const double free_yaw = along ? 0.5 * (1.0 + side) * kPi + random.uniform(-0.03, 0.03) : random.uniform(-kPi, kPi);
    const double yaw = site.profile ? side * 0.5 * kPi : free_yaw;
    const Eigen::Vector2d velocity = random.uniform(0.8, 1.5) * Eigen::Vector2d(std::cos(yaw), std::sin(yaw));
    const Eigen::Vector2d aside(-ahead.y(), ahead.x());
    const Eigen::Vector2d meeting =
        here + random.uniform(2.2, 4.0) * ahead.normalized() + random.uniform(-3.0, 3.0) * aside.normalized();
    const Site::PasserBy walker{.start = meeting - time * velocity, .velocity = velocity};
    if (!is_way_clear(site, walker, time)) continue;
    site.passers_by.push_back(walker);
    add_person(site, walker.start, yaw, site.add_body({velocity.x(), velocity.y(), 0.0}));
    return;
  }
}

void add_stairs_up(Site& site, const Eigen::Vector2d& corner, const Eigen::Vector2d& size, int steps) {
  Mesh mesh;
  for (int i = 0; i < steps; ++i) {
    const double x = corner.x() + 0.3 * i;
    append(mesh, make_box({x, corner.y(), 0.165 * i - 0.3}, {corner.x() + size.x(), corner.y() + size.y(), 0.165 * (i + 1)}));
  }
  site.add(std::move(mesh), site.add_material(materials::varied(materials::concrete(), site.random)));
}

void add_railing(Site& site, const Line& line, double height) {
  Mesh mesh;
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Eigen::Vector2d step = line[i] - line[i - 1];
    const int posts = std::max(1, static_cast<int>(std::round(step.norm() / 1.1)));
    for (int k = 0; k <= posts; ++k)
      append(mesh, make_post(lift(line[i - 1] + step * k / posts, -0.1), 0.022, height + 0.1, 8));
    for (const double z : {0.5 * height, height}) append(mesh, make_bar(lift(line[i - 1], z), lift(line[i], z), 0.02, 8));
  }
  site.add(std::move(mesh), site.add_material(materials::dark_steel()));
}

void add_decoys(Site& site, const Eigen::AlignedBox2d& area, const DecoyCounts& counts) {
  for (int i = 0; i < counts.solids; ++i) add_solid(site, area);
  for (int i = 0; i < counts.flats; ++i) add_flat(site, area);
  for (int i = 0; i < counts.people; ++i) {
    if (site.random.chance(0.6)) {
      add_passer_by(site);
    } else if (const auto spot = site.take_spot(area, 0.4, true)) {
      add_person(site, *spot, site.random.uniform(0.0, 2.0 * kPi), -1);
    }
  }
}

}  // namespace brink::sim
