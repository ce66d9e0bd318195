#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "brink/tracking.hpp"
#include "candidates/evidence.hpp"
#include "tracking/opening.hpp"

namespace brink {
namespace {

constexpr std::size_t kRememberedSteps = 15;  // enough for a median that single late frames do not move

constexpr double kUsualStep = 1.0 / 15.0;  // s, of the walks that the probability was fitted to
constexpr double kNewest = 0.3;            // share of the newest sighting in a track's evidence
constexpr double kTolerance = 1e-9;        // s
constexpr double kContradiction = 0.5;     // share of an opening that is seen to be ground: it is none
constexpr double kTellingDepth = 0.15;     // m: a pixel that would be less far down tells nothing
constexpr double kLeastDistance = 0.1;     // m
constexpr int kLeastTelling = 30;          // px
constexpr double kLeastArea = 50.0;        // px of an opening in view
constexpr double kForgotten = 8.0;         // m: what is farther away is out of reach

void move(std::vector<Eigen::Vector3d>& points, const Eigen::Isometry3d& to_from) {
  for (Eigen::Vector3d& point : points) point = to_from * point;
}

/// A motion that goes on for another time than it was measured over, with the same velocity.
Eigen::Isometry3d scale(const Eigen::Isometry3d& motion, double factor) {
  Eigen::AngleAxisd rotation(motion.linear());
  rotation.angle() *= factor;
  Eigen::Isometry3d scaled = Eigen::Isometry3d::Identity();
  scaled.linear() = rotation.toRotationMatrix();
  scaled.translation() = factor * motion.translation();
  return scaled;
}

void move(Candidate& candidate, const Eigen::Isometry3d& to_from) {
  candidate.centroid = to_from * candidate.centroid;
  candidate.nearest = to_from * candidate.nearest;
  candidate.rim_nearest = to_from * candidate.rim_nearest;
  move(candidate.contour_3d, to_from);
  move(candidate.rim, to_from);
}

/// What is seen where an opening should be.
enum class Look : std::uint8_t {
  nothing,       ///< too little of it is in view to say anything
  overlooked,    ///< neither
  confirmed,     ///< a surface that is as low
  contradicted,  ///< the ground
};

/// Close below the far rim of an opening its wall is hardly lower than the ground: only those pixels count whose rays pass the
/// opening deep enough.
Look look_at(const std::vector<cv::Point>& contour, const std::optional<double>& depth_m, const FrameView& view) {
  if (contour.empty() || cv::contourArea(contour) < kLeastArea) return Look::nothing;
  const cv::Rect box = cv::boundingRect(contour);
  cv::Mat1b inside(box.size(), uchar{0});
  cv::fillPoly(inside, std::vector{contour}, cv::Scalar(255), cv::LINE_8, 0, -box.tl());
  int telling = 0;
  int level = 0;
  int below = 0;
  for (int u = 0; u < box.width; ++u) {
    double far_rim_m = 0.0;  // the ground's distance at the highest pixel of the column
    for (int v = 0; v < box.height; ++v) {
      if (inside(v, u) == 0) continue;
      const auto on_ground = view.ground.intersect(box.x + u, box.y + v, view.camera);
      if (!on_ground) continue;
      const double distance = view.ground.distance(*on_ground);
      if (far_rim_m == 0.0) far_rim_m = distance;
      // The ray falls by the camera's height over `distance`, so behind it, at the far wall:
      const double wall_m = view.ground.height_m * (far_rim_m - distance) / std::max(distance, kLeastDistance);
      if (std::min(wall_m, depth_m.value_or(wall_m)) < kTellingDepth) continue;
      ++telling;
      if (view.level(box.y + v, box.x + u) != 0) ++level;
      if (!view.below.empty() && view.below(box.y + v, box.x + u) != 0) ++below;
    }
  }
  if (telling >= kLeastTelling && level > kContradiction * telling) return Look::contradicted;
  if (telling >= kLeastTelling && below > kContradiction * telling) return Look::confirmed;
  return view.is_ground_shown ? Look::overlooked : Look::nothing;
}

/// What of a remembered opening has left the picture is still there.
void append_out_of_view(std::vector<Eigen::Vector3d>& rim, const std::vector<Eigen::Vector3d>& opening, const FrameView& view) {
  std::ranges::copy_if(opening, std::back_inserter(rim),
                       [&view](const Eigen::Vector3d& point) { return !is_in_view(point, view.camera, view.level.size()); });
}

bool is_ahead(const Eigen::Vector3d& point, const GroundPose& ground) { return ground.forward.dot(point) > 0.0; }

/// The point of an edge that is nearest to the bearer, among those ahead of him; empty when all of it is behind.
std::optional<Eigen::Vector3d> find_nearest_ahead(const std::vector<Eigen::Vector3d>& edge, const GroundPose& ground) {
  std::optional<Eigen::Vector3d> nearest;
  for (const Eigen::Vector3d& point : edge) {
    if (is_ahead(point, ground) && (!nearest || ground.distance(point) < ground.distance(*nearest))) nearest = point;
  }
  return nearest;
}

/// Whether the ground is seen beside a point of a rim. Where a region is cut off by the border of the image, or of what can be
/// matched, its outline is not its rim.
bool is_beside_ground(const Eigen::Vector3d& point, const FrameView& view) {
  constexpr int kReach = 12;  // px, as far as a region may be from what it touches (candidates.touching_gap_px)
  constexpr int kStride = 3;  // px
  if (!is_in_view(point, view.camera, view.level.size())) return false;
  const Eigen::Vector3d pixel = view.camera.project(point);
  const cv::Point place(cvRound(pixel.x()), cvRound(pixel.y()));
  for (int dv = -kReach; dv <= kReach; dv += kStride) {
    for (int du = -kReach; du <= kReach; du += kStride) {
      const cv::Point p = place + cv::Point(du, dv);
      if (p.inside({{0, 0}, view.level.size()}) && view.level(p) != 0) return true;
    }
  }
  return false;
}

/// Whether the ground goes on around a point: no edge is there.
bool is_on_ground(const Eigen::Vector3d& point, const FrameView& view) {
  constexpr int kAround = 5;  // px
  const Eigen::Vector3d pixel = view.camera.project(point);
  const cv::Rect window(cvRound(pixel.x()) - kAround, cvRound(pixel.y()) - kAround, 2 * kAround + 1, 2 * kAround + 1);
  const cv::Rect inside = window & cv::Rect({0, 0}, view.level.size());
  return view.is_ground_shown && inside.area() > 0 && cv::countNonZero(view.level(inside)) == inside.area();
}

/// The edge as it is known after a sighting: what this frame shows of it, and what was seen before and is neither found anew
/// nearby nor replaced by ground.
std::vector<Eigen::Vector3d> update_edge(const std::vector<Eigen::Vector3d>& rim,
                                         const std::vector<Eigen::Vector3d>& remembered, const FrameView& view) {
  constexpr std::size_t kMaxPoints = 150;
  constexpr double kSameEdge = 0.3;  // m
  const auto thin_out = [](std::vector<Eigen::Vector3d>& points) {
    if (points.size() <= kMaxPoints) return;
    const std::size_t every = points.size() / kMaxPoints + 1;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < points.size(); i += every) points[kept++] = points[i];
    points.resize(kept);
  };
  std::vector<Eigen::Vector3d> edge;
  if (view.is_ground_shown) {
    std::ranges::copy_if(rim, std::back_inserter(edge), [&](const Eigen::Vector3d& p) { return is_beside_ground(p, view); });
    thin_out(edge);
  }
  const auto found = static_cast<std::ptrdiff_t>(edge.size());
  for (const Eigen::Vector3d& point : remembered) {
    const auto is_near = [&point](const Eigen::Vector3d& other) { return (other - point).norm() < kSameEdge; };
    const bool in_view = is_in_view(point, view.camera, view.level.size());
    if (in_view && (std::any_of(edge.begin(), edge.begin() + found, is_near) || is_on_ground(point, view))) continue;
    edge.push_back(point);
  }
  thin_out(edge);
  return edge;
}

void place_at(Candidate& candidate, const Eigen::Vector3d& nearest, const GroundPose& ground) {
  candidate.rim_nearest = nearest;
  candidate.distance_m = ground.distance(nearest);
  candidate.bearing_deg = ground.bearing_deg(nearest);
}

/// The nearest part of a seen drop may be out of view, below the image; then what is remembered of its edge counts.
void add_hidden_edge(Candidate& candidate, const std::vector<Eigen::Vector3d>& edge, const FrameView& view) {
  if (is_beside_ground(candidate.rim_nearest, view)) return;
  const std::optional<Eigen::Vector3d> nearest = find_nearest_ahead(edge, view.ground);
  if (!nearest || view.ground.distance(*nearest) >= candidate.distance_m) return;
  place_at(candidate, *nearest, view.ground);
  std::ranges::copy_if(edge, std::back_inserter(candidate.rim),
                       [&](const Eigen::Vector3d& p) { return is_ahead(p, view.ground); });
}

/// Puts a remembered candidate into the image: where its opening must be, and which point of it is the nearest.
/// @return whether any of it is ahead of the bearer.
bool show(Candidate& candidate, const std::vector<cv::Point>& contour, const std::vector<Eigen::Vector3d>& opening,
          const std::vector<Eigen::Vector3d>& edge, const FrameView& view) {
  constexpr double kSpacing = 0.05;  // m
  candidate.contour = contour;
  candidate.area_px = contour.empty() ? 0 : static_cast<int>(cv::contourArea(contour));
  candidate.rim.clear();
  for (const Eigen::Vector3d& point : sample_edges(opening, kSpacing)) {
    if (is_in_view(point, view.camera, view.level.size())) candidate.rim.push_back(point);
  }
  const GroundPose& ground = view.ground;
  if (!candidate.rim.empty()) candidate.width_m = compute_width(candidate.rim, ground);
  if (const std::optional<Eigen::Vector3d> nearest = find_nearest_ahead(edge, ground)) {
    std::ranges::copy_if(edge, std::back_inserter(candidate.rim),
                         [&](const Eigen::Vector3d& p) { return is_ahead(p, ground); });
    place_at(candidate, *nearest, ground);
    return true;
  }
  if (!edge.empty()) return false;
  const std::optional<Eigen::Vector3d> in_view = find_nearest_ahead(candidate.rim, ground);
  place_at(candidate, in_view.value_or(candidate.rim_nearest), ground);
  return is_ahead(candidate.rim_nearest, ground);
}

}  // namespace

