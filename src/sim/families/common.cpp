#include "sim/families/common.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace brink::sim {
namespace {

constexpr double kPathClearance = 0.55;     // of solid things from the path, m
constexpr double kSpare = 0.25;             // of path beyond what the walk needs, m
constexpr double kOpeningClearance = 0.25;  // of anything from a rim, m

/// Every corner cut into two: nobody turns on the spot without stopping.
Line soften(const Line& line) {
  constexpr double kCut = 0.7;  // m before and after a corner
  Line softer{line.front()};
  for (std::size_t i = 1; i + 1 < line.size(); ++i) {
    const Eigen::Vector2d before = line[i - 1] - line[i];
    const Eigen::Vector2d after = line[i + 1] - line[i];
    const double cut = std::min({kCut, 0.4 * before.norm(), 0.4 * after.norm()});
    softer.emplace_back(line[i] + cut * before.normalized());
    softer.emplace_back(line[i] + cut * after.normalized());
  }
  softer.push_back(line.back());
  return softer;
}

/// How much shorter a walk round a corner is than the corner: heads are turned over about a metre (HeadMotion rounds with a
/// Gaussian of 0.4 m, which gives 0.23 m times 1 - cos of a small turn and 0.32 m of a full one).
double rounding_loss(const Eigen::Vector2d& before, const Eigen::Vector2d& corner, const Eigen::Vector2d& after) {
  constexpr double kLoss = 0.33;  // m
  return kLoss * (1.0 - (corner - before).normalized().dot((after - corner).normalized()));
}

double walked_length(const Line& line) {
  double length = line_length(line);
  for (std::size_t i = 2; i < line.size(); ++i) length -= rounding_loss(line[i - 2], line[i - 1], line[i]);
  return length;
}

/// The last part of a line, so long that walking it with rounded corners takes `length` metres.
Line cut_to_end(const Line& line, double length) {
  Line kept{line.back()};
  for (std::size_t i = line.size() - 1; i > 0 && length > 0.0; --i) {
    const Eigen::Vector2d step = line[i - 1] - line[i];
    const double share = std::min(1.0, length / step.norm());
    kept.emplace_back(line[i] + share * step);
    length -= step.norm();
    if (i > 1) length += rounding_loss(line[i - 2], line[i - 1], line[i]);
  }
  std::ranges::reverse(kept);
  return kept;
}

double hash_unit(int x, int y, int seed) {
  auto h = static_cast<std::uint32_t>(x) * 0x8da6b343U ^ static_cast<std::uint32_t>(y) * 0xd8163841U ^
           static_cast<std::uint32_t>(seed) * 0xcb1ab31fU;
  h = (h ^ (h >> 15U)) * 0x2c1b3c6dU;
  h = (h ^ (h >> 12U)) * 0x297a2d39U;
  return static_cast<double>(h ^ (h >> 15U)) / 4294967296.0;
}

/// Smooth noise of one wavelength, -1..1.
double value_noise(double x, double y, int seed) {
  const int column = static_cast<int>(std::floor(x));
  const int row = static_cast<int>(std::floor(y));
  const auto ease = [](double t) { return t * t * (3.0 - 2.0 * t); };
  const double u = ease(x - column);
  const double v = ease(y - row);
  const double near = std::lerp(hash_unit(column, row, seed), hash_unit(column + 1, row, seed), u);
  const double far = std::lerp(hash_unit(column, row + 1, seed), hash_unit(column + 1, row + 1, seed), u);
  return 2.0 * std::lerp(near, far, v) - 1.0;
}

}  // namespace

int Site::add_material(const Material& material) {
  scene.materials.push_back(material);
  return static_cast<int>(scene.materials.size()) - 1;
}

int Site::add_body(const Eigen::Vector3d& velocity) {
  scene.bodies.push_back({velocity.cast<float>()});
  return static_cast<int>(scene.bodies.size()) - 1;
}

void Site::add(Mesh mesh, int material, int obstacle, int body) {
  mesh.material = material;
  mesh.obstacle = obstacle;
  mesh.body = body;
  scene.meshes.push_back(std::move(mesh));
}

int Site::add_instance(const std::string& type, double depth_m, const Polygon& rim) {
  Instance instance{.id = static_cast<int>(scene.instances.size()) + 1, .type = type, .depth_m = depth_m, .opening = {}};
  for (const Eigen::Vector2d& p : rim) instance.opening.emplace_back(p.x(), p.y(), 0.0);
  scene.instances.push_back(std::move(instance));
  return scene.instances.back().id;
}

void Site::set_path(const Line& approach, const Line& way_back) {
  Line whole = approach;
  while (walked_length(soften(whole)) < path_length() + kSpare) {
    whole.insert(whole.begin(), way_back.begin(), way_back.end());
    whole.insert(whole.begin(), approach.begin(), approach.end());
  }
  path = cut_to_end(soften(whole), path_length() + kSpare);
}

