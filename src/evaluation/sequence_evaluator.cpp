#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "disparity/parameters.hpp"
#include "evaluation/expectation.hpp"
#include "evaluation/frame_overlaps.hpp"
#include "evaluation/last_metres.hpp"
#include "evaluation/presence.hpp"
#include "evaluation/statistics.hpp"

namespace brink {
namespace {

// Steps of the walker as they are measured: long enough for the head to be back at its height (walkers bob at about 2 Hz), so
// that bobbing is not taken for walking.
constexpr double kWalkStep = 0.5;  // s

void require_same_frame(const FrameTruth& truth, const Detection& detection, const SequenceScore& before) {
  if (truth.frame != detection.frame) {
    throw std::invalid_argument(
        fmt::format("{}: detection of frame = {}, must be that of the truth, {}", before.name, detection.frame, truth.frame));
  }
  if (!before.frames.empty() && !(truth.frame > before.frames.back().frame)) {
    throw std::invalid_argument(
        fmt::format("{}: frame = {}, must be above the one before, {}", before.name, truth.frame, before.frames.back().frame));
  }
  if (!std::isfinite(truth.time) || (!before.frames.empty() && !(truth.time > before.frames.back().time))) {
    throw std::invalid_argument(
        fmt::format("{}: frame {}: time = {} s, must be above that of the frame before", before.name, truth.frame, truth.time));
  }
  const cv::Rect picture(cv::Point(0, 0), truth.negative.size());
  for (const NegativeObstacle& obstacle : detection.obstacles) {
    for (const cv::Point& point : obstacle.candidate.contour) {
      if (picture.contains(point)) continue;
      throw std::invalid_argument(
          fmt::format("{}: frame {}: contour point of obstacle {} = ({}, {}), must be in the {}x{} picture", before.name,
                      truth.frame, obstacle.id, point.x, point.y, picture.width, picture.height));
    }
  }
}

std::vector<NegativeObstacle> select_near(std::vector<NegativeObstacle> obstacles, double max_range_m) {
  std::erase_if(obstacles, [max_range_m](const NegativeObstacle& o) { return !(o.candidate.distance_m <= max_range_m); });
  return obstacles;
}

std::vector<cv::Mat1b> fill_contours(const std::vector<NegativeObstacle>& obstacles, const cv::Size& size) {
  std::vector<cv::Mat1b> regions;
  regions.reserve(obstacles.size());
  for (const NegativeObstacle& obstacle : obstacles) regions.push_back(fill_contour(obstacle.candidate.contour, size));
  return regions;
}

/// Ids of the instances whose index fulfils the predicate.
template <typename Predicate>
std::vector<int> ids_of(const FrameTruth& truth, Predicate predicate) {
  std::vector<int> ids;
  for (std::size_t i = 0; i < truth.instances.size(); ++i) {
    if (predicate(i)) ids.push_back(truth.instances[i].id);
  }
  return ids;
}

bool is_hit(const FrameMatch& match, int id) {
  return std::ranges::any_of(match.hits, [id](const std::vector<int>& ids) { return std::ranges::find(ids, id) != ids.end(); });
}

/// Errors of place against the hit instance whose distance fits best.
void localise(DetectionScore& score, const Candidate& candidate, const FrameTruth& truth) {
  for (const VisibleInstance& instance : truth.instances) {
    if (!instance.distance_m || std::ranges::find(score.hits, instance.id) == score.hits.end()) continue;
    const double error = candidate.distance_m - *instance.distance_m;
    if (score.distance_error_m && std::abs(error) >= std::abs(*score.distance_error_m)) continue;
    score.distance_error_m = error;
    score.bearing_error_deg.reset();
    if (instance.bearing_deg) score.bearing_error_deg = std::remainder(candidate.bearing_deg - *instance.bearing_deg, 360.0);
  }
}

/// The kind of what a detection hits, where that is one kind.
std::optional<ObstacleKind> find_true_kind(const std::vector<int>& hits, const FrameTruth& truth) {
  std::optional<ObstacleKind> kind;
  for (const VisibleInstance& instance : truth.instances) {
    if (std::ranges::find(hits, instance.id) == hits.end()) continue;
    if (instance.kind == ObstacleKind::unknown || (kind && *kind != instance.kind)) return std::nullopt;
    kind = instance.kind;
  }
  return kind;
}

double path_length(const std::vector<double>& times, const std::vector<Eigen::Vector3d>& positions) {
  double length = 0.0;
  std::size_t last = 0;
  for (std::size_t i = 1; i < positions.size(); ++i) {
    if (times[i] - times[last] < kWalkStep - kTimeTolerance && i + 1 < positions.size()) continue;
    length += (positions[i] - positions[last]).norm();
    last = i;
  }
  return length;
}

}  // namespace

void EvaluationParams::validate() const {
  require_parameter(min_depth_m >= 0.0 && min_depth_m <= 10.0, "evaluation.min_depth_m", min_depth_m, "0 to 10");
  require_parameter(max_range_m > 0.0 && max_range_m <= 1000.0, "evaluation.max_range_m", max_range_m, "above 0 to 1000");
  require_parameter(first_range_m >= max_range_m && first_range_m <= 1000.0, "evaluation.first_range_m", first_range_m,
                    "max_range_m to 1000");
  require_between("evaluation.min_visible_px", min_visible_px, 1, 1'000'000'000);
  require_between("evaluation.dilation_px", dilation_px, 0, 100);
  require_between("evaluation.settle_s", settle_s, 0.0, 1e6);
  require_parameter(gone_s > 0.0 && gone_s <= 1e6, "evaluation.gone_s", gone_s, "above 0 to 1e6");
  require_between("evaluation.validation_sightings", validation_sightings, 1, 1'000'000);
  require_between("evaluation.event_range_m", event_range_m, 0.0, 1000.0);
  require_between("evaluation.warn_range_m", warn_range_m, 0.0, 1000.0);
  require_between("evaluation.warn_delay_s", warn_delay_s, 0.0, 1e6);
  require_between("evaluation.ahead_range_m", ahead_range_m, 0.0, 1000.0);
  require_between("evaluation.ahead_deg", ahead_deg, 0.0, 180.0);
  require_between("evaluation.claim_error_m", claim_error_m, 0.0, 1000.0);
  require_between("evaluation.dropped_s", dropped_s, 0.0, 1e6);
  require_between("evaluation.episode_radius_m", episode_radius_m, 0.0, 1000.0);
  require_between("evaluation.episode_gap_s", episode_gap_s, 0.0, 1e6);
  require_between("evaluation.block_frames", block_frames, 1, 1'000'000);
  require_between("evaluation.resamplings", resamplings, 1, 1'000'000);
  require_parameter(seed >= 0, "evaluation.seed", seed, "0 or more");
}

Counts FrameScore::raw() const {
  Counts counts;
  for (const InstanceScore& instance : instances) {
    if (instance.raw) ++(instance.hit ? counts.tp : counts.fn);
  }
  counts.fp = static_cast<int>(std::ranges::count_if(detections, &DetectionScore::raw_false));
  return counts;
}

Counts FrameScore::settled() const {
  Counts counts;
  for (const InstanceScore& instance : instances) {
    if (instance.settled) ++(instance.settled_hit ? counts.tp : counts.fn);
  }
  counts.fp = static_cast<int>(std::ranges::count_if(detections, &DetectionScore::settled_false));
  return counts;
}

AheadCounts FrameScore::ahead() const {
  AheadCounts counts;
  if (!edges_ahead) return counts;
  for (const EdgeAhead& edge : *edges_ahead) {
    counts.settled += edge.settled ? 1 : 0;
    counts.reported += edge.settled && edge.reported ? 1 : 0;
    counts.warned += edge.warned ? 1 : 0;
    counts.held += edge.reported ? 1 : 0;
    counts.dropped += edge.dropped ? 1 : 0;
  }
  counts.frames = counts.settled > 0 ? 1 : 0;
  const bool is_silent = ground == GroundState::seen && detections.empty();
  counts.silent_frames = is_silent ? counts.frames : 0;
  return counts;
}

SequenceEvaluator::SequenceEvaluator(std::string name, const EvaluationParams& params, const CandidateParams& rules)
    : params_(params), rules_(rules), last_metres_(std::make_unique<LastMetres>(params)) {
  params.validate();
  rules.validate();
  score_.name = std::move(name);
}

SequenceEvaluator::~SequenceEvaluator() = default;

// The approach that a present instance is on, a new one when it appears.
SequenceEvaluator::Approach& SequenceEvaluator::follow(const VisibleInstance& instance, int frame, double time) {
  const auto latest = latest_approach_.find(instance.id);
  if (latest == latest_approach_.end() || time - approaches_[latest->second].last_seen >= params_.gone_s - kTimeTolerance) {
    Approach approach;
    approach.event.id = instance.id;
    approach.event.first_frame = frame;
    approach.start = time;
    latest_approach_[instance.id] = approaches_.size();
    approaches_.push_back(approach);
  }
  Approach& approach = approaches_[latest_approach_[instance.id]];
  const std::size_t index = score_.frames.size();
  approach.sightings = approach.last_index + 1 == index ? approach.sightings + 1 : 1;
  approach.last_index = index;
  approach.last_seen = time;
  if (!instance.distance_m || !is_deep(instance, params_)) return approach;
  if (!approach.is_event) approach.event.first_distance_m = *instance.distance_m;
  if (!approach.is_event || *instance.distance_m < approach.event.nearest_m) {
    approach.event.nearest_m = *instance.distance_m;
    approach.nearest_time = time;
  }
  approach.is_event = true;
  return approach;
}

InstanceScore SequenceEvaluator::score_instance(const VisibleInstance& instance, const FrameTruth& truth,
                                                const Detection& detection) {
  InstanceScore score;
  score.id = instance.id;
  score.visible_px = instance.visible_px;
  score.distance_m = instance.distance_m;
  score.depth_m = instance.depth_m;
  if (!is_present(instance, params_)) return score;
  Approach& approach = follow(instance, truth.frame, truth.time);
  score.raw = is_deep(instance, params_) && instance.distance_m.value_or(0.0) <= params_.max_range_m;
  score.settled = score.raw && truth.time - approach.start >= params_.settle_s - kTimeTolerance;
  score.reachable = approach.sightings >= params_.validation_sightings;
  if (const std::optional<bool> in_envelope = is_in_envelope(instance, truth, detection, rules_)) {
    // Frames without the instance begin its sightings anew, so these are never more.
    approach.expected_sightings = *in_envelope ? std::min(approach.expected_sightings + 1, approach.sightings) : 0;
    score.expected = approach.expected_sightings >= params_.validation_sightings;
  }
  return score;
}

// @param match with every instance counted that is on an approach.
void SequenceEvaluator::note_warnings(const FrameTruth& truth, const FrameMatch& match) {
  for (const VisibleInstance& instance : truth.instances) {
    if (!instance.distance_m || !is_hit(match, instance.id)) continue;
    Approach& approach = approaches_[latest_approach_.at(instance.id)];
    if (approach.event.warned_frame) continue;
    approach.event.warned_frame = truth.frame;
    approach.event.warned_distance_m = instance.distance_m;
    approach.warned_time = truth.time;
    const bool appeared_late = approach.event.first_distance_m < params_.warn_range_m;
    approach.event.in_time = *instance.distance_m >= params_.warn_range_m ||
                             (appeared_late && truth.time - approach.start <= params_.warn_delay_s + kTimeTolerance);
  }
}

// An edge that lies ahead belongs to the latest approach of its instance, also where it has left the image.
void SequenceEvaluator::note_edges(const std::vector<EdgeAhead>& edges) {
  for (const EdgeAhead& edge : edges) {
    Approach& approach = approaches_[latest_approach_.at(edge.id)];
    approach.warned += edge.warned ? 1 : 0;
    approach.held += edge.reported ? 1 : 0;
  }
}

void SequenceEvaluator::note_false_alarm(DetectionScore& detection, const Eigen::Vector3d& place, const FrameTruth& truth) {
  double nearest = params_.episode_radius_m;
  for (std::size_t i = 0; i < score_.episodes.size(); ++i) {
    const double distance = (score_.episodes[i].place - place).norm();
    if (truth.time - episode_times_[i] > params_.episode_gap_s + kTimeTolerance || distance > nearest) continue;
    nearest = distance;
    detection.episode = static_cast<int>(i);
  }
  if (!detection.episode) {
    detection.episode = static_cast<int>(score_.episodes.size());
    score_.episodes.emplace_back().first_frame = truth.frame;
    episode_times_.push_back(truth.time);
  }
  const auto index = static_cast<std::size_t>(*detection.episode);
  Episode& episode = score_.episodes[index];
  episode.last_frame = truth.frame;
  ++episode.detections;
  episode.place = place;
  episode_times_[index] = truth.time;
}

DetectionScore SequenceEvaluator::score_detection(const NegativeObstacle& obstacle, const Judgement& judgement,
                                                  const FrameTruth& truth) {
  DetectionScore score;
  score.id = obstacle.id;
  score.hits = judgement.hits;
  score.raw_false = judgement.raw_false;
  score.settled_false = judgement.settled_false;
  score.distance_m = obstacle.candidate.distance_m;
  score.probability = obstacle.probability;
  score.kind = obstacle.candidate.kind;
  score.true_kind = find_true_kind(score.hits, truth);
  localise(score, obstacle.candidate, truth);
  if (score.settled_false && truth.world_from_camera) {
    note_false_alarm(score, *truth.world_from_camera * obstacle.candidate.rim_nearest, truth);
  }
  return score;
}

void SequenceEvaluator::add(const FrameTruth& truth, const Detection& detection) {
  require_same_frame(truth, detection, score_);
  FrameScore frame{truth.frame, truth.time, detection.status, detection.ground.state, {}, {}, 0, {}};
  for (const VisibleInstance& instance : truth.instances) frame.instances.push_back(score_instance(instance, truth, detection));
  const std::vector<NegativeObstacle> reported = select_near(detection.obstacles, params_.max_range_m);

  // What the detections hit, for each set of instances that counts somewhere
  const FrameOverlaps overlaps(truth.negative, fill_contours(reported, truth.negative.size()), params_.dilation_px);
  const FrameMatch raw = overlaps.match(ids_of(truth, [&](std::size_t i) { return frame.instances[i].raw; }));
  const FrameMatch settled = overlaps.match(ids_of(truth, [&](std::size_t i) { return frame.instances[i].settled; }));
  const FrameMatch all = overlaps.match(ids_of(truth, [](std::size_t) { return true; }));
  const FrameMatch approached = overlaps.match(ids_of(
      truth, [&](std::size_t i) { return is_present(truth.instances[i], params_) && is_deep(truth.instances[i], params_); }));

  for (InstanceScore& instance : frame.instances) {
    instance.hit = is_hit(raw, instance.id);
    instance.settled_hit = is_hit(settled, instance.id);
  }
  for (std::size_t i = 0; i < reported.size(); ++i) {
    frame.detections.push_back(score_detection(reported[i], {all.hits[i], raw.is_false[i], settled.is_false[i]}, truth));
  }
  frame.fragments = raw.fragments;
  note_warnings(truth, approached);
  frame.edges_ahead = last_metres_->score(truth, frame.detections);
  note_edges(*frame.edges_ahead);
  if (truth.world_from_camera) {
    position_times_.push_back(truth.time);
    positions_.emplace_back(truth.world_from_camera->translation());
  }
  score_.frames.push_back(std::move(frame));
}

SequenceScore SequenceEvaluator::finish() const {
  SequenceScore score = score_;
  std::vector<double> steps;
  for (std::size_t i = 1; i < score.frames.size(); ++i) steps.push_back(score.frames[i].time - score.frames[i - 1].time);
  if (!steps.empty()) score.duration_s = static_cast<double>(score.frames.size()) * *quantile(steps, 0.5);
  if (!positions_.empty()) score.walked_m = path_length(position_times_, positions_);
  for (const Approach& approach : approaches_) {
    if (!approach.is_event || !(approach.event.nearest_m < params_.event_range_m)) continue;
    score.events.push_back(approach.event);
    if (approach.warned > 0) score.events.back().held = static_cast<double>(approach.held) / approach.warned;
    if (!approach.event.warned_frame) continue;
    score.events.back().lead_time_s = std::max(0.0, approach.nearest_time - approach.warned_time);
  }
  return score;
}

}  // namespace brink