ObstacleKind KindVotes::winner() const {
  const auto told = std::ranges::max_element(sightings_.begin() + 1, sightings_.end());
  return *told == 0 ? ObstacleKind::unknown : static_cast<ObstacleKind>(told - sightings_.begin());
}

TrackingParams TrackingParams::paper() {
  TrackingParams params;
  params.associate_rims = false;
  params.max_unseen_s = 0.0;
  params.max_coast_s = 0.0;
  params.max_blind_s = 0.0;
  params.validation_s = 1.0 / 3.0;
  params.min_probability = 0.0;
  return params;
}

void TrackingParams::validate() const {
  const auto check = [](const char* name, double value, double least, double most) {
    if (value >= least && value <= most) return;
    throw std::invalid_argument(fmt::format("tracking.{} = {}, must be {} to {}", name, value, least, most));
  };
  check("association_radius_m", association_radius_m, 0.0, 100.0);
  check("max_unseen_s", max_unseen_s, 0.0, 60.0);
  check("max_coast_s", max_coast_s, 0.0, 60.0);
  check("max_blind_s", max_blind_s, 0.0, 60.0);
  check("validation_s", validation_s, 0.0, 60.0);
  check("min_sightings", min_sightings, 1, 1000);
  check("min_probability", min_probability, 0.0, 1.0);
}

