#pragma once

#include <map>
#include <optional>
#include <vector>

#include "brink/evaluation.hpp"

namespace brink {

/// Follows every instance of one sequence to the edge, frame by frame in order of time (docs/evaluation.md, "The last two
/// metres").
class LastMetres {
 public:
  explicit LastMetres(const EvaluationParams& params) : params_(params) {}

  /// The edges that lie ahead in this frame, in the order of `truth.rims`.
  /// @param detections of this frame, with what they hit.
  std::vector<EdgeAhead> score(const FrameTruth& truth, const std::vector<DetectionScore>& detections);

 private:
  // What is remembered of one instance. An approach goes on while the instance is present or lies ahead.
  struct Approach {
    bool was_seen = false;           // present at some time
    double start = 0.0;              // s, of the approach
    double last_time = 0.0;          // s, when the approach last went on
    bool warned = false;             // reported at some time on this approach
    bool was_ahead = false;          // in the frame before
    double silent_since = 0.0;       // s; the last report while it lies ahead, or when it came to lie ahead
    bool dropped = false;            // the present silence has been counted
    bool has_entered = false;        // the bearer went into the opening and has not come back up
    std::optional<double> height_m;  // of the camera over the rim's plane, when the bearer last stood outside
  };
  static bool has_passed(Approach& approach, const RimPlace& rim);
  bool is_followed(Approach& approach, bool is_present, bool is_ahead, double time) const;
  bool note_silence(Approach& approach, bool is_reported, double time) const;

  EvaluationParams params_;
  std::map<int, Approach> approaches_;  // by id
};

}  // namespace brink
