#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/families/common.hpp"

namespace brink::sim {
namespace {

/// A family with how it is built and how fast people walk in it.
struct Recipe {
  Family family;
  void (*build)(Site&);
  double slowest_mps;
  double fastest_mps;
  std::uint32_t salt;  ///< keeps the families' random numbers apart
};

constexpr std::array<Recipe, 7> kRecipes{{
    {{"stairs", "beside stairs down and then towards them, a handrail in the middle"}, build_stairs, 0.6, 1.4, 0U},
    {{"platform", "along the edge of a railway platform and then towards it"}, build_platform, 0.6, 1.4, 1U},
    {{"manholes", "rough ground with two open manholes and a lower area or trench"}, build_manholes, 0.6, 1.4, 2U},
    {{"street", "a pavement with potholes, a trench, cellar stairs and a kerb down"}, build_street, 0.6, 1.4, 3U},
    {{"control", "nothing to warn of, but much that looks like it"}, build_control, 0.6, 1.4, 4U},
    {{"motion", "25 m at 1 m/s with much looking around, nothing to warn of"}, build_motion, 1.0, 1.0, 5U},
    {{"crowd", "among people who take about a third of the picture, nothing to warn of"}, build_crowd, 0.9, 1.2, 7U},
}};

const Recipe& find_recipe(const std::string& name) {
  const auto* const found =
      std::ranges::find(kRecipes, name, [](const Recipe& recipe) { return std::string(recipe.family.name); });
  if (found != kRecipes.end()) return *found;
  std::vector<std::string> names;
  names.reserve(kRecipes.size());
  for (const Recipe& recipe : kRecipes) names.emplace_back(recipe.family.name);
  throw std::invalid_argument(fmt::format("family = {}, must be {}", name, fmt::join(names, ", ")));
}

Weather pick_weather(Random& random, const std::string& name) {
  const double draw = random.uniform(0.0, 1.0);  // drawn in any case: the scene is the same under any given weather
  if (name.empty()) return draw < 0.5 ? Weather::sunny : draw < 0.82 ? Weather::overcast : Weather::dusk;
  if (name == "sunny") return Weather::sunny;
  if (name == "overcast") return Weather::overcast;
  if (name == "dusk") return Weather::dusk;
  throw std::invalid_argument(fmt::format("light = {}, must be sunny, overcast or dusk", name));
}

Walk make_walk(Site& site, bool looking_around, int seed) {
  Random& random = site.random;
  Walk walk;
  walk.waypoints = site.path;
  walk.speed_mps = site.speed_mps;
  walk.camera_height_m = random.uniform(1.5, 1.8);
  walk.pitch_deg = random.uniform(15.0, 40.0);
  walk.step_length_m = random.uniform(0.55, 0.75);
  walk.bob_m = random.uniform(0.012, 0.028);
  walk.sway_m = random.uniform(0.012, 0.028);
  walk.roll_deg = random.uniform(0.5, 1.5);
  walk.pitch_swing_deg = random.uniform(0.5, 1.5);
  walk.yaw_swing_deg = random.uniform(0.8, 2.0);
  walk.look_yaw_deg = looking_around ? 45.0 : random.uniform(5.0, 14.0);
  walk.look_pitch_deg = looking_around ? 12.0 : random.uniform(2.0, 6.0);
  walk.look_period_s = looking_around ? 3.5 : random.uniform(4.0, 7.0);
  walk.seed = seed;
  return walk;
}

/// Tilts the ground (a walker's start may slope and bank), adds the site's ramps, and makes the start of the path the origin
/// with x along its first leg. Vertical things stay vertical, depths stay what they are.
void settle(Site& site) {
  const double along = std::tan(site.random.uniform(-2.5, 2.5) * std::numbers::pi / 180.0);
  const double across = std::tan(site.random.uniform(-2.0, 2.0) * std::numbers::pi / 180.0);
  const Eigen::Vector2d start = site.path[0];
  const Eigen::Vector2d leg = site.path[1] - start;
  const Eigen::Rotation2Dd turn(-std::atan2(leg.y(), leg.x()));
  const double base = site.profile ? site.profile(start.x(), start.y()) : 0.0;
  const auto settled = [&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
    const Eigen::Vector2d flat = p.head<2>() - start;
    const double ramp = site.profile ? site.profile(p.x(), p.y()) - base : 0.0;
    const Eigen::Vector2d turned = turn * flat;
    return {turned.x(), turned.y(), p.z() + along * flat.x() + across * flat.y() + ramp};
  };
  for (Mesh& mesh : site.scene.meshes) {
    for (Eigen::Vector3f& p : mesh.vertices) p = settled(p.cast<double>()).cast<float>();
  }
  for (Instance& instance : site.scene.instances) {
    for (Eigen::Vector3d& p : instance.opening) p = settled(p);
  }
  for (Body& body : site.scene.bodies) {
    const Eigen::Vector2d v = body.velocity.head<2>().cast<double>();
    const Eigen::Vector2d turned = turn * v;
    body.velocity = Eigen::Vector3d(turned.x(), turned.y(), along * v.x() + across * v.y()).cast<float>();
  }
  for (Eigen::Vector2d& p : site.path) p = turn * Eigen::Vector2d(p - start);
}

}  // namespace

const std::vector<Family>& families() {
  static const std::vector<Family> all = [] {
    std::vector<Family> list;
    list.reserve(kRecipes.size());
    for (const Recipe& recipe : kRecipes) list.push_back(recipe.family);
    return list;
  }();
  return all;
}

World make_world(const std::string& family, int seed, double duration_s, const std::string& weather) {
  const Recipe& recipe = find_recipe(family);
  if (!(duration_s > 0.0) || !std::isfinite(duration_s)) {
    throw std::invalid_argument(fmt::format("duration_s = {}, must be positive", duration_s));
  }
  Random random(static_cast<std::uint32_t>(seed) * 2654435761U + recipe.salt * 40503U + 1U);
  const Weather chosen = pick_weather(random, weather);
  const double speed = random.uniform(recipe.slowest_mps, recipe.fastest_mps);
  Site site{.random = random, .speed_mps = speed, .duration_s = duration_s, .weather = chosen};
  recipe.build(site);
  settle(site);
  site.scene.light = make_light(site.random, chosen);
  World world{.scene = {}, .walk = make_walk(site, family == "motion", seed)};
  world.scene = std::move(site.scene);
  world.scene.validate();
  return world;
}

}  // namespace brink::sim
