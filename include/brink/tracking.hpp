#pragma once

#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "brink/candidates.hpp"

namespace brink {

struct TrackingParams {
  double association_radius_m = 0.5;  ///< a centroid is the same candidate's as one that was this near a frame ago
  double validation_s = 1.0 / 3.0;    ///< a candidate is validated when it was seen in a row for this long: 5 frames at 15 fps
  int min_sightings = 3;              ///< ... but never before it was seen so often
  void validate() const;              ///< @throws std::invalid_argument "tracking.name = value, must be ..."
};

/// A candidate that is followed from frame to frame.
struct Track {
  int id = 0;           ///< unique in its run
  Candidate candidate;  ///< as the last frame shows it
  int length = 1;       ///< sightings in a row, this frame's included
  bool validated = false;
};

/// Section III.C.4: the same candidate seen over several frames from a moving camera is a negative obstacle, noise is not.
class Tracker {
 public:
  /// @throws std::invalid_argument when the parameters are not valid.
  explicit Tracker(const TrackingParams& params = {});

  /// The tracks of this frame, one for each candidate, in their order. The centroids of the last frame's tracks are moved by
  /// the camera's motion; each candidate goes on with the nearest one within association_radius_m, whatever its type. Several
  /// may go on with one, as regions split: the nearest keeps its id. What no candidate goes on with ends.
  /// @param current_from_previous left camera frames of the last call and of this one; empty when the motion is not known: then
  ///        all tracks end, and every candidate begins anew.
  /// @param time s. The frame rate follows from the times of the last calls: at f frames per second max(min_sightings,
  ///        round(f validation_s)) sightings validate.
  /// @throws std::invalid_argument when times do not increase.
  std::vector<Track> update(const std::vector<Candidate>& candidates,
                            const std::optional<Eigen::Isometry3d>& current_from_previous, double time);

  /// A frame that could not be processed: all tracks end. @throws std::invalid_argument as update does.
  void miss(double time);

 private:
  void note_time(double time);
  [[nodiscard]] int required_sightings() const;

  TrackingParams params_;
  std::vector<Track> previous_;
  std::vector<double> steps_;  // s, between the last calls
  std::optional<double> time_;
  int last_id_ = 0;
};

}  // namespace brink
