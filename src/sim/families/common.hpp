#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "brink/sim/scene.hpp"
#include "sim/builders.hpp"
#include "sim/materials.hpp"
#include "sim/random.hpp"

namespace brink::sim {

using Line = std::vector<Eigen::Vector2d>;

/// A world in the making. A family fills it in this order: openings and big solids, the path (set_path), decoys where there is
/// room (decoys.hpp), the ground around the openings. The site's own frame has its ground at z = 0; make_world tilts and turns
/// everything at the end.
struct Site {
  Random random;
  double speed_mps;   ///< of the walk
  double duration_s;  ///< that the walk has to last
  Weather weather;

  Scene scene{};
  Line path{};                      ///< as it will be walked; empty until set_path
  std::vector<Polygon> openings{};  ///< of the ground; decoys keep away
  struct Spot {
    Eigen::Vector2d center;
    double radius;
    bool solid;
  };
  std::vector<Spot> spots{};  ///< taken by things
  struct PasserBy {
    Eigen::Vector2d start;  ///< at time 0
    Eigen::Vector2d velocity;
  };
  std::vector<PasserBy> passers_by{};
  /// Height that varies along x only, beside the tilt: ramps. Empty = none.
  HeightFunction profile{};

  int add_material(const Material& material);
  int add_body(const Eigen::Vector3d& velocity);
  void add(Mesh mesh, int material, int obstacle = 0, int body = -1);
  /// An instance whose rim lies at the ground's height. @return its id.
  int add_instance(const std::string& type, double depth_m, const Polygon& rim);

  [[nodiscard]] double path_length() const { return speed_mps * duration_s; }
  /// The last part of the approach, as long as the walk lasts; where that is not enough, way_back and approach go before it.
  /// @param way_back from the end of the approach to its start, without both.
  void set_path(const Line& approach, const Line& way_back);
  [[nodiscard]] Eigen::Vector2d position_on_path(double time_s) const;

  /// Whether a round thing fits: clear of openings and of other things, and, if solid, of the path.
  [[nodiscard]] bool is_clear(const Eigen::Vector2d& center, double radius, bool solid) const;
  void take(const Eigen::Vector2d& center, double radius, bool solid) { spots.push_back({center, radius, solid}); }
  /// A free place beside (or, if flat, also on) the path and inside an area; taken at once.
  std::optional<Eigen::Vector2d> take_spot(const Eigen::AlignedBox2d& area, double radius, bool solid);
  /// Height for the next flat thing on the ground: each a little above the one before, so that none flicker into another.
  double next_flat_z();
  int flat_things = 0;  ///< laid so far
};

/// Something in the way of the walk, and the line (a value of y) on which the walker gets past it.
struct Hazard {
  Eigen::Vector2d center;
  Eigen::Vector2d half_size;
  double aside_y;
};

/// Along +x from a start, straight at each hazard (given in order of x), aside in time, and past it.
Line weave_past(const Eigen::Vector2d& start, const std::vector<Hazard>& hazards);

/// One function for each family. They throw nothing of their own.
void build_stairs(Site& site);
void build_platform(Site& site);
void build_manholes(Site& site);
void build_street(Site& site);
void build_control(Site& site);
void build_motion(Site& site);
void build_crowd(Site& site);

/// A place without any hole around a given path: control, motion and crowd.
struct OpenPlace {
  Line approach;
  int solids;
  int flats;
  int people;
  bool ramps = true;
};
void build_open_place(Site& site, const OpenPlace& place);

/// A material for pavements and places, varied.
int add_pavement_material(Site& site);

/// The side walls of an opening (or some of them), from the ground down.
void add_shaft(Site& site, const Line& line, bool closed, double depth, int material, int obstacle);

/// Ground whose height wavers by about +-amplitude and is level around openings, flat things and its own border.
HeightFunction make_rough_height(const Site& site, const Eigen::AlignedBox2d& area, double amplitude, int seed);

/// Light of a weather, varied.
Light make_light(Random& random, Weather weather);

}  // namespace brink::sim