/// A candidate of this frame going on with a memory.
struct Tracker::Link {
  std::size_t memory = 0;
  double distance_m = 0.0;
};

Tracker::Tracker(const TrackingParams& params) : params_(params) { params.validate(); }

std::vector<Track> Tracker::update(const std::vector<Candidate>& candidates,
                                   const std::optional<Eigen::Isometry3d>& current_from_previous, double time,
                                   const std::optional<FrameView>& view) {
  note_time(time);
  const double step_s = time - placed_.value_or(time);
  const std::optional<Eigen::Isometry3d> motion = find_motion(current_from_previous, time);
  if (!motion) memories_.clear();
  const bool is_blind = last_step_ && time - last_step_->end > params_.max_blind_s + kTolerance;
  if (is_blind) std::erase_if(memories_, [](const Memory& memory) { return !memory.track.validated; });
  for (Memory& memory : memories_) {
    move(memory.track.candidate, *motion);
    move(memory.opening, *motion);
    move(memory.edge, *motion);
  }

  // Each candidate goes on with a memory; of several that go on with one the nearest keeps its id.
  std::vector<std::optional<Link>> links;
  std::map<std::size_t, std::size_t> heirs;  // of memories
  for (const Candidate& candidate : candidates) {
    links.push_back(find_nearest(candidate));
    if (!links.back()) continue;
    const auto [heir, is_first] = heirs.emplace(links.back()->memory, links.size() - 1);
    if (!is_first && links.back()->distance_m < links[heir->second]->distance_m) heir->second = links.size() - 1;
  }

  std::vector<Track> tracks;
  std::vector<Memory> memories;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    Track track;
    track.candidate = candidates[i];
    track.evidence = compute_evidence(candidates[i]);
    std::vector<Eigen::Vector3d> rim = candidates[i].rim;
    std::vector<Eigen::Vector3d> edge;
    if (links[i]) {
      const Memory& memory = memories_[links[i]->memory];
      track.length = memory.track.length + 1;
      track.evidence = kNewest * track.evidence + (1.0 - kNewest) * memory.track.evidence;
      track.kind_votes = memory.track.kind_votes;
      if (view) append_out_of_view(rim, memory.opening, *view);
      edge = memory.edge;
    }
    if (view && params_.max_coast_s > 0.0) {
      edge = update_edge(candidates[i].rim, edge, *view);
      add_hidden_edge(track.candidate, edge, *view);
    }
    track.kind_votes.add(track.candidate.kind);
    track.candidate.kind = track.kind_votes.winner();
    const bool keeps_id = links[i] && heirs.at(links[i]->memory) == i;
    track.id = keeps_id ? memories_[links[i]->memory].track.id : ++last_id_;
    judge(track);
    memories.push_back({track, compute_hull(rim), std::move(edge), time});
    tracks.push_back(std::move(track));
  }
  coast(heirs, time, step_s, view, tracks, memories);
  memories_ = std::move(memories);
  return tracks;
}

