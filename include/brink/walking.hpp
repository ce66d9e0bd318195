#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "brink/ground.hpp"

namespace brink {

/// Our own: how the bearer walks, from the camera's motions of the last second. A head bobs, sways and nods with every step, so
/// a single motion tells little of where its bearer goes.
class WalkEstimator {
 public:
  /// @param current_from_previous left camera frames of the last call and of this one, m; empty = not known: what was known of
  ///        the walk is forgotten.
  /// @param time s, after the last call's.
  void update(const std::optional<Eigen::Isometry3d>& current_from_previous, double time);

  /// Mean velocity of the camera over the last second, m/s, in the last call's left camera frame; empty before half a second of
  /// motion is known.
  [[nodiscard]] std::optional<Eigen::Vector3d> velocity() const;

 private:
  /// Where the camera was, in the frame where it is.
  struct Place {
    Eigen::Vector3d position;
    double time = 0.0;
  };
  std::vector<Place> trail_;  // of the last second, oldest first
};

/// When a bearer who walks straight on reaches an opening, s; 0 when he is over it.
/// @param rim points of it in the left camera frame, m. @param velocity of the camera, m/s in the same frame.
/// @param path_width_m breadth of the strip of ground that is walked on.
/// @return empty when that strip misses the rim's convex hull or has left it behind, when he hardly moves (below 0.2 m/s), and
///         for an empty rim.
std::optional<double> compute_time_to_edge(const std::vector<Eigen::Vector3d>& rim, const Eigen::Vector3d& velocity,
                                           const GroundPose& ground, double path_width_m);

}  // namespace brink
