#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "evaluation/kind_table.hpp"
#include "evaluation/resampling.hpp"
#include "evaluation/statistics.hpp"

namespace brink {
namespace {

constexpr std::size_t kProbabilityBins = 10;
constexpr double kTailShare = 0.95;

std::optional<double> ratio(int part, int whole) {
  if (whole == 0) return std::nullopt;
  return static_cast<double>(part) / whole;
}

template <typename Visit>
void for_each_frame(const std::vector<SequenceScore>& sequences, Visit visit) {
  for (const SequenceScore& sequence : sequences) {
    for (const FrameScore& frame : sequence.frames) visit(frame);
  }
}

void count_frames(EvaluationSummary& summary, const std::vector<SequenceScore>& sequences) {
  int reachable = 0;
  for_each_frame(sequences, [&](const FrameScore& frame) {
    ++summary.frames;
    ++summary.frame_status[to_string(frame.status)];
    if (frame.status == FrameStatus::ok) ++summary.ground_state[to_string(frame.ground)];
    summary.raw += frame.raw();
    summary.settled += frame.settled();
    summary.ahead += frame.ahead();
    summary.fragments += frame.fragments;
    reachable += static_cast<int>(std::ranges::count_if(frame.instances, [](const auto& i) { return i.raw && i.reachable; }));
  });
  summary.instances = summary.raw.tp + summary.raw.fn;
  summary.raw_ceiling = ratio(reachable, summary.instances);
}

std::vector<EvaluationSummary::RangeBin> bin_by_range(const std::vector<SequenceScore>& sequences, double max_range_m) {
  std::vector<EvaluationSummary::RangeBin> bins(static_cast<std::size_t>(std::ceil(max_range_m)));
  for (std::size_t i = 0; i < bins.size(); ++i) {
    bins[i].from_m = static_cast<double>(i);
    bins[i].to_m = std::min(static_cast<double>(i + 1), max_range_m);
  }
  for_each_frame(sequences, [&](const FrameScore& frame) {
    for (const InstanceScore& instance : frame.instances) {
      if (!instance.raw || !instance.distance_m) continue;
      // The last bin holds max_range_m itself, too; nothing that counts is farther.
      auto& bin = bins[std::min(static_cast<std::size_t>(*instance.distance_m), bins.size() - 1)];
      ++(instance.hit ? bin.raw.tp : bin.raw.fn);
      if (instance.settled) ++(instance.settled_hit ? bin.settled.tp : bin.settled.fn);
    }
  });
  return bins;
}

/// The bin of a value between ascending limits; the last one has no end.
std::size_t find_bin(double value, const std::vector<double>& from) {
  return static_cast<std::size_t>(std::ranges::upper_bound(from, value) - from.begin()) - 1;
}

std::vector<EvaluationSummary::DepthBin> bin_by_depth(const std::vector<SequenceScore>& sequences, double max_range_m) {
  const std::vector<double> depths_from = {0.0, 0.15, 0.3, 0.6, 1.2};
  const auto ranges = static_cast<std::size_t>(std::ceil(max_range_m));
  std::vector<EvaluationSummary::DepthBin> bins(ranges * depths_from.size());
  for (std::size_t i = 0; i < bins.size(); ++i) {
    const std::size_t range = i / depths_from.size();
    const std::size_t depth = i % depths_from.size();
    bins[i].from_m = static_cast<double>(range);
    bins[i].to_m = std::min(bins[i].from_m + 1.0, max_range_m);
    bins[i].from_depth_m = depths_from[depth];
    bins[i].to_depth_m = depth + 1 < depths_from.size() ? depths_from[depth + 1] : std::numeric_limits<double>::infinity();
  }
  for_each_frame(sequences, [&](const FrameScore& frame) {
    for (const InstanceScore& instance : frame.instances) {
      if (!instance.settled || !instance.distance_m || !instance.depth_m) continue;
      const std::size_t range = std::min(static_cast<std::size_t>(*instance.distance_m), ranges - 1);
      auto& bin = bins[range * depths_from.size() + find_bin(*instance.depth_m, depths_from)];
      ++(instance.settled_hit ? bin.settled.tp : bin.settled.fn);
      if (!instance.expected) continue;
      ++bin.judged;
      bin.judged_hits += instance.settled_hit ? 1 : 0;
      bin.expected += *instance.expected ? 1 : 0;
    }
  });
  std::erase_if(bins, [](const auto& bin) { return bin.settled.tp + bin.settled.fn == 0; });
  return bins;
}

void summarise_events(EvaluationSummary& summary, const std::vector<SequenceScore>& sequences) {
  std::vector<double> distances;
  std::vector<double> lead_times;
  std::vector<double> held;
  for (const SequenceScore& sequence : sequences) {
    for (const ApproachEvent& event : sequence.events) {
      ++summary.events;
      if (!event.warned_frame) ++summary.missed;
      if (event.warned_frame && !event.in_time) ++summary.late;
      if (event.warned_distance_m) distances.push_back(*event.warned_distance_m);
      if (event.lead_time_s) lead_times.push_back(*event.lead_time_s);
      if (event.held) held.push_back(*event.held);
    }
  }
  summary.first_warning_min_m = quantile(distances, 0.0);
  summary.first_warning_median_m = quantile(distances, 0.5);
  summary.lead_time_min_s = quantile(lead_times, 0.0);
  summary.lead_time_median_s = quantile(lead_times, 0.5);
  summary.held_min = quantile(held, 0.0);
}

void summarise_localisation(EvaluationSummary& summary, const std::vector<SequenceScore>& sequences) {
  std::vector<double> distances;
  std::vector<double> near_distances;
  std::vector<double> bearings;
  for_each_frame(sequences, [&](const FrameScore& frame) {
    for (const DetectionScore& detection : frame.detections) {
      if (detection.distance_error_m) {
        const double true_distance_m = detection.distance_m - *detection.distance_error_m;
        distances.push_back(std::abs(*detection.distance_error_m));
        if (true_distance_m <= kNearRange) near_distances.push_back(distances.back());
      }
      if (detection.bearing_error_deg) bearings.push_back(std::abs(*detection.bearing_error_deg));
    }
  });
  summary.localised = static_cast<int>(distances.size());
  summary.distance_error_median_m = quantile(distances, 0.5);
  summary.distance_error_p95_m = quantile(distances, kTailShare);
  summary.near_localised = static_cast<int>(near_distances.size());
  summary.near_distance_error_median_m = quantile(near_distances, 0.5);
  summary.near_distance_error_p95_m = quantile(near_distances, kTailShare);
  summary.bearing_error_median_deg = quantile(bearings, 0.5);
  summary.bearing_error_p95_deg = quantile(bearings, kTailShare);
}

/// Whether what a detection says is there: yes on an instance of the raw rates, no for an FP. Empty for what lies on "don't
/// care".
std::optional<bool> is_there(const DetectionScore& detection, const FrameScore& frame) {
  if (detection.raw_false) return false;
  for (const InstanceScore& instance : frame.instances) {
    if (instance.raw && std::ranges::find(detection.hits, instance.id) != detection.hits.end()) return true;
  }
  return std::nullopt;
}

/// Reliability of the probabilities that are told, in tenths; the expected calibration error is the mean of |claimed share -
/// share that is there|, weighted by detections.
void summarise_calibration(EvaluationSummary& summary, const std::vector<SequenceScore>& sequences) {
  std::vector<EvaluationSummary::ProbabilityBin> bins(kProbabilityBins);
  int all = 0;
  for_each_frame(sequences, [&](const FrameScore& frame) {
    for (const DetectionScore& detection : frame.detections) {
      const std::optional<bool> there = is_there(detection, frame);
      if (!there || !detection.probability) continue;
      const double tenth = std::clamp(std::floor(*detection.probability * kProbabilityBins), 0.0, kProbabilityBins - 1.0);
      EvaluationSummary::ProbabilityBin& bin = bins[static_cast<std::size_t>(tenth)];
      ++bin.detections;
      ++all;
      bin.mean_probability += *detection.probability;  // sums first, divided below
      bin.hit_share += *there ? 1.0 : 0.0;
    }
  });
  if (all == 0) return;
  double error = 0.0;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    bins[i].from = static_cast<double>(i) / kProbabilityBins;
    bins[i].to = static_cast<double>(i + 1) / kProbabilityBins;
    error += std::abs(bins[i].mean_probability - bins[i].hit_share) / all;
    if (bins[i].detections == 0) continue;
    bins[i].mean_probability /= bins[i].detections;
    bins[i].hit_share /= bins[i].detections;
  }
  summary.calibration = bins;
  summary.expected_calibration_error = error;
}

struct EstimatedFigure {
  Figure compute;
  std::optional<Estimate> EvaluationSummary::*result;
};

constexpr std::array<EstimatedFigure, 11> kFigures = {{{raw_tpr, &EvaluationSummary::raw_tpr},
                                                       {raw_ppv, &EvaluationSummary::raw_ppv},
                                                       {settled_tpr, &EvaluationSummary::settled_tpr},
                                                       {settled_ppv, &EvaluationSummary::settled_ppv},
                                                       {warned_in_time, &EvaluationSummary::warned_in_time},
                                                       {reported_ahead, &EvaluationSummary::reported_ahead},
                                                       {held, &EvaluationSummary::held},
                                                       {dropped_per_minute, &EvaluationSummary::dropped_per_minute},
                                                       {false_silence, &EvaluationSummary::false_silence},
                                                       {episodes_per_minute, &EvaluationSummary::episodes_per_minute},
                                                       {episodes_per_100m, &EvaluationSummary::episodes_per_100m}}};

/// Values with their intervals.
void estimate_figures(EvaluationSummary& summary, const Pieces& pieces, const EvaluationParams& params) {
  std::array<std::vector<double>, kFigures.size()> resampled;
  std::mt19937_64 random(static_cast<std::uint64_t>(params.seed));
  for (int i = 0; i < params.resamplings; ++i) {
    const Draw draw = draw_at_random(pieces, random);
    for (std::size_t k = 0; k < kFigures.size(); ++k) {
      if (const std::optional<double> value = kFigures.at(k).compute(pieces, draw)) resampled.at(k).push_back(*value);
    }
  }
  for (std::size_t k = 0; k < kFigures.size(); ++k) {
    const std::optional<double> value = kFigures.at(k).compute(pieces, draw_each(pieces));
    if (value) summary.*kFigures.at(k).result = make_estimate(*value, resampled.at(k));
  }
}

}  // namespace

