#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "brink/sim/scene.hpp"
#include "expect_error.hpp"
#include "sim/polygon.hpp"

namespace brink::sim {
namespace {

constexpr double kFps = 15.0;
constexpr int kNotLabelled = 255;

const std::map<std::string, int>& frames_of() {
  static const std::map<std::string, int> frames{{"stairs", 213},  {"platform", 300}, {"manholes", 277}, {"street", 300},
                                                 {"control", 300}, {"motion", 376},   {"crowd", 376}};
  return frames;
}

/// A surface met by a vertical line.
struct Crossing {
  double z;
  int obstacle;
};

/// All standing surfaces over a place, topmost first: brute force, so that it shares nothing with the renderer.
std::vector<Crossing> cross_vertically(const Scene& scene, const Eigen::Vector2d& place) {
  std::vector<Crossing> crossings;
  for (const Mesh& mesh : scene.meshes) {
    if (mesh.body >= 0) continue;
    for (const Eigen::Vector3i& t : mesh.triangles) {
      const Eigen::Vector3d a = mesh.vertices[static_cast<std::size_t>(t[0])].cast<double>();
      const Eigen::Vector3d b = mesh.vertices[static_cast<std::size_t>(t[1])].cast<double>();
      const Eigen::Vector3d c = mesh.vertices[static_cast<std::size_t>(t[2])].cast<double>();
      if (std::max({a.x(), b.x(), c.x()}) < place.x() || std::min({a.x(), b.x(), c.x()}) > place.x()) continue;
      if (std::max({a.y(), b.y(), c.y()}) < place.y() || std::min({a.y(), b.y(), c.y()}) > place.y()) continue;
      Eigen::Matrix2d sides;
      sides << (b - a).head<2>(), (c - a).head<2>();
      if (std::abs(sides.determinant()) < 1e-12) continue;
      const Eigen::Vector2d share = sides.inverse() * (place - a.head<2>());
      if (share.minCoeff() < 0.0 || share.sum() > 1.0) continue;
      crossings.push_back({a.z() + share.x() * (b - a).z() + share.y() * (c - a).z(), mesh.obstacle});
    }
  }
  std::ranges::sort(crossings, std::greater(), &Crossing::z);
  return crossings;
}

/// z = plane . (x, y, 1) through an instance's rim.
Eigen::Vector3d fit_rim(const Instance& instance) {
  Eigen::MatrixXd places(static_cast<Eigen::Index>(instance.opening.size()), 3);
  Eigen::VectorXd heights(places.rows());
  for (Eigen::Index i = 0; i < places.rows(); ++i) {
    const Eigen::Vector3d& p = instance.opening[static_cast<std::size_t>(i)];
    places.row(i) << p.x(), p.y(), 1.0;
    heights[i] = p.z();
  }
  const Eigen::Vector3d plane = places.colPivHouseholderQr().solve(heights);
  EXPECT_LT((places * plane - heights).cwiseAbs().maxCoeff(), 1e-3) << "the rim is not flat";
  return plane;
}

double height_on(const Eigen::Vector3d& plane, const Eigen::Vector2d& p) {
  return plane.dot(Eigen::Vector3d(p.x(), p.y(), 1.0));
}

Polygon outline_of(const Instance& instance) {
  Polygon outline;
  for (const Eigen::Vector3d& p : instance.opening) outline.emplace_back(p.head<2>());
  return outline;
}

/// Places along the path every `step` metres.
std::vector<Eigen::Vector2d> sample_path(const Walk& walk, double step) {
  std::vector<Eigen::Vector2d> places;
  for (std::size_t i = 1; i < walk.waypoints.size(); ++i) {
    const Eigen::Vector2d leg = walk.waypoints[i] - walk.waypoints[i - 1];
    for (double s = 0.0; s < leg.norm(); s += step) places.emplace_back(walk.waypoints[i - 1] + leg.normalized() * s);
  }
  places.push_back(walk.waypoints.back());
  return places;
}

/// Where the walker stands at a time; evenly along the waypoints.
Eigen::Vector2d position_at(const Walk& walk, double time_s) {
  double left = walk.speed_mps * time_s;
  for (std::size_t i = 1; i < walk.waypoints.size(); ++i) {
    const Eigen::Vector2d leg = walk.waypoints[i] - walk.waypoints[i - 1];
    if (left <= leg.norm()) return walk.waypoints[i - 1] + leg.normalized() * left;
    left -= leg.norm();
  }
  return walk.waypoints.back();
}

std::size_t count_triangles(const Scene& scene) {
  std::size_t count = 0;
  for (const Mesh& mesh : scene.meshes) count += mesh.triangles.size();
  return count;
}

using Triangle = std::array<Eigen::Vector3d, 3>;

/// Whether a triangle comes into a box, to within a few centimetres: halved along its longest side until that is clear.
bool reaches_into(const Triangle& triangle, const Eigen::AlignedBox3d& box) {
  Eigen::AlignedBox3d bounds;
  for (const Eigen::Vector3d& p : triangle) bounds.extend(p);
  if (!box.intersects(bounds)) return false;
  if (bounds.diagonal().norm() < 0.05 || box.contains(bounds)) return true;
  std::size_t longest = 0;
  const auto side = [&](std::size_t i) { return (triangle.at((i + 1) % 3) - triangle.at(i)).norm(); };
  for (std::size_t i = 1; i < 3; ++i) longest = side(i) > side(longest) ? i : longest;
  const Eigen::Vector3d middle = 0.5 * (triangle.at(longest) + triangle.at((longest + 1) % 3));
  Triangle first = triangle;
  Triangle second = triangle;
  first.at((longest + 1) % 3) = middle;
  second.at(longest) = middle;
  return reaches_into(first, box) || reaches_into(second, box);
}

/// Whether any standing surface comes within a body's width and height of a walker at a place on ground of height z.
bool is_blocked(const Scene& scene, const Eigen::Vector2d& place, double z) {
  constexpr double kHalfWidth = 0.25;
  constexpr double kStepOver = 0.3;
  constexpr double kHeadroom = 1.95;
  const Eigen::AlignedBox3d body(Eigen::Vector3d(place.x() - kHalfWidth, place.y() - kHalfWidth, z + kStepOver),
                                 Eigen::Vector3d(place.x() + kHalfWidth, place.y() + kHalfWidth, z + kHeadroom));
  const auto vertex = [](const Mesh& mesh, int i) -> Eigen::Vector3d {
    return mesh.vertices[static_cast<std::size_t>(i)].cast<double>();
  };
  for (const Mesh& mesh : scene.meshes) {
    if (mesh.body >= 0) continue;
    const auto blocks = [&](const Eigen::Vector3i& t) {
      return reaches_into({vertex(mesh, t[0]), vertex(mesh, t[1]), vertex(mesh, t[2])}, body);
    };
    if (std::ranges::any_of(mesh.triangles, blocks)) return true;
  }
  return false;
}

struct Case {
  std::string family;
  int seed;
};

std::vector<Case> make_cases() {
  std::vector<Case> cases;
  for (const Family& family : families()) {
    for (int seed = 1; seed <= 12; ++seed) cases.push_back({family.name, seed});
  }
  return cases;
}

class EveryFamily : public testing::TestWithParam<Case> {
 protected:
  double duration_s_ = frames_of().at(GetParam().family) / kFps;
  World world_ = make_world(GetParam().family, GetParam().seed, duration_s_);
};

TEST_P(EveryFamily, HasInstancesWithInsidesAndNoStrayIds) {
  std::set<int> seen;
  for (const Mesh& mesh : world_.scene.meshes) seen.insert(mesh.obstacle);
  std::set<int> known{0};
  if (GetParam().family == "street") known.insert(kNotLabelled);
  for (const Instance& instance : world_.scene.instances) known.insert(instance.id);
  EXPECT_EQ(seen, known);
  EXPECT_NO_THROW(world_.scene.validate());
  EXPECT_LT(count_triangles(world_.scene), 300000U);
}

TEST_P(EveryFamily, HasTheInstancesItIsNamedFor) {
  std::map<std::string, std::vector<double>> depths;
  for (const Instance& instance : world_.scene.instances) depths[instance.type].push_back(instance.depth_m);
  const auto within = [&](const std::string& type, std::size_t count, double low, double high) {
    ASSERT_EQ(depths[type].size(), count) << type;
    for (const double depth : depths[type]) {
      EXPECT_GE(depth, low) << type;
      EXPECT_LE(depth, high) << type;
    }
  };
  const std::string& family = GetParam().family;
  const std::size_t total = world_.scene.instances.size();
  if (family == "stairs") {
    EXPECT_EQ(total, 2U);
    within("stairs_down", 2, 6 * 0.15, 13 * 0.19);
  } else if (family == "platform") {
    EXPECT_EQ(total, 1U);
    within("platform_edge", 1, 0.9, 1.1);
  } else if (family == "manholes") {
    EXPECT_EQ(total, 3U);
    within("manhole", 2, 0.4, 4.0);
    const auto [shallow, deep] = std::ranges::minmax(depths["manhole"]);
    EXPECT_LE(shallow, 0.8);
    EXPECT_GE(deep, 2.5);
    EXPECT_EQ(depths["trench"].size() + depths["lower_ground"].size(), 1U);
  } else if (family == "street") {
    EXPECT_EQ(total, 5U);
    within("pothole", 2, 0.05, 0.25);
    within("curb", 1, 0.08, 0.20);
    within("trench", 1, 0.2, 0.9);
    within("stairs_down", 1, 6 * 0.15, 13 * 0.19);
  } else {
    EXPECT_EQ(total, 0U);
  }
}

TEST_P(EveryFamily, WalksLongEnoughAtAHumanPace) {
  const Walk& walk = world_.walk;
  EXPECT_GE(line_length(walk.waypoints), walk.speed_mps * duration_s_);
  EXPECT_TRUE(walk.waypoints[0].isZero());
  EXPECT_NEAR((walk.waypoints[1] - walk.waypoints[0]).normalized().x(), 1.0, 1e-9) << "x is ahead of the start";
  EXPECT_GE(walk.speed_mps, 0.6);
  EXPECT_LE(walk.speed_mps, 1.4);
  EXPECT_GE(walk.camera_height_m, 1.5);
  EXPECT_LE(walk.camera_height_m, 1.8);
  EXPECT_GE(walk.pitch_deg, 15.0);
  EXPECT_LE(walk.pitch_deg, 40.0);
}

TEST_P(EveryFamily, KeepsThePathOffOpenings) {
  for (const Instance& instance : world_.scene.instances) {
    const Polygon outline = outline_of(instance);
    for (const Eigen::Vector2d& place : sample_path(world_.walk, 0.05)) {
      ASSERT_GE(distance_to_polygon(outline, place), 0.3) << instance.type << " at " << place.transpose();
    }
  }
}

TEST_P(EveryFamily, KeepsThePathOffSolidThings) {
  double z = 0.0;
  for (const Eigen::Vector2d& place : sample_path(world_.walk, 0.2)) {
    for (const Crossing& crossing : cross_vertically(world_.scene, place)) {
      if (crossing.z > z + 0.3) continue;
      ASSERT_LT(std::abs(crossing.z - z), 0.1) << "no ground under the path at " << place.transpose();
      z = crossing.z;
      break;
    }
    ASSERT_FALSE(is_blocked(world_.scene, place, z)) << "at " << place.transpose();
  }
}

TEST_P(EveryFamily, KeepsMovingBodiesOutOfTheWalker) {
  std::set<int> bodies;
  for (const Mesh& mesh : world_.scene.meshes) {
    if (mesh.body < 0 || !bodies.insert(mesh.body).second) continue;
    const Eigen::Vector2d velocity = world_.scene.bodies[static_cast<std::size_t>(mesh.body)].velocity.head<2>().cast<double>();
    const Eigen::Vector2d start = mesh.vertices[0].head<2>().cast<double>();
    for (double t = 0.0; t <= duration_s_; t += 0.1) {
      ASSERT_GT((start + t * velocity - position_at(world_.walk, t)).norm(), 0.6) << "at " << t << " s";
    }
  }
}

TEST_P(EveryFamily, OpensTheGroundExactlyAtTheRims) {
  for (const Instance& instance : world_.scene.instances) {
    const Polygon outline = outline_of(instance);
    const Eigen::Vector3d plane = fit_rim(instance);
    ASSERT_GT(signed_area(outline), 0.0);
    int sides_on_ground = 0;
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Eigen::Vector2d side = outline[(i + 1) % outline.size()] - outline[i];
      const Eigen::Vector2d middle = outline[i] + 0.45 * side;
      const Eigen::Vector2d outward = Eigen::Vector2d(side.y(), -side.x()).normalized();
      const auto is_shared = [&](const Instance& other) {
        return other.id != instance.id && contains(outline_of(other), middle + 0.02 * outward);
      };
      if (std::ranges::any_of(world_.scene.instances, is_shared)) continue;  // two flights beside a handrail
      const double rim = height_on(plane, middle);
      for (const Crossing& crossing : cross_vertically(world_.scene, middle - 0.02 * outward)) {
        if (crossing.z > rim + 0.1) continue;  // a railing, a tree
        EXPECT_EQ(crossing.obstacle, instance.id) << instance.type << " just inside, side " << i;
        EXPECT_LT(crossing.z, rim - 0.001);
        break;
      }
      const auto outside = cross_vertically(world_.scene, middle + 0.02 * outward);
      const auto is_ground = [&](const Crossing& c) { return c.obstacle == 0 && std::abs(c.z - rim) < 0.02; };
      if (std::ranges::any_of(outside, is_ground)) ++sides_on_ground;
    }
    EXPECT_GE(sides_on_ground, instance.type == "platform_edge" || instance.type == "curb" ? 1 : 2) << instance.type;
  }
}

TEST_P(EveryFamily, IsAsDeepAsItsInstancesSay) {
  constexpr int kGrid = 15;
  for (const Instance& instance : world_.scene.instances) {
    const Polygon outline = outline_of(instance);
    const Eigen::Vector3d plane = fit_rim(instance);
    const Eigen::AlignedBox2d bounds = compute_bounds(outline);
    double deepest = 0.0;
    for (int i = 0; i < kGrid * kGrid; ++i) {
      const Eigen::Vector2d share((i % kGrid + 0.5) / kGrid, (static_cast<double>(i / kGrid) + 0.5) / kGrid);
      const Eigen::Vector2d place = bounds.min() + share.cwiseProduct(bounds.sizes());
      if (!contains(outline, place)) continue;
      const auto crossings = cross_vertically(world_.scene, place);
      const auto floor = std::ranges::find(crossings, instance.id, &Crossing::obstacle);
      ASSERT_NE(floor, crossings.end()) << instance.type << " has no floor at " << place.transpose();
      deepest = std::max(deepest, height_on(plane, place) - floor->z);
    }
    EXPECT_NEAR(deepest, instance.depth_m, 0.005) << instance.type;
  }
}

TEST_P(EveryFamily, EqualsItselfAndDiffersFromTheNextSeed) {
  const World same = make_world(GetParam().family, GetParam().seed, duration_s_);
  ASSERT_EQ(same.scene.meshes.size(), world_.scene.meshes.size());
  for (std::size_t i = 0; i < same.scene.meshes.size(); ++i) {
    ASSERT_EQ(same.scene.meshes[i].vertices, world_.scene.meshes[i].vertices);
  }
  EXPECT_EQ(same.walk.waypoints, world_.walk.waypoints);
  const World other = make_world(GetParam().family, GetParam().seed + 1, duration_s_);
  EXPECT_NE(other.walk.waypoints, world_.walk.waypoints);
  EXPECT_NE(other.walk.camera_height_m, world_.walk.camera_height_m);
  EXPECT_NE(other.scene.meshes.back().vertices, world_.scene.meshes.back().vertices);
  EXPECT_NE(other.scene.materials[0].color, world_.scene.materials[0].color);
}

INSTANTIATE_TEST_SUITE_P(Families, EveryFamily, testing::ValuesIn(make_cases()),
                         [](const auto& each) { return each.param.family + std::to_string(each.param.seed); });

TEST(Families, AreTheSevenInTheirOrder) {
  std::vector<std::string> names;
  for (const Family& family : families()) names.emplace_back(family.name);
  EXPECT_EQ(names, (std::vector<std::string>{"stairs", "platform", "manholes", "street", "control", "motion", "crowd"}));
}

TEST(Families, ComeNearerThanThreeMetresToEveryInstance) {
  for (const std::string family : {"stairs", "platform", "manholes", "street"}) {
    for (int seed = 1; seed <= 12; ++seed) {
      const World world = make_world(family, seed, frames_of().at(family) / kFps);
      for (const Instance& instance : world.scene.instances) {
        double nearest = std::numeric_limits<double>::infinity();
        for (const Eigen::Vector2d& place : sample_path(world.walk, 0.1)) {
          nearest = std::min(nearest, distance_to_polygon(outline_of(instance), place));
        }
        EXPECT_LT(nearest, 2.6) << family << " " << seed << ": " << instance.type;
      }
    }
  }
}

TEST(Families, WalkOnForTwoMinutesWhereAsked) {
  for (const Family& family : families()) {
    const World world = make_world(family.name, 3, 120.0);
    EXPECT_GE(line_length(world.walk.waypoints), 120.0 * world.walk.speed_mps) << family.name;
    for (const Instance& instance : world.scene.instances) {
      for (const Eigen::Vector2d& place : sample_path(world.walk, 0.1)) {
        ASSERT_GE(distance_to_polygon(outline_of(instance), place), 0.3) << family.name << ": " << instance.type;
      }
    }
  }
}

TEST(Families, HaveEveryWeatherAmongTwelveSeeds) {
  for (const Family& family : families()) {
    int sunny = 0;
    int bright = 0;
    for (int seed = 1; seed <= 12; ++seed) {
      const Light light = make_world(family.name, seed, 5.0).scene.light;
      sunny += light.sun.norm() > 0.0F ? 1 : 0;
      bright += light.sky.norm() > 0.1F ? 1 : 0;
    }
    EXPECT_GT(sunny, 0) << family.name;
    EXPECT_GT(bright, sunny) << family.name << " is never overcast";
    EXPECT_LT(bright, 12) << family.name << " is never dusky";
  }
}

TEST(Families, StayTheSamePlaceUnderAnotherWeather) {
  const World sunny = make_world("stairs", 5, 10.0, "sunny");
  const World dusk = make_world("stairs", 5, 10.0, "dusk");
  EXPECT_GT(sunny.scene.light.sun.norm(), 0.0F);
  EXPECT_EQ(dusk.scene.light.sun.norm(), 0.0F);
  EXPECT_EQ(sunny.walk.waypoints, dusk.walk.waypoints);
}

TEST(Families, RefuseWhatTheyDoNotKnow) {
  using brink::test::error_of;
  using brink::test::expect_line_with;
  const std::string family = error_of<std::invalid_argument>([] { make_world("beach", 1, 10.0); });
  expect_line_with(family, "family = beach, must be stairs, platform, manholes, street, control, motion, crowd");
  const std::string light = error_of<std::invalid_argument>([] { make_world("stairs", 1, 10.0, "fog"); });
  expect_line_with(light, "light = fog, must be sunny, overcast or dusk");
  for (const double duration : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    expect_line_with(error_of<std::invalid_argument>([&] { make_world("stairs", 1, duration); }), "duration_s");
  }
}

/// One triangle, one material, one instance that owns it.
Scene make_small_scene() {
  Scene scene;
  scene.materials.emplace_back();
  scene.light.to_sun = Eigen::Vector3f::UnitZ();
  scene.meshes.push_back(
      {.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .triangles = {{0, 1, 2}}, .material = 0, .obstacle = 1, .body = -1});
  scene.instances.push_back({.id = 1, .type = "trench", .depth_m = 0.5, .opening = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}});
  return scene;
}

