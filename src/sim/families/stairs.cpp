#include <algorithm>

#include "sim/families/common.hpp"
#include "sim/families/decoys.hpp"
#include "sim/families/surroundings.hpp"

namespace brink::sim {
namespace {

/// Stairs that go down along +x from the edge x = 0; y = 0 is their middle.
struct Stairs {
  int steps;
  double rise;
  double tread;
  double width;
  double landing;

  [[nodiscard]] double depth() const { return steps * rise; }
  [[nodiscard]] double length() const { return (steps - 1) * tread + landing; }
};

Stairs draw_stairs(Random& random) {
  return {.steps = random.integer(7, 12),
          .rise = random.uniform(0.15, 0.19),
          .tread = random.uniform(0.27, 0.33),
          .width = random.uniform(2.4, 4.0),
          .landing = random.uniform(1.3, 2.2)};
}

/// One half of the stairs, on the side of positive (1) or negative (-1) y.
void add_flight(Site& site, const Stairs& stairs, double side, int stone, int wall, bool nosings) {
  const double half = 0.5 * stairs.width;
  const double low = side > 0.0 ? 0.0 : -half;
  const int id = site.add_instance("stairs_down", stairs.depth(), make_rectangle({0.0, low}, {stairs.length(), low + half}));
  site.add(moved(make_steps(stairs.steps, stairs.rise, stairs.tread, half, stairs.landing), 0.0, {0.0, low, 0.0}), stone, id);
  add_shaft(site, {{0.0, side * half}, {stairs.length(), side * half}, {stairs.length(), 0.0}}, false, stairs.depth(), wall,
            id);
  const double door = std::min(2.0, stairs.depth() - 0.1);
  site.add(make_pane({stairs.length() - 0.01, low + 0.15, -stairs.depth()}, {0.0, half - 0.3, 0.0}, {0.0, 0.0, door}),
           site.add_material(materials::dark_window()), id);
  if (!nosings) return;
  Mesh strips;
  for (int i = 1; i < stairs.steps; ++i) {
    append(strips, make_pane({(i - 1) * stairs.tread + stairs.tread - 0.05, low, -i * stairs.rise + 0.002}, {0.05, 0.0, 0.0},
                             {0.0, half, 0.0}));
  }
  site.add(std::move(strips), site.add_material(materials::white_paint()), id);
}

/// Dark posts on every second step along the middle and a bar on them.
void add_handrail(Site& site, const Stairs& stairs) {
  constexpr double kHeight = 0.95;
  Mesh rail;
  Eigen::Vector3d last_top(-0.12, 0.0, kHeight);
  append(rail, make_post({-0.12, 0.0, -0.1}, 0.03, kHeight + 0.1));
  for (int i = 1; i <= stairs.steps; i += 2) {
    const Eigen::Vector3d foot((i - 0.5) * stairs.tread, 0.0, -i * stairs.rise);
    const Eigen::Vector3d top = foot + Eigen::Vector3d(0.0, 0.0, kHeight);
    append(rail, make_post(foot, 0.03, kHeight));
    append(rail, make_bar(last_top, top, 0.025));
    last_top = top;
  }
  site.add(std::move(rail), site.add_material(materials::dark_steel()));
}

/// Beside the stairs against their direction, round, and down towards one flight.
void set_path_beside(Site& site, const Stairs& stairs, double side, double target) {
  const double beside = side * (0.5 * stairs.width + site.random.uniform(0.8, 1.1));
  const double beyond = side * (0.5 * stairs.width + 2.6);
  const double start = stairs.length() + 5.0;
  site.set_path({{start, beside}, {-1.8, beside}, {-3.9, 0.8 * beside}, {-4.2, target}, {-0.9, target}},
                {{-1.1, target + 1.1 * side},
                 {-2.5, target + 1.3 * side},
                 {-3.2, beyond},
                 {start, beyond},
                 {start + 1.0, 0.5 * (beside + beyond)}});
}

/// Across in front of the stairs, round, and down towards one flight.
void set_path_across(Site& site, const Stairs& stairs, double side, double target) {
  const double start = side * (0.5 * stairs.width + 5.5);
  const double far = -side * 0.5 * stairs.width;
  site.set_path(
      {{-1.4, start}, {-1.5, far}, {-3.2, 1.4 * far}, {-4.4, target}, {-0.9, target}},
      {{-1.1, target + 1.1 * side}, {-2.5, target + 1.3 * side}, {-4.6, side * 2.6}, {-4.6, start}, {-2.8, start + side}});
}

}  // namespace

void build_stairs(Site& site) {
  Random& random = site.random;
  const Stairs stairs = draw_stairs(random);
  const double half = 0.5 * stairs.width;
  const int stone = site.add_material(materials::varied(materials::concrete(), random));
  const int wall =
      site.add_material(materials::varied(random.chance(0.5) ? materials::concrete() : materials::brick(), random));
  const bool nosings = random.chance(0.4);
  for (const double side : {1.0, -1.0}) add_flight(site, stairs, side, stone, wall, nosings);
  add_handrail(site, stairs);
  site.openings.push_back(make_rectangle({0.0, -half}, {stairs.length(), half}));

  const double side = random.sign();
  const double target = random.sign() * 0.5 * half;
  if (random.chance(0.6)) {
    set_path_beside(site, stairs, side, target);
  } else {
    set_path_across(site, stairs, side, target);
  }
  const double far_y = -side * (half + 0.08);
  if (random.chance(0.5)) {
    add_railing(site, {{0.1, far_y}, {stairs.length() + 0.08, far_y}, {stairs.length() + 0.08, side * half}}, 1.0);
  }
  if (random.chance(0.5)) {
    const double z = site.next_flat_z();
    site.add(moved(make_patch(make_rectangle({-0.75, -half}, {-0.4, half}), 0.0), 0.0, {0.0, 0.0, z}),
             site.add_material(materials::varied(materials::tactile(), random)));
  }
  const Eigen::AlignedBox2d area(Eigen::Vector2d(-8.5, -9.0), Eigen::Vector2d(stairs.length() + 9.0, 9.0));
  add_surroundings(site, area);
  const Eigen::AlignedBox2d inner(area.min().array() + 1.5, area.max().array() - 1.5);
  add_decoys(site, inner, {.solids = random.integer(4, 7), .flats = random.integer(4, 7), .people = 2});
  site.add(make_sheet(area, {1.0, 1.0}, site.openings, {}), add_pavement_material(site));
}

}  // namespace brink::sim
