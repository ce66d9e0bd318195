#include "brink/detector.hpp"

#include <chrono>
#include <set>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_group.h>

#include "candidates/evidence.hpp"
#include "ego_motion/exchanged_eyes.hpp"
#include "ground/level.hpp"

namespace brink {
namespace {

constexpr double kLikelyAtOnce = 0.5;  // a picture alone must do: more likely than not

/// Milliseconds since the last call, or since it was made.
class Stopwatch {
 public:
  double lap_ms() {
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double, std::milli>(now - std::exchange(last_, now)).count();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

MotionHint get_motion(const Frame& frame, const Detection& detection) {
  MotionHint hint;
  if (detection.ego_motion.motion) hint.current_from_previous = detection.ego_motion.motion->current_from_previous;
  hint.current_from_previous_rotation = frame.current_from_previous_rotation;
  return hint;
}

void sort_out(std::vector<Candidate>&& selected, Detection& detection) {
  for (Candidate& candidate : selected) {
    (candidate.rejection ? detection.rejected : detection.candidates).push_back(std::move(candidate));
  }
}

/// Exchanged pictures show no ground, or a wrong one. Where it is seen well there is nothing to ask.
void mistrust_exchanged_eyes(const Frame& frame, const EgoMotionParams& params, GroundEstimate& ground) {
  if (ground.state == GroundState::seen) return;
  const std::string reason = find_exchanged_eyes(frame.left, frame.right, params);
  if (reason.empty()) return;
  ground = {};
  ground.reason = reason;
}

}  // namespace

DetectorParams DetectorParams::brink() { return {}; }

DetectorParams DetectorParams::paper() {
  DetectorParams params;
  params.disparity.elas = ElasParams::paper();
  params.ground = GroundParams::paper();
  params.candidates = CandidateParams::paper();
  params.tracking = TrackingParams::paper();
  params.report_slack_m = 0.0;
  params.path_width_m = 0.0;
  return params;
}

void DetectorParams::validate() const {
  disparity.validate();
  ground.validate();
  candidates.validate();
  ego_motion.validate();
  tracking.validate();
  if (!(path_width_m >= 0.0 && path_width_m <= 100.0)) {
    throw std::invalid_argument(fmt::format("detector.path_width_m = {}, must be 0 to 100", path_width_m));
  }
  if (!(report_range_m > 0.0 && report_range_m <= 1000.0)) {
    throw std::invalid_argument(fmt::format("detector.report_range_m = {}, must be above 0 to 1000", report_range_m));
  }
  if (!(report_slack_m >= 0.0 && report_slack_m <= 1000.0)) {
    throw std::invalid_argument(fmt::format("detector.report_slack_m = {}, must be 0 to 1000", report_slack_m));
  }
}

std::string to_string(FrameStatus status) {
  switch (status) {
    case FrameStatus::ok:
      return "ok";
    case FrameStatus::no_picture:
      return "no_picture";
    case FrameStatus::bad_frame:
      break;
  }
  return "bad_frame";
}

std::string to_string(EgoMotionState state) {
  switch (state) {
    case EgoMotionState::none:
      return "none";
    case EgoMotionState::ok:
      return "ok";
    case EgoMotionState::failed:
      return "failed";
    case EgoMotionState::given:
      return "given";
    case EgoMotionState::ground:
      break;
  }
  return "ground";
}

Detector::Detector(const DetectorParams& params)
    : params_(params), ground_tracker_(params.ground), ego_motion_(params.ego_motion), tracker_(params.tracking) {
  params.validate();
  matcher_ = make_stereo_matcher(params.disparity);
}

Detection Detector::process(const Frame& frame) {
  frame.validate();
  Detection detection;
  detection.frame = frame.index;
  detection.time = frame.time;
  if (frame.left.empty()) detection.no_disparity_off = "no left picture";
  Stopwatch whole;

  // III.C.1 Disparity map, unless it is given
  Stopwatch stage;
  detection.disparity = frame.disparity.empty() ? matcher_->compute(frame.left, frame.right) : frame.disparity;
  detection.times.disparity = stage.lap_ms();

  // III.C.4 Ego-motion, which needs no disparities: beside the search for planes
  tbb::task_group beside;
  beside.run([&] {
    Stopwatch alone;
    estimate_ego_motion(frame, detection);
    detection.times.ego_motion = alone.lap_ms();
  });

  // III.C.2 Ground surface
  if (params_.stills) ground_tracker_ = GroundTracker(params_.ground);
  if (params_.ground.track) {
    ground_tracker_.search(detection.disparity, frame.camera, frame.gravity);
    beside.wait();
    detection.ground = ground_tracker_.update(get_motion(frame, detection), frame.time);
  } else {
    detection.ground = estimate_ground(detection.disparity, frame.camera, params_.ground, frame.gravity);
  }
  mistrust_exchanged_eyes(frame, params_.ego_motion, detection.ground);
  if (detection.ground.plane) {
    GroundSurface ground = make_flat_surface(detection.ground, detection.disparity, frame.camera);
    if (params_.ground.follow) ground = follow_ground(detection.disparity, ground, frame.camera, params_.ground);
    detection.disparity_sd_px = ground.disparity_sd_px;
    detection.elevation = compute_elevation(detection.disparity, ground, frame.camera);
    detection.times.ground = stage.lap_ms();

    // III.C.3 Candidates: Type 1 beside Type 2, for which there must be a picture
    std::vector<Candidate> below_ground;
    std::vector<Candidate> no_disparity;
    tbb::parallel_invoke(
        [&] {
          Stopwatch type;
          below_ground = select_below_ground(frame, detection.disparity, detection.elevation, ground, params_.candidates);
          detection.times.below_ground = type.lap_ms();
        },
        [&] {
          Stopwatch type;
          no_disparity = select_no_disparity(frame, detection.disparity, detection.elevation, ground, params_.candidates);
          detection.times.no_disparity = type.lap_ms();
        });
    sort_out(std::move(below_ground), detection);
    sort_out(std::move(no_disparity), detection);
    stage.lap_ms();
    // Our own: one hole, one obstacle
    detection.candidates = merge_parts(std::move(detection.candidates), detection.elevation, detection.ground.pose,
                                       frame.camera, params_.candidates);
    detection.times.tracking = stage.lap_ms();
  } else {
    detection.times.ground = stage.lap_ms();
  }

  // III.C.4 Tracking and validation
  beside.wait();
  stage.lap_ms();
  align_grounds(frame, detection);
  report(frame, detection);
  detection.times.tracking += stage.lap_ms();
  detection.times.total = whole.lap_ms();
  return detection;
}

Detection Detector::process_failed(int frame, double time, FrameStatus status, const std::string& reason) {
  if (!params_.stills) tracker_.miss(time);
  return make_failed_detection(frame, time, status, reason);
}

void Detector::estimate_ego_motion(const Frame& frame, Detection& detection) {
  if (params_.stills) return;
  const std::optional<Eigen::Isometry3d> last = std::exchange(last_world_from_camera_, frame.world_from_camera);
  if (last && frame.world_from_camera) {
    ego_motion_ = EgoMotionEstimator(params_.ego_motion);  // what it remembers is no longer the last frame
    detection.ego_motion_state = EgoMotionState::given;
    detection.ego_motion.motion = EgoMotion{.current_from_previous = frame.world_from_camera->inverse() * *last};
    return;
  }
  detection.ego_motion = ego_motion_.estimate(frame);
  detection.ego_motion_state = detection.ego_motion.motion ? EgoMotionState::ok : EgoMotionState::failed;
}

// Without a picture the motion cannot be measured; what both grounds tell of it is enough to follow what is seen from frame to
// frame. Never in place of a measurement that failed.
void Detector::align_grounds(const Frame& frame, Detection& detection) {
  std::optional<GroundPose> ground;
  if (detection.ground.plane && !detection.ground.is_carried) ground = detection.ground.pose;
  const std::optional<GroundPose> last = std::exchange(last_ground_, ground);
  const bool wanted = detection.ego_motion_state == EgoMotionState::failed && frame.left.empty();
  if (!wanted) return;
  if (!last || !ground) {
    detection.ego_motion.reason = "no left picture, and not a ground in both this frame and the last one";
    return;
  }
  detection.ego_motion = {};
  detection.ego_motion.motion = EgoMotion{.current_from_previous = compute_ground_motion(*last, *ground)};
  detection.ego_motion_state = EgoMotionState::ground;
}

void Detector::report(const Frame& frame, Detection& detection) {
  if (params_.stills) {  // without a past there is nothing to validate with
    const auto compute_still_probability = [this](const Candidate& candidate) -> std::optional<double> {
      if (params_.tracking.min_probability <= 0.0) return std::nullopt;
      return to_probability(compute_evidence(candidate));
    };
    for (const Candidate& candidate : detection.candidates) {
      const NegativeObstacle obstacle{.id = static_cast<int>(detection.obstacles.size() + detection.tracks.size()) + 1,
                                      .candidate = candidate,
                                      .track_length = 1,
                                      .unseen_s = 0.0,
                                      .probability = compute_still_probability(candidate),
                                      .time_to_edge_s = std::nullopt};
      const bool likely = obstacle.probability.value_or(1.0) >= kLikelyAtOnce;
      (likely && candidate.distance_m <= params_.report_range_m ? detection.obstacles : detection.tracks).push_back(obstacle);
    }
    return;
  }
  std::optional<Eigen::Isometry3d> current_from_previous;
  if (detection.ego_motion.motion) current_from_previous = detection.ego_motion.motion->current_from_previous;
  std::optional<FrameView> view;
  if (detection.ground.plane) {
    view = FrameView{.camera = frame.camera,
                     .ground = detection.ground.pose,
                     .level = select_level(detection.elevation, params_.candidates.ground_tolerance_m),
                     .below = cv::Mat1b(detection.elevation <= -params_.candidates.min_depth_m),
                     .is_ground_shown = !detection.ground.is_carried};
  }
  walk_.update(current_from_previous, frame.time);
  const auto time_to_edge = [&](const Candidate& candidate) -> std::optional<double> {
    const std::optional<Eigen::Vector3d> velocity = walk_.velocity();
    if (params_.path_width_m <= 0.0 || !velocity || !view) return std::nullopt;
    return compute_time_to_edge(candidate.rim, *velocity, view->ground, params_.path_width_m);
  };
  std::set<int> reported;
  for (const Track& track : tracker_.update(detection.candidates, current_from_previous, frame.time, view)) {
    const NegativeObstacle obstacle{.id = track.id,
                                    .candidate = track.candidate,
                                    .track_length = track.length,
                                    .unseen_s = track.unseen_s,
                                    .probability = track.probability,
                                    .time_to_edge_s = time_to_edge(track.candidate)};
    const bool told_before = reported_.contains(track.id);
    const double range_m = params_.report_range_m + (told_before ? params_.report_slack_m : 0.0);
    const bool seen_or_told = track.unseen_s == 0.0 || told_before;  // a memory is no news
    if (track.validated && seen_or_told && track.candidate.distance_m <= range_m) {
      reported.insert(track.id);
      detection.obstacles.push_back(obstacle);
    } else {
      detection.tracks.push_back(obstacle);
    }
  }
  reported_ = std::move(reported);
}

Detection make_failed_detection(int frame, double time, FrameStatus status, const std::string& reason) {
  Detection detection;
  detection.frame = frame;
  detection.time = time;
  detection.status = status;
  detection.reason = reason;
  detection.ground.reason = reason;
  detection.ego_motion_state = EgoMotionState::failed;
  detection.ego_motion.reason = reason;
  return detection;
}

}  // namespace brink
