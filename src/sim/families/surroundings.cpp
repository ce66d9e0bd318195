#include "sim/families/surroundings.hpp"

#include <algorithm>
#include <cmath>

namespace brink::sim {
namespace {

constexpr double kFoundation = 1.5;  // m that walls reach below the ground

/// A pane on a wall: s along it, z up, standing out a little.
struct Facade {
  Eigen::Vector2d origin;
  Eigen::Vector2d along;
  Eigen::Vector2d out;

  [[nodiscard]] Mesh pane(double s, double width, double bottom, double top, double proud) const {
    const Eigen::Vector2d corner = origin + s * along + proud * out;
    return make_pane({corner.x(), corner.y(), bottom}, {width * along.x(), width * along.y(), 0.0}, {0.0, 0.0, top - bottom});
  }
};

Material pick_house(Random& random) {
  const int kind = random.integer(0, 4);
  if (kind == 0) return materials::white_wall();
  if (kind == 1) return materials::varied(materials::brick(), random);
  if (kind == 2) return materials::varied(materials::concrete(), random);
  return materials::varied(materials::plaster(), random);
}

void add_windows(Site& site, const Facade& facade, double width, double height) {
  Random& random = site.random;
  const int glass = site.add_material(materials::dark_window());
  const int frame = site.add_material(materials::varied(materials::white_paint(), random));
  const double size = random.uniform(0.9, 1.4);
  const double pitch = size + random.uniform(0.7, 1.5);
  const int columns = static_cast<int>((width - 0.6) / pitch);
  const double margin = 0.5 * (width - (columns - 1) * pitch - size);
  const int door = random.integer(0, std::max(0, columns - 1));
  double sill = random.uniform(0.6, 1.1);
  bool on_street = true;  // where the door is
  while (sill + 1.8 < height) {
    for (int i = 0; i < columns; ++i) {
      const double s = margin + i * pitch;
      const bool is_door = on_street && i == door;
      const double bottom = is_door ? 0.0 : sill;
      site.add(facade.pane(s - 0.07, size + 0.14, bottom - 0.07, sill + 1.47, 0.02), frame);
      site.add(facade.pane(s, size, bottom, sill + 1.4, 0.03), glass);
    }
    sill += 2.9;
    on_street = false;
  }
}

void add_awning(Site& site, const Facade& facade, double width) {
  const Eigen::Vector2d a = facade.origin + 0.5 * facade.along;
  const Eigen::Vector2d out = site.random.uniform(0.9, 1.6) * facade.out;
  const Material cloth = materials::colored(materials::cloth(), materials::random_color(site.random));
  site.add(make_pane({a.x(), a.y(), 3.0}, {(width - 1.0) * facade.along.x(), (width - 1.0) * facade.along.y(), 0.0},
                     {out.x(), out.y(), -0.5}),
           site.add_material(cloth));
}

void add_house(Site& site, const Facade& facade, double width) {
  const double height = site.random.uniform(4.5, 9.0);
  const int wall = site.add_material(pick_house(site.random));
  site.add(facade.pane(0.0, width, -kFoundation, height, 0.0), wall);
  const Facade left{.origin = facade.origin, .along = -facade.out, .out = -facade.along};
  const Facade right{.origin = facade.origin + width * facade.along, .along = -facade.out, .out = facade.along};
  for (const Facade& gable : {left, right}) site.add(gable.pane(0.0, 6.0, -kFoundation, height, 0.0), wall);
  const Eigen::Vector2d back = 6.0 * facade.out;
  site.add(make_pane({facade.origin.x(), facade.origin.y(), height}, {width * facade.along.x(), width * facade.along.y(), 0.0},
                     {-back.x(), -back.y(), 0.0}),
           wall);
  add_windows(site, facade, width, height);
  const int plinth = site.add_material(materials::varied(materials::concrete(), site.random));
  if (site.random.chance(0.6)) site.add(facade.pane(0.0, width, -kFoundation, site.random.uniform(0.3, 0.5), 0.04), plinth);
  if (site.random.chance(0.35)) add_awning(site, facade, width);
}

}  // namespace

void add_house_row(Site& site, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const double length = (to - from).norm();
  const Eigen::Vector2d along = (to - from) / length;
  double s = 0.0;
  while (s < length) {
    double width = std::min(site.random.uniform(5.0, 9.0), length - s);
    if (length - s - width < 3.0) width = length - s;
    add_house(site, {.origin = from + s * along, .along = along, .out = {-along.y(), along.x()}}, width);
    s += width;
  }
}

void add_hedge(Site& site, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const int green = site.add_material(materials::varied(materials::leaves(), site.random));
  const Eigen::Vector2d along = (to - from).normalized();
  const Eigen::Vector2d out(-along.y(), along.x());
  const double height = site.random.uniform(1.4, 3.0);
  const double length = (to - from).norm();
  const Facade face{.origin = from, .along = along, .out = out};
  site.add(face.pane(0.0, length, -kFoundation, height, -0.3), green);
  Mesh leaves;
  double s = 0.5;
  while (s < length) {
    const Eigen::Vector2d p = from + s * along - 0.25 * out;
    append(leaves, make_leaves(site.random, {p.x(), p.y(), 0.5 * height}, {0.7, 0.3, 0.55 * height}, 60, 0.13));
    s += 1.0;
  }
  site.add(std::move(leaves), green);
}

void add_tree(Site& site, const Eigen::Vector2d& foot) {
  Random& random = site.random;
  const double trunk = random.uniform(2.6, 3.6);
  const double crown = random.uniform(1.2, 2.2);
  site.add(make_post({foot.x(), foot.y(), -0.2}, random.uniform(0.09, 0.2), trunk + 0.6 * crown),
           site.add_material(materials::varied(materials::bark(), random)));
  const Eigen::Vector3d center(foot.x(), foot.y(), trunk + 0.8 * crown);
  const int green = site.add_material(materials::varied(materials::leaves(), random));
  site.add(make_leaves(random, center, {crown, crown, 0.8 * crown}, 700, 0.22), green);
}

void add_surroundings(Site& site, const Eigen::AlignedBox2d& area) {
  const Polygon corners = make_rectangle(area.min(), area.max());
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d& from = corners[i];
    const Eigen::Vector2d& to = corners[(i + 1) % 4];
    if (site.random.chance(0.65)) {
      add_house_row(site, from, to);
      continue;
    }
    add_hedge(site, from, to);
    const Eigen::Vector2d step = (to - from).normalized();
    const Eigen::Vector2d out(-step.y(), step.x());
    double s = site.random.uniform(1.0, 3.0);
    while (s < (to - from).norm()) {
      add_tree(site, from + s * step - out);
      s += site.random.uniform(3.0, 5.5);
    }
  }
}

void add_ground_around(Site& site, const Eigen::AlignedBox2d& outer, const Eigen::AlignedBox2d& inner, int material) {
  const Eigen::Vector2d& low = outer.min();
  const Eigen::Vector2d& high = outer.max();
  const Eigen::Vector2d& in_low = inner.min();
  const Eigen::Vector2d& in_high = inner.max();
  const std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> strips{{low, {high.x(), in_low.y()}},
                                                                        {{low.x(), in_high.y()}, high},
                                                                        {{low.x(), in_low.y()}, {in_low.x(), in_high.y()}},
                                                                        {{in_high.x(), in_low.y()}, {high.x(), in_high.y()}}};
  for (const auto& [from, to] : strips) {
    if ((to - from).minCoeff() > 0.0) site.add(make_sheet({from, to}, {1.0, 1.0}, {}, {}), material);
  }
}

}  // namespace brink::sim
