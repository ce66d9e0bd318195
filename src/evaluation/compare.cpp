#include <array>
#include <random>
#include <stdexcept>

#include <fmt/format.h>

#include "evaluation/resampling.hpp"

namespace brink {
namespace {

struct ComparedFigure {
  const char* name;
  Figure compute;
  bool more_is_better;
};

constexpr std::array<ComparedFigure, 11> kFigures = {{{"raw TPR", raw_tpr, true},
                                                      {"raw PPV", raw_ppv, true},
                                                      {"settled TPR", settled_tpr, true},
                                                      {"settled PPV", settled_ppv, true},
                                                      {"events warned in time", warned_in_time, true},
                                                      {"reported in the last metres", reported_ahead, true},
                                                      {"held in the last metres", held, true},
                                                      {"dropped warnings per minute", dropped_per_minute, false},
                                                      {"false silence", false_silence, false},
                                                      {"false-alarm episodes per minute", episodes_per_minute, false},
                                                      {"distance error, median, m", median_distance_error, false}}};

[[noreturn]] void refuse(const std::string& what, const std::string& a, const std::string& b) {
  throw std::invalid_argument(fmt::format("{} = {} and {}, must be equal to be compared", what, a, b));
}

void require_same_frames(const SequenceScore& a, const SequenceScore& b) {
  if (a.frames.size() != b.frames.size()) {
    refuse(a.name + ": frames", std::to_string(a.frames.size()), std::to_string(b.frames.size()));
  }
  for (std::size_t i = 0; i < a.frames.size(); ++i) {
    if (a.frames[i].frame != b.frames[i].frame) {
      refuse(fmt::format("{}: number of frame {}", a.name, i), std::to_string(a.frames[i].frame),
             std::to_string(b.frames[i].frame));
    }
  }
}

// Events follow from the truth alone: where they differ, the truth or the parameters did.
void require_same_events(const SequenceScore& a, const SequenceScore& b) {
  if (a.events.size() != b.events.size()) {
    refuse(a.name + ": events", std::to_string(a.events.size()), std::to_string(b.events.size()));
  }
  const auto describe = [](const ApproachEvent& event) {
    return fmt::format("id {} from frame {}", event.id, event.first_frame);
  };
  for (std::size_t i = 0; i < a.events.size(); ++i) {
    if (describe(a.events[i]) != describe(b.events[i])) {
      refuse(fmt::format("{}: event {}", a.name, i), describe(a.events[i]), describe(b.events[i]));
    }
  }
}

void require_same_sequences(const std::vector<SequenceScore>& a, const std::vector<SequenceScore>& b) {
  if (a.empty() && b.empty()) throw std::invalid_argument("sequences = 0, must be 1 or more");
  if (a.size() != b.size()) refuse("sequences", std::to_string(a.size()), std::to_string(b.size()));
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i].name != b[i].name) refuse(fmt::format("name of sequence {}", i), a[i].name, b[i].name);
    require_same_frames(a[i], b[i]);
    require_same_events(a[i], b[i]);
  }
}

}  // namespace

std::vector<Comparison> compare(const std::vector<SequenceScore>& a, const std::vector<SequenceScore>& b,
                                const EvaluationParams& params) {
  params.validate();
  require_same_sequences(a, b);
  const Pieces pieces_a = cut_into_pieces(a, params.block_frames);
  const Pieces pieces_b = cut_into_pieces(b, params.block_frames);
  std::array<std::vector<double>, kFigures.size()> differences;
  std::mt19937_64 random(static_cast<std::uint64_t>(params.seed));
  for (int i = 0; i < params.resamplings; ++i) {
    const Draw draw = draw_at_random(pieces_a, random);  // b has as many pieces: the same ones are drawn
    for (std::size_t k = 0; k < kFigures.size(); ++k) {
      const std::optional<double> value_a = kFigures.at(k).compute(pieces_a, draw);
      const std::optional<double> value_b = kFigures.at(k).compute(pieces_b, draw);
      if (value_a && value_b) differences.at(k).push_back(*value_b - *value_a);
    }
  }
  std::vector<Comparison> comparisons;
  for (std::size_t k = 0; k < kFigures.size(); ++k) {
    const ComparedFigure& figure = kFigures.at(k);
    const std::optional<double> value_a = figure.compute(pieces_a, draw_each(pieces_a));
    const std::optional<double> value_b = figure.compute(pieces_b, draw_each(pieces_b));
    if (!value_a || !value_b) continue;
    const Estimate difference = make_estimate(*value_b - *value_a, differences.at(k));
    comparisons.push_back({figure.name, *value_a, *value_b, difference, figure.more_is_better});
  }
  return comparisons;
}

}  // namespace brink