Eigen::Vector2d Site::position_on_path(double time_s) const {
  double left = speed_mps * time_s;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Eigen::Vector2d step = path[i] - path[i - 1];
    if (left <= step.norm()) return path[i - 1] + step.normalized() * left;
    left -= step.norm();
  }
  return path.back();
}

bool Site::is_clear(const Eigen::Vector2d& center, double radius, bool solid) const {
  if (solid && distance_to_line(path, center) < radius + kPathClearance) return false;
  const auto near_opening = [&](const Polygon& opening) {
    return distance_to_polygon(opening, center) < radius + kOpeningClearance;
  };
  const auto near_thing = [&](const Spot& spot) { return (spot.center - center).norm() < spot.radius + radius; };
  return std::ranges::none_of(openings, near_opening) && std::ranges::none_of(spots, near_thing);
}

std::optional<Eigen::Vector2d> Site::take_spot(const Eigen::AlignedBox2d& area, double radius, bool solid) {
  constexpr int kTries = 60;
  for (int i = 0; i < kTries; ++i) {
    const Eigen::Vector2d base = position_on_path(random.uniform(0.0, duration_s + 2.0));
    const double reach = solid ? radius + kPathClearance + 3.0 : 2.0;
    const Eigen::Vector2d center = base + Eigen::Vector2d(random.uniform(-reach, reach), random.uniform(-reach, reach));
    const Eigen::AlignedBox2d inner(area.min().array() + radius, area.max().array() - radius);
    if (!inner.contains(center) || !is_clear(center, radius, solid)) continue;
    take(center, radius, solid);
    return center;
  }
  return std::nullopt;
}

double Site::next_flat_z() { return 0.0015 + 0.0001 * static_cast<double>(flat_things++); }

Line weave_past(const Eigen::Vector2d& start, const std::vector<Hazard>& hazards) {
  Line line{start};
  for (const auto& [center, half, aside_y] : hazards) {
    line.emplace_back(center.x() - half.x() - 1.8, std::lerp(start.y(), center.y(), 0.8));
    line.emplace_back(center.x() - half.x() - 0.2, aside_y);
    line.emplace_back(center.x() + half.x() + 0.2, aside_y);
  }
  return line;
}

int add_pavement_material(Site& site) {
  const int kind = site.random.integer(0, 3);
  const Material material = kind == 0   ? materials::asphalt()
                            : kind == 1 ? materials::concrete()
                            : kind == 2 ? materials::cobbles()
                                        : materials::paving();
  return site.add_material(materials::varied(material, site.random));
}

void add_shaft(Site& site, const Line& line, bool closed, double depth, int material, int obstacle) {
  site.add(make_wall(line, closed, -depth, 0.0), material, obstacle);
}

HeightFunction make_rough_height(const Site& site, const Eigen::AlignedBox2d& area, double amplitude, int seed) {
  return [openings = site.openings, spots = site.spots, area, amplitude, seed](double x, double y) {
    constexpr double kFade = 0.35;    // m from level to fully rough
    constexpr double kCollar = 0.15;  // m around openings and things that stay level
    const Eigen::Vector2d p(x, y);
    double distance = std::min({x - area.min().x(), area.max().x() - x, y - area.min().y(), area.max().y() - y});
    for (const Polygon& opening : openings) distance = std::min(distance, distance_to_polygon(opening, p) - kCollar);
    for (const Site::Spot& spot : spots) distance = std::min(distance, (spot.center - p).norm() - spot.radius - kCollar);
    const double share = std::clamp(distance / kFade, 0.0, 1.0);
    const double coarse = value_noise(x / 1.3, y / 1.3, seed);
    const double fine = value_noise(x / 0.35, y / 0.35, seed + 1);
    return share * amplitude * (0.65 * coarse + 0.35 * fine);
  };
}

Light make_light(Random& random, Weather weather) {
  Light light;
  const double elevation = random.uniform(25.0, 60.0) * std::numbers::pi / 180.0;
  const double azimuth = random.uniform(-std::numbers::pi, std::numbers::pi);
  light.to_sun =
      Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation))
          .cast<float>();
  if (weather == Weather::sunny) {
    const auto level = static_cast<float>(std::numbers::pi * random.uniform(2.2, 3.8));  // times the sky's irradiance
    light.sky = {0.80F, 0.95F, 1.20F};
    light.sun = level * Eigen::Vector3f(1.06F, 1.0F, 0.88F);
    light.sun_radius_deg = random.chance(0.6) ? 0.27F : static_cast<float>(random.uniform(0.5, 2.0));
  } else if (weather == Weather::overcast) {
    const auto level = static_cast<float>(random.uniform(0.4, 0.9));
    light.sky = level * Eigen::Vector3f(0.98F, 1.0F, 1.03F);
  } else {
    const auto level = static_cast<float>(random.uniform(0.008, 0.025));
    light.sky = level * Eigen::Vector3f(0.80F, 0.95F, 1.25F);
  }
  return light;
}

}  // namespace brink::sim
