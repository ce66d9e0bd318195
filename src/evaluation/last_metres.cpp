#include "evaluation/last_metres.hpp"

#include <algorithm>
#include <cmath>

#include "evaluation/presence.hpp"

namespace brink {
namespace {

constexpr double kClaimTolerance = 1e-9;  // m: 1.3 m claimed at 1.0 m are 0.3 m off

bool is_in_view(const FrameTruth& truth, int id, const EvaluationParams& params) {
  const auto seen = std::ranges::find(truth.instances, id, &VisibleInstance::id);
  return seen != truth.instances.end() && is_present(*seen, params);
}

bool is_hit(const std::vector<DetectionScore>& detections, int id) {
  return std::ranges::any_of(detections,
                             [id](const DetectionScore& one) { return std::ranges::find(one.hits, id) != one.hits.end(); });
}

/// A detection that hits something else speaks of that; any other one, as a memory whose place has left the image, is judged
/// by its distance.
bool is_claimed(const std::vector<DetectionScore>& detections, double distance_m, double tolerance_m) {
  return std::ranges::any_of(detections, [&](const DetectionScore& one) {
    return one.hits.empty() && std::abs(one.distance_m - distance_m) <= tolerance_m + kClaimTolerance;
  });
}

}  // namespace

// Whoever walks down a flight of stairs leaves the opening at its lower end: he has come back only when he stands outside at
// the height from which he entered.
bool LastMetres::has_passed(Approach& approach, const RimPlace& rim) {
  const bool is_below = approach.height_m && std::abs(rim.height_m - *approach.height_m) > rim.depth_m / 2.0;
  approach.has_entered = rim.is_inside || (approach.has_entered && is_below);
  if (!approach.has_entered) approach.height_m = rim.height_m;
  return approach.has_entered;
}

// Begins a new approach where one has to begin. Nothing is asked about an edge that was never seen.
bool LastMetres::is_followed(Approach& approach, bool is_present, bool is_ahead, double time) const {
  if (!is_present && !(approach.was_seen && is_ahead)) return approach.was_seen;
  if (!approach.was_seen || time - approach.last_time >= params_.gone_s - kTimeTolerance) {
    approach.start = time;
    approach.warned = false;
  }
  approach.was_seen = true;
  approach.last_time = time;
  return true;
}

// Whether a silence has just become a dropped warning.
bool LastMetres::note_silence(Approach& approach, bool is_reported, double time) const {
  if (is_reported || !approach.was_ahead) {
    approach.silent_since = time;
    approach.dropped = false;
    return false;
  }
  const bool is_long = time - approach.silent_since >= params_.dropped_s - kTimeTolerance;
  if (!approach.warned || approach.dropped || !is_long) return false;
  approach.dropped = true;
  return true;
}

std::vector<EdgeAhead> LastMetres::score(const FrameTruth& truth, const std::vector<DetectionScore>& detections) {
  std::vector<EdgeAhead> edges;
  for (const RimPlace& rim : truth.rims) {
    if (rim.depth_m < params_.min_depth_m) continue;
    Approach& approach = approaches_[rim.id];
    const bool passed = has_passed(approach, rim);
    const bool is_ahead = !passed && rim.distance_m <= params_.ahead_range_m && std::abs(rim.bearing_deg) <= params_.ahead_deg;
    if (!is_followed(approach, is_in_view(truth, rim.id, params_), is_ahead, truth.time)) continue;
    const bool is_reported =
        is_hit(detections, rim.id) || (is_ahead && is_claimed(detections, rim.distance_m, params_.claim_error_m));
    approach.warned = approach.warned || is_reported;
    if (is_ahead) {
      EdgeAhead edge;
      edge.id = rim.id;
      edge.distance_m = rim.distance_m;
      edge.settled = truth.time - approach.start >= params_.settle_s - kTimeTolerance;
      edge.reported = is_reported;
      edge.warned = approach.warned;
      edge.dropped = note_silence(approach, is_reported, truth.time);
      edges.push_back(edge);
    }
    approach.was_ahead = is_ahead;
  }
  return edges;
}

}  // namespace brink
