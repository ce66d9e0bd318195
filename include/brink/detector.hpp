#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "brink/candidates.hpp"
#include "brink/disparity.hpp"
#include "brink/ego_motion.hpp"
#include "brink/frame.hpp"
#include "brink/ground.hpp"
#include "brink/ground_tracking.hpp"
#include "brink/tracking.hpp"
#include "brink/walking.hpp"

namespace brink {

/// Every parameter of the whole of section III.C.
struct DetectorParams {
  DisparityParams disparity;
  GroundParams ground;
  CandidateParams candidates;
  EgoMotionParams ego_motion;
  TrackingParams tracking;
  double report_range_m = 5.0;  ///< obstacles are reported up to this distance of their rim in the ground plane
  double report_slack_m = 0.5;  ///< ... and, once they were, up to this much farther: no flicker at the limit
  double path_width_m = 0.6;    ///< time to edge: the strip of ground that a bearer walks on; 0 = it is not told
  bool stills = false;          ///< the frames are unrelated: what is in range and more likely there than not is an obstacle at
                                ///< once, track_length 1;
                                ///< no ego-motion, no tracking

  static DetectorParams brink();  ///< whatever measures best: the defaults
  static DetectorParams paper();  ///< the paper's rules to the letter
  void validate() const;          ///< of all parts @throws std::invalid_argument
};

enum class FrameStatus : std::uint8_t {
  ok,
  no_picture,  ///< a picture is missing
  bad_frame,   ///< it is there but cannot be processed
};
std::string to_string(FrameStatus status);

/// A negative obstacle that is reported, or a track on its way to become one.
struct NegativeObstacle {
  int id = 0;  ///< unique in its run; for stills unique in its frame
  Candidate candidate;
  int track_length = 1;                  ///< sightings in a row
  double unseen_s = 0.0;                 ///< since the last sighting; > 0: it is remembered, not seen in this frame
  std::optional<double> probability;     ///< that it is there, 0..1; empty when it is not known
  std::optional<double> time_to_edge_s;  ///< compute_time_to_edge; empty, too, where motion or ground is not known
};

/// Wall-clock time of each stage, ms.
struct StageTimes {
  double disparity = 0.0;
  double ground = 0.0;  ///< with the elevation image
  double below_ground = 0.0;
  double no_disparity = 0.0;  ///< runs beside below_ground
  double ego_motion = 0.0;    ///< runs beside ground, below_ground and no_disparity
  double tracking = 0.0;      ///< with the merging of parts
  double total = 0.0;
};

/// Where the motion of the camera since the last frame comes from.
enum class EgoMotionState : std::uint8_t {
  none,    ///< not asked for: stills
  ok,      ///< measured in the pictures
  failed,  ///< could not be measured; ego_motion.reason tells why
  given,   ///< from outside: Frame::world_from_camera
  ground,  ///< without a left picture: the motion that aligns the grounds of both frames, heading and place being unknown
};
std::string to_string(EgoMotionState state);

/// What one frame told, with every intermediate, so that overlays, evaluation and benchmarks need no second pipeline.
struct Detection {
  int frame = 0;
  double time = 0.0;  ///< s
  FrameStatus status = FrameStatus::ok;
  std::string reason;  ///< why status is not ok

  cv::Mat1f disparity;  ///< px, kInvalidDisparity = none; Frame::disparity if given; empty when status is not ok
  GroundEstimate ground;
  /// GroundSurface::disparity_sd_px, px: what drops must stand out of. Empty when the ground is not visible.
  std::optional<double> disparity_sd_px;
  EgoMotionState ego_motion_state = EgoMotionState::none;
  EgoMotionEstimate ego_motion;             ///< since the last frame that was processed
  cv::Mat1f elevation;                      ///< m, NaN = none; empty when the ground is not visible
  std::vector<Candidate> candidates;        ///< passed every rule
  std::vector<Candidate> rejected;          ///< failed one, each with its rejection
  std::string no_disparity_off;             ///< why Type 2 cannot be looked for in such frames; empty when it can
  std::vector<NegativeObstacle> obstacles;  ///< validated and within report_range_m (and slack)
  std::vector<NegativeObstacle> tracks;     ///< seen but not validated, or farther
  StageTimes times;
};

/// The whole of section III.C, for the frames of one sequence in order. Keeps scratch memory and what one frame hands to the
/// next.
class Detector {
 public:
  /// @throws std::invalid_argument when the parameters are not valid.
  explicit Detector(const DetectorParams& params = {});

  /// Frame in, detection out.
  /// @return status ok, with ground.state told; no candidates when the ground is not visible.
  /// @throws std::invalid_argument when the frame is not one that make_frame or make_frame_with_disparity would return, and,
  ///         unless params.stills, when its time is not after the last one's.
  [[nodiscard]] Detection process(const Frame& frame);

  /// A frame that could not be read or processed. Nothing is told of it but that; tracks outlive it for tracking.max_blind_s.
  /// @param status not ok. @throws std::invalid_argument as process does for the time.
  [[nodiscard]] Detection process_failed(int frame, double time, FrameStatus status, const std::string& reason);

 private:
  void estimate_ego_motion(const Frame& frame, Detection& detection);
  void align_grounds(const Frame& frame, Detection& detection);
  void report(const Frame& frame, Detection& detection);

  DetectorParams params_;
  std::unique_ptr<StereoMatcher> matcher_;
  GroundTracker ground_tracker_;
  EgoMotionEstimator ego_motion_;
  Tracker tracker_;
  WalkEstimator walk_;
  std::optional<Eigen::Isometry3d> last_world_from_camera_;  // given with the last frame
  std::optional<GroundPose> last_ground_;                    // of the last frame; empty when it was not visible
  std::set<int> reported_;                                   // ids of the last frame's obstacles
};

/// The answer for a frame that could not be read or processed. @param status not ok.
Detection make_failed_detection(int frame, double time, FrameStatus status, const std::string& reason);

}  // namespace brink
