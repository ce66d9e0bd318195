#include "brink/detector.hpp"

#include <chrono>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace brink {
namespace {

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

void sort_out(std::vector<Candidate>&& selected, Detection& detection) {
  for (Candidate& candidate : selected) {
    (candidate.rejection ? detection.rejected : detection.candidates).push_back(std::move(candidate));
  }
}

/// Without a past there is nothing to validate with: a still's candidates are its obstacles, or tracks of one sighting.
void report_single_frame(Detection& detection, const DetectorParams& params) {
  int id = 0;
  for (const Candidate& candidate : detection.candidates) {
    const bool report = params.stills && candidate.distance_m <= params.report_range_m;
    (report ? detection.obstacles : detection.tracks).push_back({++id, candidate, 1});
  }
}

}  // namespace

DetectorParams DetectorParams::brink() { return {}; }

DetectorParams DetectorParams::paper() {
  DetectorParams params;
  params.disparity.elas = ElasParams::paper();
  params.candidates = CandidateParams::paper();
  return params;
}

void DetectorParams::validate() const {
  disparity.validate();
  ground.validate();
  candidates.validate();
  ego_motion.validate();
  if (!(report_range_m > 0.0 && report_range_m <= 1000.0)) {
    throw std::invalid_argument(fmt::format("detector.report_range_m = {}, must be above 0 to 1000", report_range_m));
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

Detector::Detector(const DetectorParams& params) : params_(params) {
  params.validate();
  matcher_ = make_stereo_matcher(params.disparity);
}

Detection Detector::process(const Frame& frame) {
  Detection detection;
  detection.frame = frame.index;
  detection.time = frame.time;
  Stopwatch whole;
  Stopwatch stage;

  // III.C.1 Disparity map
  detection.disparity = matcher_->compute(frame.left, frame.right);
  detection.times.disparity = stage.lap_ms();

  // III.C.2 Ground surface
  detection.ground = estimate_ground(detection.disparity, frame.camera, params_.ground, frame.gravity);
  if (detection.ground.plane) {
    const GroundPlane& ground = *detection.ground.plane;
    detection.elevation = compute_elevation(detection.disparity, ground, frame.camera);
    detection.times.ground = stage.lap_ms();

    // III.C.3 Candidates: Type 1, then Type 2
    sort_out(select_below_ground(frame, detection.disparity, detection.elevation, ground, params_.candidates), detection);
    detection.times.below_ground = stage.lap_ms();
    sort_out(select_no_disparity(frame, detection.disparity, detection.elevation, ground, params_.candidates), detection);
    detection.times.no_disparity = stage.lap_ms();
  } else {
    detection.times.ground = stage.lap_ms();
  }

  // III.C.4 Tracking and validation: not for stills
  report_single_frame(detection, params_);
  detection.times.total = whole.lap_ms();
  return detection;
}

Detection make_failed_detection(int frame, double time, FrameStatus status, const std::string& reason) {
  Detection detection;
  detection.frame = frame;
  detection.time = time;
  detection.status = status;
  detection.reason = reason;
  detection.ground.reason = reason;
  return detection;
}

}  // namespace brink
