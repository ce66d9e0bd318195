#include "brink/detections.hpp"

#include <cmath>
#include <optional>
#include <vector>

#include <nlohmann/json.hpp>

#include "io/measure_fields.hpp"

namespace brink {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kMetreDigits = 4;
constexpr int kDegreeDigits = 3;
constexpr int kMotionDigits = 8;  // of current_from_previous: added up over thousands of frames
constexpr int kTimeDigits = 6;    // of seconds
constexpr int kMillisecondDigits = 3;
constexpr int kPixelDigits = 3;
constexpr int kShareDigits = 3;  // of what lies in 0..1

// The nearest decimal number of so many digits after the dot; null when there is none.
Json rounded(double value, int digits) {
  if (!std::isfinite(value)) return nullptr;
  const double scale = std::pow(10.0, digits);
  const double result = std::round(value * scale) / scale;
  return std::isfinite(result) ? result + 0.0 : value;  // + 0.0 turns -0 into 0
}

Json point(const Eigen::Vector3d& position) {
  Json numbers = Json::array();
  for (const double coordinate : position) numbers.push_back(rounded(coordinate, kMetreDigits));
  return numbers;
}

Json ground(const Detection& detection) {
  const GroundEstimate& estimate = detection.ground;
  Json json = {{"state", to_string(estimate.state)}};
  if (!estimate.reason.empty()) json["reason"] = estimate.reason;
  json["confidence"] = rounded(estimate.confidence, kShareDigits);
  if (estimate.is_carried) json["carried"] = true;
  const bool known = estimate.plane.has_value();
  json["height_m"] = known ? rounded(estimate.pose.height_m, kMetreDigits) : Json();
  json["pitch_deg"] = known ? rounded(estimate.pose.pitch_deg, kDegreeDigits) : Json();
  json["roll_deg"] = known ? rounded(estimate.pose.roll_deg, kDegreeDigits) : Json();
  if (detection.disparity_sd_px) json["disparity_sd_px"] = rounded(*detection.disparity_sd_px, kPixelDigits);
  return json;
}

// Type 2 is only inferred: nothing of the hole itself was measured. So is what this frame does not show.
const char* evidence(const NegativeObstacle& obstacle) {
  const bool observed = obstacle.candidate.type == CandidateType::below_ground && obstacle.unseen_s == 0.0;
  return observed ? "observed" : "inferred";
}

/// The pixels at which a closed chain of neighbouring pixels changes direction: filled, they are the same region in a fraction
/// of the text.
Json contour_corners(const std::vector<cv::Point>& chain) {
  Json corners = Json::array();
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const cv::Point& before = chain[(i + chain.size() - 1) % chain.size()];
    const cv::Point& after = chain[(i + 1) % chain.size()];
    if (chain.size() <= 2 || chain[i] - before != after - chain[i]) corners.push_back({chain[i].x, chain[i].y});
  }
  return corners;
}

Json measures(const Measures& measures) {
  Json json = Json::object();
  for (const MeasureField& field : kMeasureFields) json[field.name] = rounded(measures.*field.value, kShareDigits);
  return json;
}

Json obstacle(const NegativeObstacle& obstacle) {
  const Candidate& candidate = obstacle.candidate;
  Json json = {{"id", obstacle.id},
               {"type", to_string(candidate.type)},
               {"evidence", evidence(obstacle)},
               {"kind", to_string(candidate.kind)},
               {"rim_nearest", point(candidate.rim_nearest)},
               {"distance_m", rounded(candidate.distance_m, kMetreDigits)},
               {"bearing_deg", rounded(candidate.bearing_deg, kDegreeDigits)},
               {"nearest", point(candidate.nearest)},
               {"centroid", point(candidate.centroid)},
               {"depth_m", candidate.depth_m ? rounded(*candidate.depth_m, kMetreDigits) : Json()},
               {"width_m", rounded(candidate.width_m, kMetreDigits)},
               {"area_px", candidate.area_px},
               {"measures", measures(candidate.measures)},
               {"contour", contour_corners(candidate.contour)},
               {"track_length", obstacle.track_length}};
  if (!candidate.types.empty()) {
    Json types = Json::array();
    for (const CandidateType type : candidate.types) types.push_back(to_string(type));
    json["types"] = types;
  }
  if (obstacle.unseen_s > 0.0) json["unseen_s"] = rounded(obstacle.unseen_s, kTimeDigits);
  if (obstacle.time_to_edge_s) json["time_to_edge_s"] = rounded(*obstacle.time_to_edge_s, kTimeDigits);
  if (obstacle.probability) json["probability"] = rounded(*obstacle.probability, kShareDigits);
  return json;
}

Json obstacles(const std::vector<NegativeObstacle>& list) {
  Json json = Json::array();
  for (const NegativeObstacle& one : list) json.push_back(obstacle(one));
  return json;
}

Json rejected(const std::vector<Candidate>& list) {
  Json json = Json::array();
  for (const Candidate& candidate : list) {
    const Rejection rejection = candidate.rejection.value_or(Rejection{});
    json.push_back({{"type", to_string(candidate.type)},
                    {"rule", rejection.rule},
                    {"value", rounded(rejection.value, kMetreDigits)},
                    {"limit", rounded(rejection.limit, kMetreDigits)},
                    {"centroid", candidate.contour_3d.empty() ? Json() : point(candidate.centroid)},
                    {"area_px", candidate.area_px}});
  }
  return json;
}

Json ego_motion(const Detection& detection) {
  const EgoMotionEstimate& estimate = detection.ego_motion;
  Json json = {{"state", to_string(detection.ego_motion_state)}};
  if (!estimate.reason.empty()) json["reason"] = estimate.reason;
  if (detection.ego_motion_state == EgoMotionState::none) return json;
  json["matches"] = estimate.matches;
  json["inliers"] = estimate.inliers;
  if (!estimate.motion) return json;
  const Eigen::Matrix4d motion = estimate.motion->current_from_previous.matrix();
  Json rows = Json::array();
  for (const auto row : motion.rowwise()) {
    Json numbers = Json::array();
    for (const double number : row) numbers.push_back(rounded(number, kMotionDigits));
    rows.push_back(numbers);
  }
  json["current_from_previous"] = rows;
  return json;
}

Json times(const StageTimes& times) {
  return {{"disparity", rounded(times.disparity, kMillisecondDigits)},
          {"ground", rounded(times.ground, kMillisecondDigits)},
          {"below_ground", rounded(times.below_ground, kMillisecondDigits)},
          {"no_disparity", rounded(times.no_disparity, kMillisecondDigits)},
          {"ego_motion", rounded(times.ego_motion, kMillisecondDigits)},
          {"tracking", rounded(times.tracking, kMillisecondDigits)},
          {"total", rounded(times.total, kMillisecondDigits)}};
}

}  // namespace

std::string to_json_line(const Detection& detection) {
  Json json = {
      {"frame", detection.frame}, {"time", rounded(detection.time, kTimeDigits)}, {"status", to_string(detection.status)}};
  if (!detection.reason.empty()) json["reason"] = detection.reason;
  json["ground"] = ground(detection);
  json["ego_motion"] = ego_motion(detection);
  json["obstacles"] = obstacles(detection.obstacles);
  json["tracks"] = obstacles(detection.tracks);
  json["rejected"] = rejected(detection.rejected);
  if (!detection.no_disparity_off.empty()) json["no_disparity_off"] = detection.no_disparity_off;
  json["times_ms"] = times(detection.times);
  // File names in a reason may hold any bytes: what is no UTF-8 is replaced, a line of JSON must never fail.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace brink
