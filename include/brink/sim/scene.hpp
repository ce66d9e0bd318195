#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace brink::sim {

/// World: x ahead of the walker's start, y to the left, z up, metres; the ground under the start is z = 0. Colours are linear
/// RGB reflectances or radiances, not display values.

/// How a surface's reflectance varies over it: procedural 3D patterns, filtered by the footprint of a pixel.
enum class Pattern : std::uint8_t {
  plain,
  asphalt,
  concrete,
  tiles,
  gravel,
  grass,
  metal,
  tactile,
  leaves,
  plaster,
  rubber,
  cloth
};

struct Material {
  Pattern pattern = Pattern::plain;
  Eigen::Vector3f color{0.5F, 0.5F, 0.5F};         ///< reflectance, 0..1
  Eigen::Vector3f second_color{0.3F, 0.3F, 0.3F};  ///< of joints, stones, blades; plain ignores it
  float cell_m = 0.1F;                             ///< size of the coarsest feature
  float contrast = 1.0F;                           ///< 0 = uniform color, 1 = the pattern's own
  float gloss = 0.0F;                              ///< share of mirrored light, 0..1: wet, oily, metal, glass
  float relief_m = 0.0F;                           ///< height of stones and dents, standard deviation; seen in the pattern only
};

/// A triangle mesh. Triangles may be seen from both sides.
struct Mesh {
  std::vector<Eigen::Vector3f> vertices;   ///< m, world at time 0
  std::vector<Eigen::Vector3i> triangles;  ///< indices into vertices
  int material = 0;                        ///< index into Scene::materials
  int obstacle = 0;  ///< id of the negative obstacle whose inside this surface is; 0 = none, 255 = not labelled (formats.md)
  int body = -1;     ///< index into Scene::bodies when it moves; -1 = it stands
};

/// A body that moves straight and evenly.
struct Body {
  Eigen::Vector3f velocity{0.0F, 0.0F, 0.0F};  ///< m/s
};

/// A negative obstacle as instances.yaml tells it (formats.md). Its inside is all meshes with this id.
struct Instance {
  int id = 0;                            ///< 1..254, unique in the scene
  std::string type;                      ///< stairs_down, platform_edge, manhole, trench, pothole, lower_ground, curb
  double depth_m = 0.0;                  ///< of its deepest visible floor below the ground around it
  std::vector<Eigen::Vector3d> opening;  ///< rim polygon on the ground's surface, world, counter-clockwise
};

struct Light {
  Eigen::Vector3f to_sun{0.3F, 0.2F, 0.93F};  ///< unit vector
  Eigen::Vector3f sun{0.0F, 0.0F, 0.0F};      ///< irradiance on a surface facing the sun; 0 = overcast
  Eigen::Vector3f sky{1.0F, 1.0F, 1.0F};      ///< radiance of the sky
  float sun_radius_deg = 0.27F;               ///< wider = softer shadow edges (haze)
};

/// Everything that can be seen, as plain data.
struct Scene {
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<Body> bodies;
  std::vector<Instance> instances;
  Light light;

  /// Checks every index, id, number and colour. @throws std::invalid_argument naming the first thing at fault.
  void validate() const;
};

/// How somebody walks through a scene with the camera on the head, without stopping. The height of the ground under the path is
/// sampled from the scene.
struct Walk {
  std::vector<Eigen::Vector2d> waypoints;  ///< x, y in the world, at least two; walked at even speed, corners rounded
  double speed_mps = 1.2;
  double camera_height_m = 1.65;  ///< over the ground, standing
  double pitch_deg = 28.0;        ///< mean, positive down
  double step_length_m = 0.7;     ///< the head bobs once a step and sways once every two
  double bob_m = 0.02;            ///< amplitude, up and down
  double sway_m = 0.02;           ///< amplitude, left and right
  double roll_deg = 1.0;          ///< amplitude, with the sway
  double pitch_swing_deg = 1.0;   ///< amplitude, with the bob
  double yaw_swing_deg = 1.5;     ///< amplitude, with the sway
  double look_yaw_deg = 10.0;     ///< looking around: greatest angle to either side
  double look_pitch_deg = 5.0;    ///< and up and down
  double look_period_s = 5.0;     ///< about one look this often
  int seed = 1;                   ///< of the looking around
};

/// A scene and a walk through it.
struct World {
  Scene scene;
  Walk walk;
};

enum class Weather : std::uint8_t { sunny, overcast, dusk };

struct Family {
  const char* name;     ///< as on the command line
  const char* meaning;  ///< one line
};

/// The ready-made families: stairs, platform, manholes, street, control, motion, crowd.
const std::vector<Family>& families();

/// A world of a family, varied by the seed in layout, sizes, materials, light, path, walking speed and camera height.
/// @param duration_s how long the walk has to last at least. @param weather empty = chosen by the seed.
/// @throws std::invalid_argument "family = name, must be ..." naming all of them.
World make_world(const std::string& family, int seed, double duration_s, const std::string& weather = "");

}  // namespace brink::sim
