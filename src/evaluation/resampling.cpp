#include "evaluation/resampling.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "evaluation/statistics.hpp"

namespace brink {
namespace {

constexpr double kSecondsPerMinute = 60.0;
constexpr double kLowShare = 0.025;  // of the resamples lie below a 95 % interval
constexpr double kHighShare = 0.975;

void add_frame(Block& block, const FrameScore& frame) {
  block.raw += frame.raw();
  block.settled += frame.settled();
  block.ahead += frame.ahead();
  for (const DetectionScore& detection : frame.detections) {
    if (detection.distance_error_m) block.distance_errors.push_back(std::abs(*detection.distance_error_m));
  }
}

std::vector<Block> cut_into_blocks(const SequenceScore& sequence, int block_frames) {
  const std::size_t frames = sequence.frames.size();
  const auto length = static_cast<std::size_t>(block_frames);
  std::vector<Block> blocks((frames + length - 1) / length);
  for (std::size_t i = 0; i < frames; ++i) {
    Block& block = blocks[i / length];
    add_frame(block, sequence.frames[i]);
    if (!sequence.walked_m) continue;
    const double minutes = sequence.duration_s / kSecondsPerMinute / static_cast<double>(frames);
    block.minutes += minutes;
    if (sequence.frames[i].edges_ahead) block.ahead_minutes += minutes;
    block.walked_m += *sequence.walked_m / static_cast<double>(frames);
  }
  if (!sequence.walked_m) return blocks;
  for (const Episode& episode : sequence.episodes) {
    const auto begin = std::ranges::lower_bound(sequence.frames, episode.first_frame, {}, &FrameScore::frame);
    ++blocks[static_cast<std::size_t>(begin - sequence.frames.begin()) / length].episodes;
  }
  return blocks;
}

std::vector<std::size_t> draw_indices(std::mt19937_64& random, std::size_t count) {
  std::vector<std::size_t> indices(count);
  for (std::size_t& index : indices) index = static_cast<std::size_t>(random() % count);
  return indices;
}

Counts sum(const Pieces& pieces, const Draw& draw, Counts Block::*counts) {
  Counts total;
  for (const std::size_t index : draw.blocks) total += pieces.blocks[index].*counts;
  return total;
}

AheadCounts sum_ahead(const Pieces& pieces, const Draw& draw) {
  AheadCounts total;
  for (const std::size_t index : draw.blocks) total += pieces.blocks[index].ahead;
  return total;
}

double sum(const Pieces& pieces, const Draw& draw, double Block::*measure) {
  double total = 0.0;
  for (const std::size_t index : draw.blocks) total += pieces.blocks[index].*measure;
  return total;
}

std::optional<double> divide(double part, double whole) {
  if (!(whole > 0.0)) return std::nullopt;
  return part / whole;
}

std::optional<double> episodes_per(const Pieces& pieces, const Draw& draw, double Block::*measure, double unit) {
  double episodes = 0.0;
  for (const std::size_t index : draw.blocks) episodes += pieces.blocks[index].episodes;
  return divide(episodes, sum(pieces, draw, measure) / unit);
}

}  // namespace

Pieces cut_into_pieces(const std::vector<SequenceScore>& sequences, int block_frames) {
  Pieces pieces;
  for (const SequenceScore& sequence : sequences) {
    std::ranges::move(cut_into_blocks(sequence, block_frames), std::back_inserter(pieces.blocks));
    for (const ApproachEvent& event : sequence.events) pieces.in_time.push_back(event.in_time);
  }
  return pieces;
}

Draw draw_each(const Pieces& pieces) {
  Draw draw{std::vector<std::size_t>(pieces.blocks.size()), std::vector<std::size_t>(pieces.in_time.size())};
  std::iota(draw.blocks.begin(), draw.blocks.end(), std::size_t{0});
  std::iota(draw.events.begin(), draw.events.end(), std::size_t{0});
  return draw;
}

Draw draw_at_random(const Pieces& pieces, std::mt19937_64& random) {
  Draw draw;
  draw.blocks = draw_indices(random, pieces.blocks.size());
  draw.events = draw_indices(random, pieces.in_time.size());
  return draw;
}

std::optional<double> raw_tpr(const Pieces& pieces, const Draw& draw) { return sum(pieces, draw, &Block::raw).tpr(); }

std::optional<double> raw_ppv(const Pieces& pieces, const Draw& draw) { return sum(pieces, draw, &Block::raw).ppv(); }

std::optional<double> settled_tpr(const Pieces& pieces, const Draw& draw) { return sum(pieces, draw, &Block::settled).tpr(); }

std::optional<double> settled_ppv(const Pieces& pieces, const Draw& draw) { return sum(pieces, draw, &Block::settled).ppv(); }

std::optional<double> warned_in_time(const Pieces& pieces, const Draw& draw) {
  if (draw.events.empty()) return std::nullopt;
  const auto in_time = std::ranges::count_if(draw.events, [&pieces](std::size_t index) { return pieces.in_time[index]; });
  return static_cast<double>(in_time) / static_cast<double>(draw.events.size());
}

std::optional<double> reported_ahead(const Pieces& pieces, const Draw& draw) {
  const AheadCounts ahead = sum_ahead(pieces, draw);
  return divide(ahead.reported, ahead.settled);
}

std::optional<double> held(const Pieces& pieces, const Draw& draw) {
  const AheadCounts ahead = sum_ahead(pieces, draw);
  return divide(ahead.held, ahead.warned);
}

std::optional<double> dropped_per_minute(const Pieces& pieces, const Draw& draw) {
  return divide(sum_ahead(pieces, draw).dropped, sum(pieces, draw, &Block::ahead_minutes));
}

std::optional<double> false_silence(const Pieces& pieces, const Draw& draw) {
  const AheadCounts ahead = sum_ahead(pieces, draw);
  return divide(ahead.silent_frames, ahead.frames);
}

std::optional<double> episodes_per_minute(const Pieces& pieces, const Draw& draw) {
  return episodes_per(pieces, draw, &Block::minutes, 1.0);
}

std::optional<double> episodes_per_100m(const Pieces& pieces, const Draw& draw) {
  return episodes_per(pieces, draw, &Block::walked_m, 100.0);
}

std::optional<double> median_distance_error(const Pieces& pieces, const Draw& draw) {
  std::vector<double> errors;
  for (const std::size_t index : draw.blocks) {
    const std::vector<double>& more = pieces.blocks[index].distance_errors;
    errors.insert(errors.end(), more.begin(), more.end());
  }
  return quantile(std::move(errors), 0.5);
}

Estimate make_estimate(double value, const std::vector<double>& resampled) {
  return {value, quantile(resampled, kLowShare).value_or(value), quantile(resampled, kHighShare).value_or(value)};
}

}  // namespace brink
