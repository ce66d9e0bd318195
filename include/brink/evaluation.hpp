#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "brink/detector.hpp"
#include "brink/truth.hpp"

namespace brink {

/// The protocol of docs/evaluation.md, with its numbers.
struct EvaluationParams {
  double min_depth_m = 0.15;      ///< instances that are shallower are "don't care"
  double max_range_m = 5.0;       ///< instances whose rim is farther are "don't care"; detections farther away do not count
  double first_range_m = 8.0;     ///< an instance appears when its rim comes nearer than this
  int min_visible_px = 150;       ///< ... and this many of its pixels are seen
  int dilation_px = 5;            ///< masks are widened by this
  double settle_s = 0.35;         ///< settled rates leave out this long after an instance appears
  double gone_s = 1.0;            ///< an instance that was out of view for this long appears anew: another approach
  int validation_sightings = 5;   ///< sightings that a track needs: gives the ceiling of the raw rate
  double event_range_m = 3.0;     ///< an approach that comes nearer than this is an event
  double warn_range_m = 2.0;      ///< warned in time: validated at this distance or farther
  double warn_delay_s = 0.5;      ///< ... or this soon after an instance that appears nearer than that
  double ahead_range_m = 2.0;     ///< the last metres: an edge lies ahead when its nearest rim point is within this
  double ahead_deg = 60.0;        ///< ... and within this of where the camera looks, in the ground plane
  double claim_error_m = 0.3;     ///< there, an obstacle that is off by no more than this reports an edge, too
  double dropped_s = 0.3;         ///< a warning that is silent for this long there has been dropped
  double episode_radius_m = 0.5;  ///< false detections this near to each other are one episode
  double episode_gap_s = 0.5;     ///< ... and this soon after each other
  int block_frames = 15;          ///< frames are resampled in blocks, as neighbours tell the same
  int resamplings = 2000;         ///< of the bootstrap
  int seed = 1;                   ///< of the bootstrap
  void validate() const;          ///< @throws std::invalid_argument "evaluation.name = value, must be ..."
};

/// Counts that rates are made of.
struct Counts {
  int tp = 0;  ///< instances that were hit
  int fn = 0;  ///< instances that were not
  int fp = 0;  ///< detections that hit nothing and lie on nothing that is "don't care"
  Counts& operator+=(const Counts& other);
  /// TP/(TP+FN). Empty without an instance.
  [[nodiscard]] std::optional<double> tpr() const;
  /// TP/(TP+FP). Empty without a detection.
  [[nodiscard]] std::optional<double> ppv() const;
};

/// What the detections of one frame hit (evaluation.md, "Detection, per frame").
struct FrameMatch {
  std::vector<std::vector<int>> hits;  ///< for each detection, the counted ids that it hits, ascending
  std::vector<bool> is_false;          ///< for each detection: counts as FP
  int fragments = 0;                   ///< detections beyond the first on the same counted instance
};
/// A detection hits instance k if at least half of its pixels lie in k's mask dilated by a disc of radius dilation_px; or its
/// IoU with k's mask is at least 0.25; or at least half of it lies in U, the union of the dilated masks of the counted
/// instances, and it covers at least half of k's mask. It is an FP if it hits nothing, less than half of it lies in U, and less
/// than half of it lies in the union of what is not labelled and the dilated masks that do not count. One without pixels is
/// neither.
/// @param regions one mask for each detection, of the size of `negative`, not 0 = inside.
/// @param counted ids that count; every other id in `negative` is "don't care".
/// @throws std::invalid_argument when sizes differ or dilation_px is negative.
FrameMatch match_frame(const cv::Mat1b& negative, const std::vector<cv::Mat1b>& regions, const std::vector<int>& counted,
                       int dilation_px);

/// The filled contour of an obstacle. @return mask of `size`, 255 inside; parts outside of the picture are cut off.
cv::Mat1b fill_contour(const std::vector<cv::Point>& contour, const cv::Size& size);

/// One truth instance in one frame. It is *present* when min_visible_px of it are seen and its rim, if its distance is known,
/// is within first_range_m.
struct InstanceScore {
  int id = 0;
  int visible_px = 0;
  std::optional<double> distance_m;
  bool raw = false;          ///< counts in the raw rates: present, min_depth_m deep, within max_range_m; unknown = deep, near
  bool settled = false;      ///< counts in the settled rates: raw, and settle_s or more after it appeared
  bool reachable = false;    ///< present in the last validation_sightings frames: a track that never misses could be validated
  bool hit = false;          ///< counts in the raw rates and at least one detection hits it, by the rules for that set
  bool settled_hit = false;  ///< the same for the settled rates
  std::optional<double> depth_m;
  /// By the envelope (envelope.hpp) its Type 1 region passes every rule, now and in the last validation_sightings frames, as a
  /// track needs. Empty when its opening, the camera or the noise of the disparities is not known.
  std::optional<bool> expected;
};

/// One detection in one frame.
struct DetectionScore {
  int id = 0;                               ///< of the obstacle
  std::vector<int> hits;                    ///< ids that it hits if all count, "don't care" ones too
  bool raw_false = false;                   ///< FP in the raw rates
  bool settled_false = false;               ///< FP in the settled rates
  double distance_m = 0.0;                  ///< as it claims
  std::optional<double> distance_error_m;   ///< claimed less true; empty when it hits nothing or truth tells no distance
  std::optional<double> bearing_error_deg;  ///< likewise, -180..180
  std::optional<double> probability;        ///< as it claims
  std::optional<int> episode;               ///< of false alarms, index in SequenceScore::episodes
  /// As it claims; empty in scores of older versions.
  std::optional<ObstacleKind> kind;
  /// Of what it hits; empty when that is nothing, of two kinds, or of a kind that is not known.
  std::optional<ObstacleKind> true_kind;
};

/// An instance, min_depth_m deep and seen before or now, whose edge lies ahead of the bearer in one frame: its nearest rim
/// point, seen or not, is within ahead_range_m and ahead_deg, and the bearer has not passed it.
struct EdgeAhead {
  int id = 0;
  double distance_m = 0.0;  ///< true distance of the nearest rim point, seen or not
  bool settled = false;     ///< settle_s or more after it appeared on this approach
  bool reported = false;    ///< a detection hits it, or one that hits nothing is right about its distance
  bool warned = false;      ///< reported in this frame or in an earlier one of the same approach
  bool dropped = false;     ///< a silence after a warning reaches dropped_s in this frame
};

/// Counts over the frames in which edges lie ahead.
struct AheadCounts {
  int settled = 0;        ///< settled edges
  int reported = 0;       ///< of these reported
  int warned = 0;         ///< edges from the first warning of their approach on
  int held = 0;           ///< of these reported
  int dropped = 0;        ///< dropped warnings
  int frames = 0;         ///< frames with at least one settled edge
  int silent_frames = 0;  ///< of these in false silence: the ground is seen, and no obstacle is reported
  AheadCounts& operator+=(const AheadCounts& other);
};

struct FrameScore {
  int frame = 0;
  double time = 0.0;  ///< s
  FrameStatus status = FrameStatus::ok;
  GroundState ground = GroundState::not_visible;
  std::vector<InstanceScore> instances;
  std::vector<DetectionScore> detections;  ///< the obstacles within max_range_m
  int fragments = 0;                       ///< of the raw rates
  /// Empty in scores of older versions.
  std::optional<std::vector<EdgeAhead>> edges_ahead = std::nullopt;
  [[nodiscard]] Counts raw() const;
  [[nodiscard]] Counts settled() const;
  [[nodiscard]] AheadCounts ahead() const;
};

/// One instance, min_depth_m deep, on one approach that comes nearer than event_range_m. An approach begins when the instance
/// is present for the first time, or again after gone_s without being present.
struct ApproachEvent {
  int id = 0;
  int first_frame = 0;                      ///< where it appears
  double first_distance_m = 0.0;            ///< true distance there
  double nearest_m = 0.0;                   ///< smallest true distance of the approach
  std::optional<int> warned_frame;          ///< first frame in which a detection hits it; empty = missed
  std::optional<double> warned_distance_m;  ///< true distance there
  std::optional<double> lead_time_s;        ///< from there to the smallest distance; 0 when that lies before
  bool in_time = false;  ///< warned_distance_m >= warn_range_m, or first_distance_m below that and warned within warn_delay_s
  /// Share of the frames with the edge ahead, from the first warning on, in which it is reported. Empty when there is no such
  /// frame, and in scores of older versions.
  std::optional<double> held = std::nullopt;
};

/// False detections (of the settled rates) at the same place, whatever their ids: each joins the episode whose last place is
/// nearest, within episode_radius_m, among those that are no older than episode_gap_s.
struct Episode {
  int first_frame = 0;
  int last_frame = 0;
  int detections = 0;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< last rim_nearest, world, m
};

/// All that the evaluation of one sequence tells; rates follow from it by summarise.
struct SequenceScore {
  std::string name;
  double duration_s = 0.0;         ///< frames times the median step of time
  std::optional<double> walked_m;  ///< length of the true path, which the head's bobbing does not lengthen; empty without poses
  std::vector<FrameScore> frames;
  std::vector<ApproachEvent> events;  ///< in order of their beginning; none where truth tells no distances
  std::vector<Episode> episodes;  ///< in order of their beginning; empty, too, without poses: then nothing can be said of them
};

class LastMetres;

/// Goes through one sequence, frame by frame in order of time, with its truth beside it.
class SequenceEvaluator {
 public:
  /// @throws std::invalid_argument when the parameters are not valid.
  /// @param rules that the detections were made with: what the envelope goes by.
  explicit SequenceEvaluator(std::string name, const EvaluationParams& params = {}, const CandidateParams& rules = {});

