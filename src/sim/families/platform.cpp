#include <algorithm>

#include "sim/families/common.hpp"
#include "sim/families/decoys.hpp"
#include "sim/families/surroundings.hpp"

namespace brink::sim {
namespace {

constexpr double kBack = -6.0;  // y of the wall behind the platform, whose edge is y = 0

/// Where the tracks lie: x from begin to end, y from 0 to width.
struct Bed {
  double begin;
  double end;
  double width;
  double depth;
};

void add_track(Site& site, const Bed& bed, double middle, int id) {
  const int sleeper =
      site.add_material(materials::varied(site.random.chance(0.5) ? materials::concrete() : materials::wood(), site.random));
  const int iron = site.add_material(materials::varied(materials::iron(), site.random));
  Mesh sleepers;
  double x = bed.begin + 0.3;
  while (x < bed.end - 0.3) {
    append(sleepers, make_box({x, middle - 1.25, -bed.depth - 0.05}, {x + 0.25, middle + 1.25, -bed.depth + 0.06}));
    x += 0.65;
  }
  site.add(std::move(sleepers), sleeper, id);
  Mesh rails;
  for (const double y : {middle - 0.7525, middle + 0.7525}) {
    append(rails, make_box({bed.begin, y - 0.035, -bed.depth + 0.06}, {bed.end, y + 0.035, -bed.depth + 0.2}));
  }
  site.add(std::move(rails), iron, id);
}

void add_bed(Site& site, const Bed& bed, int tracks) {
  const Polygon rim = make_rectangle({bed.begin, 0.0}, {bed.end, bed.width});
  const int id = site.add_instance("platform_edge", bed.depth, rim);
  site.openings.push_back(rim);
  const int wall =
      site.add_material(materials::varied(site.random.chance(0.6) ? materials::concrete() : materials::brick(), site.random));
  add_shaft(site, rim, true, bed.depth, wall, id);
  const int ballast = site.add_material(materials::varied(materials::gravel(), site.random));
  site.add(moved(make_sheet({rim[0], rim[2]}, {2.0, 2.0}, {}, {}), 0.0, {0.0, 0.0, -bed.depth}), ballast, id);
  for (int i = 0; i < tracks; ++i) add_track(site, bed, bed.width * (i + 0.5) / tracks, id);
}

void add_stripe(Site& site, const Bed& bed, double low, double high, const Material& material) {
  const double z = site.next_flat_z();
  site.add(moved(make_sheet({Eigen::Vector2d(bed.begin, low), Eigen::Vector2d(bed.end, high)}, {4.0, 1.0}, {}, {}), 0.0,
                 {0.0, 0.0, z}),
           site.add_material(materials::varied(material, site.random)));
}

void add_canopy(Site& site, const Bed& bed) {
  Random& random = site.random;
  const int steel = site.add_material(materials::varied(materials::painted_steel(), random));
  const double height = random.uniform(3.0, 3.8);
  const double first = random.uniform(0.0, 5.0);
  double x = bed.begin + first;
  while (x < bed.end) {
    site.add(make_post({x, -4.4, -0.1}, 0.11, height + 0.1), steel);
    site.take({x, -4.4}, 0.15, true);
    x += 5.0;
  }
  const double reach = random.uniform(-2.5, -1.0);
  const double from = std::lerp(bed.begin, bed.end, random.uniform(0.0, 0.3));
  const double to = std::lerp(bed.begin, bed.end, random.uniform(0.7, 1.0));
  site.add(make_box({from, kBack, height}, {to, reach, height + 0.15}), steel);
}

/// The far side: a wall with something green behind it, or another platform with houses behind.
void add_far_side(Site& site, const Bed& bed) {
  if (site.random.chance(0.5)) {
    const int wall = site.add_material(materials::varied(materials::concrete(), site.random));
    const double height = site.random.uniform(1.2, 3.0);
    site.add(make_box({bed.begin, bed.width, -0.05}, {bed.end, bed.width + 0.3, height}), wall);
    add_hedge(site, {bed.end, bed.width + 1.0}, {bed.begin, bed.width + 1.0});
    double x = bed.begin + 2.0;
    while (x < bed.end) {
      add_tree(site, {x, bed.width + 2.0});
      x += site.random.uniform(3.0, 6.0);
    }
    return;
  }
  const int ground = add_pavement_material(site);
  const double back = bed.width + 4.0;
  site.add(make_sheet({Eigen::Vector2d(bed.begin, bed.width), Eigen::Vector2d(bed.end, back)}, {2.0, 2.0}, {}, {}), ground);
  double x = bed.begin + 3.0;
  while (x < bed.end) {
    const Eigen::Vector2d place(x, bed.width + site.random.uniform(1.5, 3.0));
    if (site.random.chance(0.4))
      add_bench(site, place, 0.0);
    else if (site.random.chance(0.5))
      add_lamp_post(site, place);
    else
      add_person(site, place, site.random.uniform(0.0, 6.0), -1);
    x += site.random.uniform(4.0, 9.0);
  }
  add_house_row(site, {bed.end, back}, {bed.begin, back});
}

}  // namespace

void build_platform(Site& site) {
  Random& random = site.random;
  const double run = std::clamp(site.path_length(), 8.0, 40.0);
  const int tracks = random.integer(1, 2);
  const Bed bed{.begin = -run - 8.0, .end = 24.0, .width = 4.2 * tracks, .depth = random.uniform(0.9, 1.1)};
  add_bed(site, bed, tracks);
  const double lane = random.uniform(-2.0, -1.3);
  const double end = random.uniform(0.3, 1.2);
  site.set_path({{-run, lane - 0.5}, {-0.5 * run - 1.0, lane}, {end - 1.6, lane}, {end - 0.4, lane - 0.9}, {end, -0.92}},
                {{end + 1.3, -1.7}, {end + 0.3, -3.3}, {-run, -3.3}});

  add_stripe(site, bed, -1.0, -0.6, materials::tactile());
  if (random.chance(0.7)) add_stripe(site, bed, -0.14, -0.04, materials::white_paint());
  add_house_row(site, {bed.begin, kBack}, {bed.end, kBack});
  add_house_row(site, {bed.end, kBack}, {bed.end, bed.width + 4.0});
  add_house_row(site, {bed.begin, bed.width + 4.0}, {bed.begin, kBack});
  add_far_side(site, bed);
  if (random.chance(0.5)) add_canopy(site, bed);
  const Eigen::AlignedBox2d inner(Eigen::Vector2d(bed.begin + 1.0, kBack + 0.4), Eigen::Vector2d(bed.end - 1.0, -0.5));
  add_decoys(site, inner, {.solids = random.integer(5, 8), .flats = random.integer(4, 7), .people = 3});
  site.add(make_sheet({Eigen::Vector2d(bed.begin, kBack), Eigen::Vector2d(bed.end, 0.0)}, {1.0, 1.0}, {}, {}),
           add_pavement_material(site));
}

}  // namespace brink::sim
