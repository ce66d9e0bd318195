#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "brink/evaluation_report.hpp"
#include "evaluation/kind_table.hpp"

namespace brink {
namespace {

std::string share(const std::optional<double>& value) { return value ? fmt::format("{:.3f}", *value) : "-"; }

std::string share(const std::optional<Estimate>& estimate) { return estimate ? share(estimate->value) : "-"; }

std::string number(const std::optional<double>& value, int digits) {
  return value ? fmt::format("{:.{}f}", *value, digits) : "-";
}

std::string with_interval(const std::optional<Estimate>& estimate, int digits) {
  if (!estimate) return "-";
  return fmt::format("{:.{}f} [{:.{}f}, {:.{}f}]", estimate->value, digits, estimate->low, digits, estimate->high, digits);
}

std::string row_of(const std::string& name, const EvaluationSummary& summary, bool intervals) {
  const auto rate = [intervals](const std::optional<Estimate>& estimate) {
    return intervals ? with_interval(estimate, 3) : share(estimate);
  };
  return fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |\n", name, summary.frames, summary.instances,
                     summary.raw.tp, summary.raw.fn, summary.raw.fp, summary.fragments, rate(summary.raw_tpr),
                     share(summary.raw_ceiling), rate(summary.raw_ppv), rate(summary.settled_tpr), rate(summary.settled_ppv));
}

std::string paper_row(const std::string& name, int frames, const Counts& counts) {
  return fmt::format("| {} | {} | {} | {} | {} | {} | - | {} | - | {} | - | - |\n", name, frames, counts.tp + counts.fn,
                     counts.tp, counts.fn, counts.fp, share(counts.tpr()), share(counts.ppv()));
}

std::string detection_table(const std::vector<SequenceScore>& sequences, const EvaluationSummary& pooled,
                            const EvaluationParams& params) {
  std::string text =
      "| sequence | frames | instances | TP | FN | FP | fragments | raw TPR | ceiling | raw PPV | settled TPR | settled PPV |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const SequenceScore& sequence : sequences) text += row_of(sequence.name, summarise({sequence}, params), false);
  text += row_of("all, with 95 % intervals", pooled, true);
  int frames = 0;
  Counts counts;
  for (const PaperRow& row : kPaperRows) {
    text += paper_row(row.name, row.frames, row.counts);
    frames += row.frames;
    counts += row.counts;
  }
  return text + paper_row("paper, all", frames, counts);
}

// With one domain only it would repeat the pooled figures.
std::string domain_table(const std::vector<SequenceScore>& sequences, const EvaluationParams& params) {
  const std::vector<DomainSummary> domains = summarise_by_domain(sequences, params);
  if (domains.size() < 2) return "";
  std::string text =
      "| domain | sequences | settled TPR | settled PPV | events missed | held | dropped warnings | false silence | episodes "
      "|\n|---|---|---|---|---|---|---|---|---|\n";
  for (const auto& [name, one] : domains) {
    const bool is_measured = one.reported_ahead.has_value();
    text += fmt::format("| {} | {} | {} | {} | {} of {} | {} | {} | {} | {} |\n", name, one.sequences, share(one.settled_tpr),
                        share(one.settled_ppv), one.missed, one.events, share(one.held),
                        is_measured ? std::to_string(one.ahead.dropped) : "-",
                        is_measured ? fmt::format("{} of {}", one.ahead.silent_frames, one.ahead.frames) : "-",
                        one.episodes_per_minute ? std::to_string(one.episodes) : "-");
  }
  return text + "\n";
}

std::string range_table(const EvaluationSummary& summary) {
  std::string text = "| rim distance, m | instances | raw TPR | settled instances | settled TPR |\n|---|---|---|---|---|\n";
  for (const EvaluationSummary::RangeBin& bin : summary.recall_by_range) {
    text += fmt::format("| {:.0f} to {:.0f} | {} | {} | {} | {} |\n", bin.from_m, bin.to_m, bin.raw.tp + bin.raw.fn,
                        share(bin.raw.tpr()), bin.settled.tp + bin.settled.fn, share(bin.settled.tpr()));
  }
  return text;
}

std::string depth_table(const EvaluationSummary& summary) {
  if (summary.recall_by_depth.empty()) return "";
  std::string text =
      "| rim distance, m | depth, m | settled instances | settled TPR | in the envelope | difference "
      "|\n|---|---|---|---|---|---|\n";
  for (const EvaluationSummary::DepthBin& bin : summary.recall_by_depth) {
    const std::string depths = std::isfinite(bin.to_depth_m) ? fmt::format("{} to {}", bin.from_depth_m, bin.to_depth_m)
                                                             : fmt::format("from {}", bin.from_depth_m);
    text += fmt::format("| {:.0f} to {:.0f} | {} | {} | {} |", bin.from_m, bin.to_m, depths, bin.settled.tp + bin.settled.fn,
                        share(bin.settled.tpr()));
    text += bin.judged == 0 ? " - | - |\n"
                            : fmt::format(" {:.3f} | {:+.3f} |\n", static_cast<double>(bin.expected) / bin.judged,
                                          static_cast<double>(bin.judged_hits - bin.expected) / bin.judged);
  }
  return text + "\n";
}

std::string last_metres_line(const EvaluationSummary& summary, const EvaluationParams& params) {
  if (!summary.reported_ahead) return "";
  std::string text = fmt::format("Edges within {} m ahead, in {} frames: reported in {}; held {} (least of an event {})\n",
                                 params.ahead_range_m, summary.ahead.frames, with_interval(summary.reported_ahead, 3),
                                 with_interval(summary.held, 3), number(summary.held_min, 3));
  return text + fmt::format("  dropped warnings {}, per minute {}; false silence in {} frames, share {}\n",
                            summary.ahead.dropped, with_interval(summary.dropped_per_minute, 2), summary.ahead.silent_frames,
                            with_interval(summary.false_silence, 3));
}

std::string event_lines(const EvaluationSummary& summary, const EvaluationParams& params) {
  std::string text = fmt::format("Events: {}; missed {}, warned late {}, share warned in time {}\n", summary.events,
                                 summary.missed, summary.late, with_interval(summary.warned_in_time, 3));
  text += fmt::format("First warning, true distance: least {} m, median {} m; lead time: least {} s, median {} s\n",
                      number(summary.first_warning_min_m, 2), number(summary.first_warning_median_m, 2),
                      number(summary.lead_time_min_s, 2), number(summary.lead_time_median_s, 2));
  text += last_metres_line(summary, params);
  text += fmt::format("False-alarm episodes: {} in {:.2f} minutes; per minute {}, per 100 m walked {}\n",
                      summary.episodes_per_minute ? fmt::format("{}", summary.episodes) : "-", summary.minutes,
                      with_interval(summary.episodes_per_minute, 2), with_interval(summary.episodes_per_100m, 2));
  return text;
}

std::string state_line(const char* title, const std::map<std::string, int>& states) {
  std::string text = title;
  for (const auto& [state, frames] : states) text += fmt::format(" {} {}", state, frames);
  return text + "\n";
}

std::string calibration_table(const EvaluationSummary& summary) {
  if (summary.calibration.empty()) return "Calibration: no detection tells a probability\n";
  std::string text = "| probability | detections | mean | share that hits |\n|---|---|---|---|\n";
  for (const EvaluationSummary::ProbabilityBin& bin : summary.calibration) {
    if (bin.detections == 0) continue;
    text += fmt::format("| {:.1f} to {:.1f} | {} | {:.3f} | {:.3f} |\n", bin.from, bin.to, bin.detections, bin.mean_probability,
                        bin.hit_share);
  }
  return text + fmt::format("Expected calibration error: {}\n", number(summary.expected_calibration_error, 3));
}

std::string plus_minus(const MeanAndDeviation& value) { return fmt::format("{:.4f} +- {:.4f}", value.mean, value.deviation); }

}  // namespace