Counts& Counts::operator+=(const Counts& other) {
  tp += other.tp;
  fn += other.fn;
  fp += other.fp;
  return *this;
}

AheadCounts& AheadCounts::operator+=(const AheadCounts& other) {
  settled += other.settled;
  reported += other.reported;
  warned += other.warned;
  held += other.held;
  dropped += other.dropped;
  frames += other.frames;
  silent_frames += other.silent_frames;
  return *this;
}

std::optional<double> Counts::tpr() const { return ratio(tp, tp + fn); }

std::optional<double> Counts::ppv() const { return ratio(tp, tp + fp); }

EvaluationSummary summarise(const std::vector<SequenceScore>& sequences, const EvaluationParams& params) {
  params.validate();
  if (sequences.empty()) throw std::invalid_argument("sequences = 0, must be 1 or more");
  EvaluationSummary summary;
  summary.sequences = static_cast<int>(sequences.size());
  for (const SequenceScore& sequence : sequences) {
    summary.minutes += sequence.duration_s / 60.0;
    summary.episodes += static_cast<int>(sequence.episodes.size());
  }
  count_frames(summary, sequences);
  summary.recall_by_range = bin_by_range(sequences, params.max_range_m);
  summary.recall_by_depth = bin_by_depth(sequences, params.max_range_m);
  summarise_events(summary, sequences);
  summarise_localisation(summary, sequences);
  summarise_calibration(summary, sequences);
  summarise_kinds(summary, sequences);
  estimate_figures(summary, cut_into_pieces(sequences, params.block_frames), params);
  return summary;
}

}  // namespace brink