  ~SequenceEvaluator();
  SequenceEvaluator(const SequenceEvaluator&) = delete;
  SequenceEvaluator& operator=(const SequenceEvaluator&) = delete;

  /// @throws std::invalid_argument when the frame numbers differ, frames or times do not increase, or an obstacle's contour
  /// leaves
  ///         the picture: those are detections of something else.
  void add(const FrameTruth& truth, const Detection& detection);

  /// The score of all frames so far.
  [[nodiscard]] SequenceScore finish() const;

 private:
  // An instance from where it appears to where it is gone.
  struct Approach {
    ApproachEvent event;
    bool is_event = false;  // deep enough, and its distance is known
    double start = 0.0;     // s
    double last_seen = 0.0;
    double nearest_time = 0.0;
    double warned_time = 0.0;
    std::size_t last_index = 0;  // of the frame in which it was seen last
    int sightings = 0;           // frames in a row up to that
    int expected_sightings = 0;  // of these the last ones in a row in which the envelope has it seen
    int warned = 0;              // frames with the edge ahead, from the first warning on
    int held = 0;                // of these reported
  };
  // What one detection hits, by the rules.
  struct Judgement {
    std::vector<int> hits;
    bool raw_false = false;
    bool settled_false = false;
  };
  Approach& follow(const VisibleInstance& instance, int frame, double time);
  InstanceScore score_instance(const VisibleInstance& instance, const FrameTruth& truth, const Detection& detection);
  DetectionScore score_detection(const NegativeObstacle& obstacle, const Judgement& judgement, const FrameTruth& truth);
  void note_warnings(const FrameTruth& truth, const FrameMatch& match);
  void note_edges(const std::vector<EdgeAhead>& edges);
  void note_false_alarm(DetectionScore& detection, const Eigen::Vector3d& place, const FrameTruth& truth);