std::string to_text(const std::vector<SequenceScore>& sequences, const EvaluationParams& params) {
  const EvaluationSummary summary = summarise(sequences, params);
  std::string text = detection_table(sequences, summary, params) + "\n" + range_table(summary) + "\n" + depth_table(summary) +
                     domain_table(sequences, params) + event_lines(summary, params);
  text += fmt::format("Distance error of {} detections: median {} m, p95 {} m; bearing error: median {} deg, p95 {} deg\n",
                      summary.localised, number(summary.distance_error_median_m, 3), number(summary.distance_error_p95_m, 3),
                      number(summary.bearing_error_median_deg, 2), number(summary.bearing_error_p95_deg, 2));
  text += fmt::format("Of these {} within {} m: distance error median {} m, p95 {} m\n", summary.near_localised, kNearRange,
                      number(summary.near_distance_error_median_m, 3), number(summary.near_distance_error_p95_m, 3));
  text += state_line("Frames:", summary.frame_status) + state_line("Ground:", summary.ground_state);
  return text + calibration_table(summary) + kind_table(summary);
}

std::string to_text(const std::vector<Comparison>& comparisons) {
  std::string text = "| figure | A | B | B - A, 95 % | |\n|---|---|---|---|---|\n";
  for (const Comparison& one : comparisons) {
    text += fmt::format("| {} | {:.4f} | {:.4f} | {:+.4f} [{:+.4f}, {:+.4f}] | {} |\n", one.name, one.a, one.b,
                        one.difference.value, one.difference.low, one.difference.high, one.is_worse() ? "worse" : "");
  }
  return text;
}

std::string to_text(const TrajectoryErrors& errors) {
  std::string text = fmt::format("Poses: {}, path {:.2f} m\n", errors.poses, errors.length_m);
  text += fmt::format("Accumulated: rotation {} (Frobenius), translation {} m\n", plus_minus(errors.rotation),
                      plus_minus(errors.translation_m));
  text += fmt::format("Frame to frame: rotation {} (Frobenius), translation {} m\n", plus_minus(errors.step_rotation),
                      plus_minus(errors.step_translation_m));
  text += fmt::format("Segments: {}; translation {} %, rotation {} deg/m\n", errors.segments,
                      number(errors.segment_translation_percent, 4), number(errors.segment_rotation_deg_per_m, 5));
  return text + fmt::format("End error: {} % of the path; absolute trajectory error: {:.4f} m RMSE\n",
                            number(errors.end_error_percent, 4), errors.ate_rmse_m);
}

std::string to_text(const DisparityErrors& errors) {
  constexpr double kPercent = 100.0;
  std::string text = "| of | density % | bad-1 % | bad-2 % | bad-3 % | mean error px |\n|---|---|---|---|---|---|\n";
  text += fmt::format("| valid pixels | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.3f} |\n", kPercent * errors.density,
                      kPercent * errors.bad_1, kPercent * errors.bad_2, kPercent * errors.bad_3, errors.mean_error_px);
  return text + fmt::format("| all {} known pixels, invalid = bad | | {:.2f} | {:.2f} | {:.2f} | |\n", errors.known_px,
                            kPercent * errors.bad_1_or_invalid, kPercent * errors.bad_2_or_invalid,
                            kPercent * errors.bad_3_or_invalid);
}

}  // namespace brink