// The nearest within the radius; of equally near ones the first.
std::optional<Tracker::Link> Tracker::find_nearest(const Candidate& candidate) const {
  std::optional<Link> nearest;
  const std::vector<Eigen::Vector3d> opening = compute_hull(candidate.rim);
  for (std::size_t i = 0; i < memories_.size(); ++i) {
    const Candidate& remembered = memories_[i].track.candidate;
    double distance = (candidate.centroid - remembered.centroid).norm();
    if (params_.associate_rims) {
      distance = std::min(distance, (candidate.rim_nearest - remembered.rim_nearest).norm());
      if (distance > params_.association_radius_m && overlap(opening, memories_[i].opening)) {
        distance = params_.association_radius_m;
      }
    }
    if (distance <= params_.association_radius_m && (!nearest || distance < nearest->distance_m)) nearest = Link{i, distance};
  }
  return nearest;
}

// What no candidate went on with: remembered while it is not too old, or validated and not overlooked for too long; reported,
// too, in the latter case.
void Tracker::coast(const std::map<std::size_t, std::size_t>& heirs, double time, double step_s,
                    const std::optional<FrameView>& view, std::vector<Track>& tracks, std::vector<Memory>& memories) const {
  const auto seen = static_cast<std::ptrdiff_t>(tracks.size());
  for (std::size_t i = 0; i < memories_.size(); ++i) {
    if (heirs.contains(i)) continue;
    Memory memory = memories_[i];
    const double unseen_s = time - memory.seen;
    const bool young = unseen_s <= params_.max_unseen_s + kTolerance;
    Track& track = memory.track;
    std::vector<cv::Point> contour;
    Look look = Look::nothing;
    if (view) {
      contour = project_opening(memory.opening, view->camera, view->level.size());
      look = look_at(contour, track.candidate.depth_m, *view);
    }
    track.unseen_s = unseen_s;
    if (look == Look::overlooked || look == Look::contradicted) track.overlooked_s += step_s;
    judge(track);
    const double seen_s = track.length * typical_step().value_or(kUsualStep);
    const bool coasting = track.validated && params_.max_coast_s > 0.0 &&
                          track.overlooked_s <= std::min(params_.max_coast_s, seen_s) + kTolerance;
    if (!young && !coasting) continue;
    if (!coasting || !view) {
      memories.push_back(std::move(memory));
      continue;
    }
    const auto took_its_place = [&memory](const Memory& other) { return overlap(other.opening, memory.opening); };
    if (std::any_of(memories.begin(), memories.begin() + seen, took_its_place)) continue;
    if (look == Look::contradicted) {
      if (young) memories.push_back(std::move(memory));
      continue;
    }
    Track shown = track;
    const bool is_ahead = show(shown.candidate, contour, memory.opening, memory.edge, *view);
    if (shown.candidate.distance_m > kForgotten) continue;
    memories.push_back(std::move(memory));
    if (is_ahead) tracks.push_back(std::move(shown));
  }
}

