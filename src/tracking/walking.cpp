#include "brink/walking.hpp"

#include <algorithm>
#include <cmath>

#include "tracking/opening.hpp"

namespace brink {
namespace {

constexpr double kRemembered = 1.0;  // s: about two steps, over which a head's sway averages out
constexpr double kLeast = 0.5;       // s: about one step
constexpr double kWalking = 0.2;     // m/s: who moves less stands and looks around
constexpr double kSpacing = 0.05;    // m, of points along the rim
constexpr double kTolerance = 1e-9;  // s

}  // namespace

void WalkEstimator::update(const std::optional<Eigen::Isometry3d>& current_from_previous, double time) {
  if (!current_from_previous) trail_.clear();
  for (Place& place : trail_) place.position = *current_from_previous * place.position;
  trail_.push_back({Eigen::Vector3d::Zero(), time});
  std::erase_if(trail_, [time](const Place& place) { return time - place.time > kRemembered + kTolerance; });
}

std::optional<Eigen::Vector3d> WalkEstimator::velocity() const {
  if (trail_.empty()) return std::nullopt;
  const double duration_s = trail_.back().time - trail_.front().time;
  if (duration_s < kLeast - kTolerance) return std::nullopt;
  return Eigen::Vector3d(-trail_.front().position / duration_s);
}

std::optional<double> compute_time_to_edge(const std::vector<Eigen::Vector3d>& rim, const Eigen::Vector3d& velocity,
                                           const GroundPose& ground, double path_width_m) {
  const Eigen::Vector3d along_ground = velocity - ground.down.dot(velocity) * ground.down;
  const double speed = along_ground.norm();
  if (speed < kWalking) return std::nullopt;
  const Eigen::Vector3d ahead = along_ground / speed;
  const Eigen::Vector3d aside = ground.down.cross(ahead);
  std::optional<double> first;
  std::optional<double> last;
  for (const Eigen::Vector3d& point : sample_edges(compute_hull(rim), kSpacing)) {
    if (std::abs(aside.dot(point)) > 0.5 * path_width_m) continue;
    const double distance = ahead.dot(point);
    first = std::min(first.value_or(distance), distance);
    last = std::max(last.value_or(distance), distance);
  }
  if (!first || *last < 0.0) return std::nullopt;
  return std::max(0.0, *first) / speed;
}

}  // namespace brink