  EvaluationParams params_;
  CandidateParams rules_;
  SequenceScore score_;
  std::vector<Approach> approaches_;            // in order of their beginning
  std::map<int, std::size_t> latest_approach_;  // by id, index in approaches_
  std::unique_ptr<LastMetres> last_metres_;
  std::vector<double> episode_times_;       // s, when each of the episodes was last seen
  std::vector<double> position_times_;      // s
  std::vector<Eigen::Vector3d> positions_;  // of the camera at those times, world, m
};

/// A figure with its 95 % interval.
struct Estimate {
  double value = 0.0;
  double low = 0.0;
  double high = 0.0;
};

/// Rim distances are asked to be exact within this, m.
inline constexpr double kNearRange = 3.0;

/// The tables. Empty optionals: there was nothing to count.
struct EvaluationSummary {
  int sequences = 0;
  int frames = 0;
  double minutes = 0.0;
  Counts raw, settled;
  int instances = 0;  ///< of the raw counts: TP + FN
  int fragments = 0;
  std::optional<Estimate> raw_tpr, raw_ppv, settled_tpr, settled_ppv;
  std::optional<double> raw_ceiling;  ///< greatest raw TPR that a track of validation_sightings can reach
  struct RangeBin {
    double from_m = 0.0;
    double to_m = 0.0;
    Counts raw, settled;  ///< fp unused
  };
  std::vector<RangeBin> recall_by_range;  ///< 1 m wide, 0 to max_range_m
  /// Settled instances whose distance and depth are known. Only bins with any, by range, then by depth.
  struct DepthBin {
    double from_m = 0.0;  ///< distance
    double to_m = 0.0;
    double from_depth_m = 0.0;
    double to_depth_m = 0.0;  ///< infinite for the last one
    Counts settled;           ///< fp unused
    int judged = 0;           ///< of them the envelope could be asked about
    int judged_hits = 0;      ///< of these hit
    int expected = 0;         ///< of these expected to be hit
  };
  std::vector<DepthBin> recall_by_depth;
  int events = 0;
  int missed = 0;
  int late = 0;                            ///< warned, not in time
  std::optional<Estimate> warned_in_time;  ///< share of the events
  std::optional<double> first_warning_min_m, first_warning_median_m, lead_time_min_s, lead_time_median_s;
  /// The last metres. Shares are empty without an edge ahead; dropped_per_minute, of the recording, without poses; all of them
  /// for scores of older versions.
  AheadCounts ahead;
  std::optional<Estimate> reported_ahead;  ///< share of the settled edges ahead that are reported
  std::optional<Estimate> held, dropped_per_minute;
  std::optional<Estimate> false_silence;  ///< share of the frames with a settled edge ahead
  std::optional<double> held_min;         ///< of the events
  int episodes = 0;
  std::optional<Estimate> episodes_per_minute, episodes_per_100m;  ///< empty without poses
  std::optional<double> distance_error_median_m, distance_error_p95_m, bearing_error_median_deg, bearing_error_p95_deg;
  int localised = 0;                                                              ///< detections that these come from
  std::optional<double> near_distance_error_median_m, near_distance_error_p95_m;  ///< within kNearRange by the truth
  int near_localised = 0;                                                         ///< detections that these come from
  std::map<std::string, int> frame_status;                                        ///< "ok", ...: frames
  std::map<std::string, int> ground_state;                                        ///< "seen", ...: frames that are ok
  struct ProbabilityBin {
    double from = 0.0;
    double to = 0.0;
    int detections = 0;
    double mean_probability = 0.0;
    double hit_share = 0.0;
  };
  std::vector<ProbabilityBin> calibration;  ///< tenths; empty when no detection tells a probability
  std::optional<double> expected_calibration_error;
  /// By true kind and by the kind that was told, the detections of which both are known; and the share that is told right. Not
  /// to know counts as wrong.
  std::map<std::string, std::map<std::string, int>> kinds;
  std::optional<double> kind_accuracy;
};
/// Pools sequences: counts are added, blocks of frames and events resampled.
/// @throws std::invalid_argument when there is no sequence or the parameters are not valid.
EvaluationSummary summarise(const std::vector<SequenceScore>& sequences, const EvaluationParams& params = {});

/// Sequences of one domain, as simulated stairs or recordings of one camera.
struct DomainSummary {
  std::string name;  ///< that of its sequences up to the last underscore; the whole name where there is none
  EvaluationSummary summary;
};
/// Sequences pooled by domain, in the order in which the domains first appear. A pooled figure hides the domain that fails.
/// @throws std::invalid_argument as summarise does.
std::vector<DomainSummary> summarise_by_domain(const std::vector<SequenceScore>& sequences,
                                               const EvaluationParams& params = {});

/// One figure of two runs over the same sequences.
struct Comparison {
  std::string name;  ///< "settled TPR", ...
  double a = 0.0;
  double b = 0.0;
  Estimate difference;  ///< b - a, from paired resampling: the same blocks, the same events
  bool more_is_better = true;
  /// The whole interval lies on the wrong side of 0.
  [[nodiscard]] bool is_worse() const { return more_is_better ? difference.high < 0.0 : difference.low > 0.0; }
};
/// Raw and settled TPR and PPV, share of events warned in time, the four figures of the last metres, false-alarm episodes per
/// minute, distance error (median). What one of both does not have is left out.
/// @throws std::invalid_argument when the runs are not of the same sequences, frames and events.
std::vector<Comparison> compare(const std::vector<SequenceScore>& a, const std::vector<SequenceScore>& b,
                                const EvaluationParams& params = {});

/// Scores as JSON, whole, so that they can be compared later. Reading gives back the same numbers, bit by bit.
std::string to_json(const std::vector<SequenceScore>& sequences, const EvaluationParams& params);

/// What to_json wrote.
struct StoredScores {
  std::vector<SequenceScore> sequences;
  EvaluationParams params;
};
/// @throws std::runtime_error "path: field = value, expected ..." when the file is not what to_json writes, in one line.
StoredScores read_scores(const std::string& path);

/// Disparities against their truth, over the pixels of known truth (Middlebury, KITTI).
struct DisparityErrors {
  int known_px = 0;
  double density = 0.0;  ///< share of the known pixels that have a disparity, 0..1
  // Shares of the valid pixels that are off by more than 1, 2, 3 px; 0 when none is valid.
  double bad_1 = 0.0, bad_2 = 0.0, bad_3 = 0.0;
  // The same of all known pixels, an invalid one counting as off.
  double bad_1_or_invalid = 0.0, bad_2_or_invalid = 0.0, bad_3_or_invalid = 0.0;
  double mean_error_px = 0.0;  ///< of the valid ones
};
/// @param disparity px, kInvalidDisparity = none. @param truth px, 0 = not known. @param mask where it is 0 a pixel does not
///        count; empty = all count.
/// @throws std::invalid_argument when sizes differ or no pixel is known.
DisparityErrors compute_disparity_errors(const cv::Mat1f& disparity, const cv::Mat1f& truth, const cv::Mat1b& mask = {});

}  // namespace brink