void Tracker::miss(double time) {
  note_time(time);
  if (!placed_ || time - *placed_ <= params_.max_blind_s + kTolerance) return;
  const bool is_lost = time - *placed_ > params_.max_coast_s + kTolerance;
  std::erase_if(memories_, [is_lost](const Memory& memory) { return is_lost || !memory.track.validated; });
}

// The motion since the last update: measured, or for a while the last one going on. The first frame of all has none, and
// nothing to move.
std::optional<Eigen::Isometry3d> Tracker::find_motion(const std::optional<Eigen::Isometry3d>& measured, double time) {
  const double duration_s = time - std::exchange(placed_, time).value_or(time);
  if (measured) {
    last_step_ = Step{*measured, duration_s, time};
    return measured;
  }
  const double longest_s = std::max(params_.max_blind_s, params_.max_coast_s);
  if (last_step_ && (last_step_->duration_s <= 0.0 || time - last_step_->end > longest_s + kTolerance)) {
    last_step_.reset();
  }
  if (!last_step_) return std::nullopt;
  return scale(last_step_->current_from_previous, duration_s / last_step_->duration_s);
}

void Tracker::note_time(double time) {
  if (time_) {
    if (!(time > *time_)) throw std::invalid_argument(fmt::format("time = {}, must be after the last one, {}", time, *time_));
    steps_.push_back(time - *time_);
    if (steps_.size() > kRememberedSteps) steps_.erase(steps_.begin());
  }
  time_ = time;
}

// The median of the last steps, so that single late frames change nothing; empty while no rate is known.
std::optional<double> Tracker::typical_step() const {
  if (steps_.empty()) return std::nullopt;
  std::vector<double> sorted = steps_;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  return *middle;
}

// Logistic regression on simulated walks, printed by scripts/fit-probability (docs/algorithm.md).
void Tracker::judge(Track& track) const {
  constexpr double kConstant = -1.224;
  constexpr double kEvidence = 1.267;
  constexpr double kSightings = 0.340;  // of the logarithm of those that 15 frames a second would give
  constexpr double kUnseen = -2.756;    // for each second in which it was overlooked
  track.validated = track.length >= required_sightings();
  if (params_.min_probability <= 0.0) return;
  const double sightings = track.length * typical_step().value_or(kUsualStep) / kUsualStep;
  const double log_odds =
      kConstant + kEvidence * track.evidence + kSightings * std::log(sightings) + kUnseen * track.overlooked_s;
  track.probability = to_probability(log_odds);
  track.validated = track.validated && *track.probability >= params_.min_probability;
}

int Tracker::required_sightings() const {
  const std::optional<double> step = typical_step();
  if (!step) return params_.min_sightings;
  const double sightings = std::min(std::round(params_.validation_s / *step), 1e6);
  return std::max(params_.min_sightings, static_cast<int>(sightings));
}

}  // namespace brink
