#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include "brink/camera.hpp"
#include "brink/sim/render.hpp"
#include "brink/sim/scene.hpp"

/// Scenes of a few rectangles, for tests and benchmarks of the renderer.
namespace brink::sim::test {

inline StereoCamera make_camera(int width, int height, double focal) {
  return {focal, 0.5 * (width - 1), 0.5 * (height - 1), 0.15};
}

/// A camera at (0, 0, height) that looks along x, pitched down, then rolled to the right.
inline Eigen::Isometry3d make_pose(double height, double pitch_deg, double roll_deg = 0.0) {
  const double pitch = pitch_deg * std::numbers::pi / 180.0;
  const double roll = roll_deg * std::numbers::pi / 180.0;
  Eigen::Matrix3d level;  // columns: camera x = -y world, camera y = -z world, camera z = x world
  level << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = level * Eigen::AngleAxisd(-pitch, Eigen::Vector3d::UnitX()).toRotationMatrix() *
                  Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(0.0, 0.0, height);
  return pose;
}

inline CameraMotion standing(const Eigen::Isometry3d& pose) {
  return [pose](double) { return pose; };
}

/// A parallelogram: corner, corner + a, corner + a + b, corner + b.
inline Mesh make_quad(const Eigen::Vector3f& corner, const Eigen::Vector3f& a, const Eigen::Vector3f& b, int material = 0,
                      int obstacle = 0) {
  Mesh mesh;
  mesh.vertices = {corner, corner + a, corner + a + b, corner + b};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.material = material;
  mesh.obstacle = obstacle;
  return mesh;
}

/// A horizontal rectangle.
inline Mesh make_floor(float x0, float x1, float y0, float y1, float z, int material = 0, int obstacle = 0) {
  return make_quad({x0, y0, z}, {x1 - x0, 0.0F, 0.0F}, {0.0F, y1 - y0, 0.0F}, material, obstacle);
}

/// The four walls of a box from z0 to z1.
inline void add_walls(Scene& scene, float x0, float x1, float y0, float y1, float z0, float z1, int material, int obstacle) {
  const Eigen::Vector3f up(0.0F, 0.0F, z1 - z0);
  scene.meshes.push_back(make_quad({x0, y0, z0}, {x1 - x0, 0.0F, 0.0F}, up, material, obstacle));
  scene.meshes.push_back(make_quad({x0, y1, z0}, {x1 - x0, 0.0F, 0.0F}, up, material, obstacle));
  scene.meshes.push_back(make_quad({x0, y0, z0}, {0.0F, y1 - y0, 0.0F}, up, material, obstacle));
  scene.meshes.push_back(make_quad({x1, y0, z0}, {0.0F, y1 - y0, 0.0F}, up, material, obstacle));
}

/// Ground at z = 0 all around, with a rectangular hole whose walls and floor are obstacle 1.
inline void add_ground_with_hole(Scene& scene, float x0, float x1, float y0, float y1, float depth, int ground, int inside) {
  constexpr float kFar = 60.0F;
  scene.meshes.push_back(make_floor(-kFar, x0, -kFar, kFar, 0.0F, ground));
  scene.meshes.push_back(make_floor(x1, kFar, -kFar, kFar, 0.0F, ground));
  scene.meshes.push_back(make_floor(x0, x1, -kFar, y0, 0.0F, ground));
  scene.meshes.push_back(make_floor(x0, x1, y1, kFar, 0.0F, ground));
  scene.meshes.push_back(make_floor(x0, x1, y0, y1, -depth, inside, 1));
  add_walls(scene, x0, x1, y0, y1, -depth, 0.0F, inside, 1);
  scene.instances.push_back({1, "manhole", depth, {{x0, y0, 0.0}, {x1, y0, 0.0}, {x1, y1, 0.0}, {x0, y1, 0.0}}});
}

/// A sunny road with a hole, a kerb of slabs, a post, a box that moves to the left at 1 m/s, a wet patch, gravel and grass.
inline Scene make_street(float depth) {
  Scene scene;
  scene.materials = {
      {Pattern::asphalt, {0.10F, 0.10F, 0.105F}, {0.26F, 0.25F, 0.24F}, 0.012F, 1.0F, 0.0F},
      {Pattern::concrete, {0.35F, 0.34F, 0.31F}, {0.27F, 0.26F, 0.24F}, 0.5F, 1.0F, 0.0F},
      {Pattern::tiles, {0.38F, 0.36F, 0.33F}, {0.16F, 0.15F, 0.14F}, 0.3F, 1.0F, 0.0F},
      {Pattern::metal, {0.25F, 0.25F, 0.26F}, {0.3F, 0.3F, 0.3F}, 0.1F, 1.0F, 0.2F},
      {Pattern::asphalt, {0.035F, 0.036F, 0.04F}, {0.08F, 0.08F, 0.08F}, 0.012F, 0.7F, 0.25F},
      {Pattern::grass, {0.10F, 0.17F, 0.04F}, {0.035F, 0.07F, 0.02F}, 0.02F, 1.0F, 0.0F},
      {Pattern::gravel, {0.30F, 0.28F, 0.25F}, {0.22F, 0.20F, 0.18F}, 0.03F, 1.0F, 0.0F},
      {Pattern::tactile, {0.60F, 0.58F, 0.50F}, {0.50F, 0.47F, 0.40F}, 0.3F, 1.0F, 0.0F},
      {Pattern::leaves, {0.12F, 0.11F, 0.08F}, {0.30F, 0.17F, 0.05F}, 0.08F, 1.0F, 0.0F},
      {Pattern::cloth, {0.35F, 0.06F, 0.05F}, {0.25F, 0.05F, 0.05F}, 0.2F, 1.0F, 0.0F},
  };
  scene.bodies = {{{0.0F, 1.0F, 0.0F}}};
  scene.light = {Eigen::Vector3f(0.4F, 0.45F, 0.8F).normalized(), {15.0F, 14.5F, 13.5F}, {0.85F, 0.95F, 1.2F}, 0.27F};
  add_ground_with_hole(scene, 2.6F, 3.2F, -0.3F, 0.3F, depth, 0, 1);
  scene.meshes.push_back(make_floor(1.0F, 30.0F, 1.2F, 3.0F, 0.12F, 2));
  scene.meshes.push_back(make_floor(1.0F, 30.0F, 3.0F, 3.3F, 0.12F, 7));
  scene.meshes.push_back(make_floor(1.0F, 30.0F, 3.3F, 20.0F, 0.12F, 5));
  scene.meshes.push_back(make_quad({1.0F, 1.2F, 0.0F}, {29.0F, 0.0F, 0.0F}, {0.0F, 0.0F, 0.12F}, 1));
  add_walls(scene, 4.0F, 4.1F, 0.9F, 1.0F, 0.0F, 1.1F, 3, 0);
  scene.meshes.push_back(make_floor(3.6F, 4.6F, -1.5F, -0.6F, 0.002F, 4));
  scene.meshes.push_back(make_floor(1.0F, 12.0F, -9.0F, -2.0F, 0.002F, 6));
  scene.meshes.push_back(make_floor(1.0F, 2.2F, -1.6F, -0.7F, 0.002F, 8));
  scene.meshes.push_back(make_floor(7.0F, 7.5F, -1.0F, -0.5F, 1.6F, 9));
  add_walls(scene, 7.0F, 7.5F, -1.0F, -0.5F, 0.0F, 1.6F, 9, 0);
  for (std::size_t i = scene.meshes.size() - 5; i < scene.meshes.size(); ++i) scene.meshes[i].body = 0;
  scene.meshes.push_back(make_quad({25.0F, -40.0F, 0.0F}, {0.0F, 80.0F, 0.0F}, {0.0F, 0.0F, 6.0F}, 1));
  return scene;
}

}  // namespace brink::sim::test