TEST(Scene, IsValidWhenEmptyAndWhenComplete) {
  Scene empty;
  empty.light.to_sun = Eigen::Vector3f::UnitZ();
  EXPECT_NO_THROW(empty.validate());
  EXPECT_NO_THROW(make_small_scene().validate());
}

TEST(Scene, NamesTheFirstFault) {
  const auto fault = [](auto spoil) {
    Scene scene = make_small_scene();
    spoil(scene);
    return brink::test::error_of<std::invalid_argument>([&] { scene.validate(); });
  };
  using brink::test::expect_line_with;
  expect_line_with(fault([](Scene& s) { s.meshes[0].material = 1; }), "meshes[0].material = 1");
  expect_line_with(fault([](Scene& s) { s.meshes[0].body = 0; }), "meshes[0].body = 0");
  expect_line_with(fault([](Scene& s) { s.meshes[0].obstacle = 2; }), "meshes[0].obstacle = 2");
  expect_line_with(fault([](Scene& s) { s.meshes[0].triangles[0] = {0, 1, 3}; }), "outside its 3 vertices");
  expect_line_with(fault([](Scene& s) { s.meshes[0].vertices[0].x() = std::nanf(""); }), "not finite");
  expect_line_with(fault([](Scene& s) { s.instances[0].id = 255; }), "instance id = 255");
  expect_line_with(fault([](Scene& s) { s.instances.push_back(s.instances[0]); }), "appears twice");
  expect_line_with(fault([](Scene& s) { s.instances[0].depth_m = 0.0; }), "depth_m of instance 1 = 0");
  expect_line_with(fault([](Scene& s) { s.instances[0].opening.resize(2); }), "fewer than 3 corners");
  expect_line_with(fault([](Scene& s) { s.materials[0].cell_m = 0.0F; }), "materials[0].cell_m = 0");
  expect_line_with(fault([](Scene& s) { s.materials[0].color.x() = 2.0F; }), "materials[0]");
  expect_line_with(fault([](Scene& s) { s.light.to_sun.setZero(); }), "light.to_sun");
}

}  // namespace
}  // namespace brink::sim
