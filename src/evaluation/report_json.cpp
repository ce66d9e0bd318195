#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "brink/evaluation_report.hpp"

namespace brink {
namespace {

using Json = nlohmann::ordered_json;

Json number(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

Json estimate(const std::optional<Estimate>& value) {
  if (!value) return {};
  return {{"value", value->value}, {"low", value->low}, {"high", value->high}};
}

Json counts(const Counts& value) { return {{"tp", value.tp}, {"fn", value.fn}, {"fp", value.fp}}; }

Json spread(const MeanAndDeviation& value) { return {{"mean", value.mean}, {"deviation", value.deviation}}; }

Json ranges(const EvaluationSummary& summary) {
  Json bins = Json::array();
  for (const EvaluationSummary::RangeBin& bin : summary.recall_by_range) {
    bins.push_back({{"from_m", bin.from_m},
                    {"to_m", bin.to_m},
                    {"raw", {{"tp", bin.raw.tp}, {"fn", bin.raw.fn}}},
                    {"settled", {{"tp", bin.settled.tp}, {"fn", bin.settled.fn}}}});
  }
  return bins;
}

Json depths(const EvaluationSummary& summary) {
  Json bins = Json::array();
  for (const EvaluationSummary::DepthBin& bin : summary.recall_by_depth) {
    bins.push_back({{"from_m", bin.from_m},
                    {"to_m", bin.to_m},
                    {"from_depth_m", bin.from_depth_m},
                    {"to_depth_m", bin.to_depth_m},  // JSON has no infinity: null
                    {"settled", {{"tp", bin.settled.tp}, {"fn", bin.settled.fn}}},
                    {"envelope", {{"judged", bin.judged}, {"hits", bin.judged_hits}, {"expected", bin.expected}}}});
  }
  return bins;
}

Json calibration(const EvaluationSummary& summary) {
  Json bins = Json::array();
  for (const EvaluationSummary::ProbabilityBin& bin : summary.calibration) {
    bins.push_back({{"from", bin.from},
                    {"to", bin.to},
                    {"detections", bin.detections},
                    {"mean_probability", bin.mean_probability},
                    {"hit_share", bin.hit_share}});
  }
  return bins;
}

std::string finished(const Json& json) { return json.dump(2) + "\n"; }

}  // namespace

std::string to_json(const EvaluationSummary& summary) {
  return finished(
      {{"sequences", summary.sequences},
       {"frames", summary.frames},
       {"minutes", summary.minutes},
       {"instances", summary.instances},
       {"fragments", summary.fragments},
       {"raw",
        {{"counts", counts(summary.raw)},
         {"tpr", estimate(summary.raw_tpr)},
         {"ceiling", number(summary.raw_ceiling)},
         {"ppv", estimate(summary.raw_ppv)}}},
       {"settled",
        {{"counts", counts(summary.settled)}, {"tpr", estimate(summary.settled_tpr)}, {"ppv", estimate(summary.settled_ppv)}}},
       {"recall_by_range", ranges(summary)},
       {"recall_by_depth", depths(summary)},
       {"events",
        {{"count", summary.events},
         {"missed", summary.missed},
         {"late", summary.late},
         {"warned_in_time", estimate(summary.warned_in_time)},
         {"first_warning_min_m", number(summary.first_warning_min_m)},
         {"first_warning_median_m", number(summary.first_warning_median_m)},
         {"lead_time_min_s", number(summary.lead_time_min_s)},
         {"lead_time_median_s", number(summary.lead_time_median_s)}}},
       {"last_metres",
        {{"settled", summary.ahead.settled},
         {"reported", summary.ahead.reported},
         {"reported_share", estimate(summary.reported_ahead)},
         {"warned", summary.ahead.warned},
         {"held", summary.ahead.held},
         {"held_share", estimate(summary.held)},
         {"held_least_of_an_event", number(summary.held_min)},
         {"dropped_warnings", summary.ahead.dropped},
         {"dropped_warnings_per_minute", estimate(summary.dropped_per_minute)},
         {"frames", summary.ahead.frames},
         {"false_silence_frames", summary.ahead.silent_frames},
         {"false_silence_share", estimate(summary.false_silence)}}},
       {"false_alarms",
        {{"episodes", summary.episodes},
         {"per_minute", estimate(summary.episodes_per_minute)},
         {"per_100m", estimate(summary.episodes_per_100m)}}},
       {"localisation",
        {{"detections", summary.localised},
         {"distance_error_median_m", number(summary.distance_error_median_m)},
         {"distance_error_p95_m", number(summary.distance_error_p95_m)},
         {"near",
          {{"within_m", kNearRange},
           {"detections", summary.near_localised},
           {"distance_error_median_m", number(summary.near_distance_error_median_m)},
           {"distance_error_p95_m", number(summary.near_distance_error_p95_m)}}},
         {"bearing_error_median_deg", number(summary.bearing_error_median_deg)},
         {"bearing_error_p95_deg", number(summary.bearing_error_p95_deg)}}},
       {"frame_status", summary.frame_status},
       {"ground_state", summary.ground_state},
       {"calibration",
        {{"bins", calibration(summary)}, {"expected_calibration_error", number(summary.expected_calibration_error)}}},
       {"kinds", {{"detections", summary.kinds}, {"accuracy", number(summary.kind_accuracy)}}}});
}

std::string to_json(const std::vector<DomainSummary>& domains) {
  Json json = Json::object();
  for (const DomainSummary& domain : domains) json[domain.name] = Json::parse(to_json(domain.summary));
  return finished(json);
}

std::string to_json(const std::vector<Comparison>& comparisons) {
  Json list = Json::array();
  for (const Comparison& one : comparisons) {
    list.push_back({{"figure", one.name},
                    {"a", one.a},
                    {"b", one.b},
                    {"difference", estimate(one.difference)},
                    {"more_is_better", one.more_is_better},
                    {"worse", one.is_worse()}});
  }
  return finished(list);
}

std::string to_json(const TrajectoryErrors& errors) {
  return finished(
      {{"poses", errors.poses},
       {"length_m", errors.length_m},
       {"accumulated", {{"rotation_frobenius", spread(errors.rotation)}, {"translation_m", spread(errors.translation_m)}}},
       {"frame_to_frame",
        {{"rotation_frobenius", spread(errors.step_rotation)}, {"translation_m", spread(errors.step_translation_m)}}},
       {"segments",
        {{"count", errors.segments},
         {"translation_percent", number(errors.segment_translation_percent)},
         {"rotation_deg_per_m", number(errors.segment_rotation_deg_per_m)}}},
       {"end_error_percent", number(errors.end_error_percent)},
       {"ate_rmse_m", errors.ate_rmse_m}});
}

std::string to_json(const DisparityErrors& errors) {
  return finished(
      {{"known_px", errors.known_px},
       {"density", errors.density},
       {"valid", {{"bad_1", errors.bad_1}, {"bad_2", errors.bad_2}, {"bad_3", errors.bad_3}}},
       {"invalid_is_bad",
        {{"bad_1", errors.bad_1_or_invalid}, {"bad_2", errors.bad_2_or_invalid}, {"bad_3", errors.bad_3_or_invalid}}},
       {"mean_error_px", errors.mean_error_px}});
}

struct CocoWriter::Document {
  Json images = Json::array();
  Json annotations = Json::array();
};

CocoWriter::CocoWriter() : document_(std::make_unique<Document>()) {}
CocoWriter::~CocoWriter() = default;

void CocoWriter::add(const std::string& file_name, const cv::Size& size, const Detection& detection) {
  const std::size_t image_id = document_->images.size() + 1;
  document_->images.push_back({{"id", image_id}, {"file_name", file_name}, {"width", size.width}, {"height", size.height}});
  for (const NegativeObstacle& obstacle : detection.obstacles) {
    if (obstacle.candidate.contour.empty()) continue;  // remembered, and out of the image
    const cv::Rect box = cv::boundingRect(obstacle.candidate.contour);
    Json polygon = Json::array();
    for (const cv::Point& corner : obstacle.candidate.contour) {
      polygon.push_back(corner.x);
      polygon.push_back(corner.y);
    }
    if (obstacle.candidate.contour.size() < 3) {  // COCO knows no points or lines
      polygon = {box.x, box.y, box.br().x, box.y, box.br().x, box.br().y, box.x, box.br().y};
    }
    document_->annotations.push_back({{"id", document_->annotations.size() + 1},
                                      {"image_id", image_id},
                                      {"category_id", 1},
                                      {"segmentation", Json::array({polygon})},
                                      {"bbox", {box.x, box.y, box.width, box.height}},
                                      {"area", obstacle.candidate.area_px},
                                      {"iscrowd", 0},
                                      {"score", obstacle.probability.value_or(1.0)}});
  }
}

std::string CocoWriter::text() const {
  return finished({{"info", {{"description", "brink detections"}, {"version", "1.0"}}},
                   {"licenses", Json::array()},
                   {"categories", {{{"id", 1}, {"name", "negative_obstacle"}, {"supercategory", "ground"}}}},
                   {"images", document_->images},
                   {"annotations", document_->annotations}});
}

}  // namespace brink
