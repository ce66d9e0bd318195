#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "brink/candidates.hpp"

namespace brink {

struct TrackingParams {
  double association_radius_m = 0.5;  ///< a candidate is the same as one whose place was this near a frame ago
  bool associate_rims = true;     ///< places are compared by the nearest point of the rim, too, and by where openings overlap
  double max_unseen_s = 0.2;      ///< a track that is not seen lives on for this long; 0 = it ends with the first frame
  double max_coast_s = 1.0;       ///< a validated one is reported while its place was overlooked for no longer than this, nor
                                  ///< than it was seen, and nothing contradicts it; and for this long after the motion was
                                  ///< last known. What is out of view, or at the feet, is not overlooked. 0 = never
  double max_blind_s = 0.2;       ///< longest run of failed frames or unknown motion that tracks that are not validated
                                  ///< survive; 0 = none. An unknown motion is meanwhile taken to go on as it was
  double validation_s = 0.2;      ///< a candidate is validated when it was seen for this long, 3 frames at 15 fps,
  int min_sightings = 3;          ///< ... but never before it was seen so often,
  double min_probability = 0.5;   ///< ... and not unless this is its probability; 0 = whatever it is, and none is told
  static TrackingParams paper();  ///< 5 frames at 15 fps, without what brink adds: associate_rims false, all others 0
  void validate() const;          ///< @throws std::invalid_argument "tracking.name = value, must be ..."
};

/// Our own: which kind a track was told to be in how many of its sightings.
class KindVotes {
 public:
  void add(ObstacleKind kind) { ++sightings_.at(static_cast<std::size_t>(kind)); }
  /// The kind that was told most often, of equally many the first in ObstacleKind; unknown when none was ever told: not to know
  /// is no vote.
  [[nodiscard]] ObstacleKind winner() const;

 private:
  std::array<int, 4> sightings_{};  // by ObstacleKind
};

/// A candidate that is followed from frame to frame.
struct Track {
  int id = 0;           ///< unique in its run
  Candidate candidate;  ///< as this frame shows it; when it does not, as it was remembered, moved by the camera's motion
  int length = 1;       ///< sightings, this frame's included; in a row but for the gaps that params allow
  bool validated = false;
  double unseen_s = 0.0;      ///< since the last sighting; 0 = this frame shows it
  double overlooked_s = 0.0;  ///< of that, how long its place was in view, and the ground there, and nothing was found
  double evidence = 0.0;      ///< log-odds that one sighting gives, averaged over its sightings, the last ones weighing most
  KindVotes kind_votes;       ///< of its sightings; the winner is the candidate's kind
  std::optional<double> probability;  ///< that it is there, 0..1; empty when params ask for none
};

/// What a frame shows besides its candidates: enough to tell an obstacle that is hidden, or missed, from one that is not there.
struct FrameView {
  StereoCamera camera;
  GroundPose ground;
  cv::Mat1b level;              ///< 255 = surface at the height of the ground; size of the image
  cv::Mat1b below;              ///< 255 = surface as far below the ground as a negative obstacle; empty = nowhere
  bool is_ground_shown = true;  ///< the frame shows the ground; false = it is carried on from earlier frames
};

/// Section III.C.4: the same candidate seen over several frames from a moving camera is a negative obstacle, noise is not.
class Tracker {
 public:
  /// @throws std::invalid_argument when the parameters are not valid.
  explicit Tracker(const TrackingParams& params = {});

  /// The tracks of this frame, one for each candidate, in their order. What the last frames' tracks remember is moved by the
  /// camera's motion; each candidate goes on with the nearest one within association_radius_m, whatever its type; with
  /// associate_rims, where there is none, also with one that it shares half of its opening with, or of the other's. Several may
  /// go on with one, as regions split: the nearest keeps its id. After them come validated tracks that were not seen
  /// (`coasting`): while they were overlooked for no longer than max_coast_s, unless the ground is seen where they should be, a
  /// seen one has taken their place, or their edge is behind the bearer. One that is out of view has an empty contour. Where
  /// the nearest part of an edge has left the image, distance, bearing and rim are those of what is remembered of it.
  /// @param candidates of this frame, positions in its left camera frame, m; empty = nothing was found.
  /// @param current_from_previous left camera frames of the last call and of this one; empty when the motion is not known: the
  ///        last known one is then taken to go on, in proportion to the time, for max_blind_s; then all tracks end, and every
  ///        candidate begins anew.
  /// @param time s. The frame rate follows from the times of the last calls: at f frames per second max(min_sightings,
  ///        round(f validation_s)) sightings validate, if its probability does.
  /// @param view empty = the ground was not visible: nothing coasts in this frame.
  /// @throws std::invalid_argument when times do not increase.
  std::vector<Track> update(const std::vector<Candidate>& candidates,
                            const std::optional<Eigen::Isometry3d>& current_from_previous, double time,
                            const std::optional<FrameView>& view = std::nullopt);

  /// A frame that could not be processed. The next motion must be that since the last one that was; after more than max_blind_s
  /// all tracks end.
  /// @throws std::invalid_argument as update does.
  void miss(double time);

 private:
  /// What a track is known by in the next frame, in the left camera frame of the last one, m.
  struct Memory {
    Track track;
    std::vector<Eigen::Vector3d> opening;  ///< hull of its rim, with what of it has left the image
    std::vector<Eigen::Vector3d> edge;     ///< points of its rim beside which the ground was seen: not the image's border
    double seen = 0.0;                     ///< s, last time
  };

  /// The camera's motion over some time.
  struct Step {
    Eigen::Isometry3d current_from_previous;
    double duration_s = 0.0;
    double end = 0.0;  ///< s
  };

  struct Link;
  void note_time(double time);
  std::optional<Eigen::Isometry3d> find_motion(const std::optional<Eigen::Isometry3d>& measured, double time);
  [[nodiscard]] std::optional<Link> find_nearest(const Candidate& candidate) const;
  void coast(const std::map<std::size_t, std::size_t>& heirs, double time, double step_s, const std::optional<FrameView>& view,
             std::vector<Track>& tracks, std::vector<Memory>& memories) const;
  [[nodiscard]] std::optional<double> typical_step() const;
  [[nodiscard]] int required_sightings() const;
  void judge(Track& track) const;

  TrackingParams params_;
  std::vector<Memory> memories_;
  std::optional<Step> last_step_;  // that was measured
  std::optional<double> placed_;   // s, the frame in which the memories' places are told: that of the last update
  std::vector<double> steps_;      // s, between the last calls
  std::optional<double> time_;
  int last_id_ = 0;
};

}  // namespace brink
