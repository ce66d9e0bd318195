#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "brink/tracking.hpp"

namespace brink {
namespace {

constexpr std::size_t kRememberedSteps = 15;  // enough for a median that single late frames do not move

/// The hull of an opening, laid onto the camera's x-z plane: a view of the ground from above, but for an affine map, which
/// leaves the ratios of areas alone.
std::vector<cv::Point2f> compute_hull(const std::vector<Eigen::Vector3d>& rim) {
  std::vector<cv::Point2f> points;
  points.reserve(rim.size());
  for (const Eigen::Vector3d& p : rim) points.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.z()));
  std::vector<cv::Point2f> hull;
  if (!points.empty()) cv::convexHull(points, hull);
  return hull;
}

/// Whether half of one opening lies within the other.
bool overlap(const std::vector<cv::Point2f>& a, const std::vector<cv::Point2f>& b) {
  if (a.size() < 3 || b.size() < 3) return false;
  std::vector<cv::Point2f> common;
  const double shared = cv::intersectConvexConvex(a, b, common);
  return shared > 0.0 && 2.0 * shared >= std::min(cv::contourArea(a), cv::contourArea(b));
}

/// A candidate of this frame going on with a track.
struct Link {
  std::size_t track = 0;
  double distance_m = 0.0;
};

// For each track the candidate that keeps its id: the nearest of those that go on with it.
std::map<std::size_t, std::size_t> find_heirs(const std::vector<std::optional<Link>>& links) {
  std::map<std::size_t, std::size_t> heirs;
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (!links[i]) continue;
    const auto [known, is_first] = heirs.emplace(links[i]->track, i);
    if (!is_first && links[i]->distance_m < links[known->second]->distance_m) known->second = i;
  }
  return heirs;
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
  return params;
}

void TrackingParams::validate() const {
  const auto check = [](const char* name, double value, double least, double most) {
    if (value >= least && value <= most) return;
    throw std::invalid_argument(fmt::format("tracking.{} = {}, must be {} to {}", name, value, least, most));
  };
  check("association_radius_m", association_radius_m, 0.0, 100.0);
  check("max_unseen_s", max_unseen_s, 0.0, 60.0);
  check("validation_s", validation_s, 0.0, 60.0);
  check("min_sightings", min_sightings, 1, 1000);
}

Tracker::Tracker(const TrackingParams& params) : params_(params) { params.validate(); }

std::vector<Track> Tracker::update(const std::vector<Candidate>& candidates,
                                   const std::optional<Eigen::Isometry3d>& current_from_previous, double time) {
  note_time(time);
  if (!current_from_previous) memories_.clear();
  for (Memory& memory : memories_) {
    memory.centroid = *current_from_previous * memory.centroid;
    memory.rim_nearest = *current_from_previous * memory.rim_nearest;
    for (Eigen::Vector3d& point : memory.rim) point = *current_from_previous * point;
  }

  // The nearest within the radius; of equally near ones the first.
  const auto find_nearest = [this](const Candidate& candidate) {
    std::optional<Link> nearest;
    const std::vector<cv::Point2f> hull = compute_hull(candidate.rim);
    for (std::size_t i = 0; i < memories_.size(); ++i) {
      double distance = (candidate.centroid - memories_[i].centroid).norm();
      if (params_.associate_rims) {
        distance = std::min(distance, (candidate.rim_nearest - memories_[i].rim_nearest).norm());
        if (distance > params_.association_radius_m && overlap(hull, compute_hull(memories_[i].rim))) {
          distance = params_.association_radius_m;
        }
      }
      if (distance <= params_.association_radius_m && (!nearest || distance < nearest->distance_m)) nearest = Link{i, distance};
    }
    return nearest;
  };
  std::vector<std::optional<Link>> links;
  links.reserve(candidates.size());
  for (const Candidate& candidate : candidates) links.push_back(find_nearest(candidate));
  const std::map<std::size_t, std::size_t> heirs = find_heirs(links);

  std::vector<Track> tracks;
  tracks.reserve(candidates.size());
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    Track track{.id = 0, .candidate = candidates[i], .length = 1, .validated = false, .kind_votes = {}};
    if (links[i]) track.length = memories_[links[i]->track].length + 1;
    const bool keeps_id = links[i] && heirs.at(links[i]->track) == i;
    track.id = keeps_id ? memories_[links[i]->track].id : ++last_id_;
    track.validated = track.length >= required_sightings();
    if (links[i]) track.kind_votes = memories_[links[i]->track].kind_votes;
    track.kind_votes.add(track.candidate.kind);
    track.candidate.kind = track.kind_votes.winner();
    tracks.push_back(std::move(track));
  }
  remember(tracks, heirs, time);
  return tracks;
}

void Tracker::miss(double time) {
  note_time(time);
  memories_.clear();
}

// This frame's tracks, and those of earlier frames that no candidate went on with, while they are not too old.
void Tracker::remember(const std::vector<Track>& tracks, const std::map<std::size_t, std::size_t>& heirs, double time) {
  constexpr double kTolerance = 1e-9;  // s
  std::vector<Memory> memories;
  memories.reserve(tracks.size() + memories_.size());
  for (const Track& track : tracks) {
    memories.push_back({track.id, track.length, track.candidate.centroid, track.candidate.rim_nearest, track.candidate.rim,
                        time, track.kind_votes});
  }
  for (std::size_t i = 0; i < memories_.size(); ++i) {
    const bool young = time - memories_[i].seen <= params_.max_unseen_s + kTolerance;
    if (!heirs.contains(i) && young) memories.push_back(memories_[i]);
  }
  memories_ = std::move(memories);
}

void Tracker::note_time(double time) {
  if (time_) {
    if (!(time > *time_)) throw std::invalid_argument(fmt::format("time = {}, must be after the last one, {}", time, *time_));
    steps_.push_back(time - *time_);
    if (steps_.size() > kRememberedSteps) steps_.erase(steps_.begin());
  }
  time_ = time;
}

int Tracker::required_sightings() const {
  if (steps_.empty()) return params_.min_sightings;  // no rate is known yet
  std::vector<double> sorted = steps_;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double sightings = std::min(std::round(params_.validation_s / *middle), 1e6);
  return std::max(params_.min_sightings, static_cast<int>(sightings));
}

}  // namespace brink
