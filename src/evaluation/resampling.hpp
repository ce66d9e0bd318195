#pragma once

#include <cstddef>
#include <optional>
#include <random>
#include <vector>

#include "brink/evaluation.hpp"

namespace brink {

/// Consecutive frames of one sequence: neighbours tell the same, so they are drawn together.
struct Block {
  Counts raw;
  Counts settled;
  AheadCounts ahead;
  double ahead_minutes = 0.0;           ///< of a sequence in which edges ahead are known; 0 otherwise
  int episodes = 0;                     ///< those that begin here
  double minutes = 0.0;                 ///< of a sequence with poses; 0 without: nothing is known of episodes then
  double walked_m = 0.0;                ///< the block's share of the sequence's path
  std::vector<double> distance_errors;  ///< absolute, m
};

/// A run cut into the pieces that the bootstrap draws from, pooled over its sequences.
struct Pieces {
  std::vector<Block> blocks;  ///< of block_frames frames; the last of a sequence may be shorter
  std::vector<bool> in_time;  ///< for each event
};
Pieces cut_into_pieces(const std::vector<SequenceScore>& sequences, int block_frames);

/// Pieces by their index; one may be there several times.
struct Draw {
  std::vector<std::size_t> blocks;
  std::vector<std::size_t> events;
};
/// Each piece once.
Draw draw_each(const Pieces& pieces);
/// As many pieces as there are, with replacement. The same for every machine and C++ library: as the distributions of the
/// standard library are not, it takes the remainder, whose bias is below 1e-12 for a million pieces.
Draw draw_at_random(const Pieces& pieces, std::mt19937_64& random);

/// A figure of the pieces drawn. Empty when there is nothing to count.
using Figure = std::optional<double> (*)(const Pieces& pieces, const Draw& draw);
std::optional<double> raw_tpr(const Pieces& pieces, const Draw& draw);
std::optional<double> raw_ppv(const Pieces& pieces, const Draw& draw);
std::optional<double> settled_tpr(const Pieces& pieces, const Draw& draw);
std::optional<double> settled_ppv(const Pieces& pieces, const Draw& draw);
std::optional<double> warned_in_time(const Pieces& pieces, const Draw& draw);
std::optional<double> reported_ahead(const Pieces& pieces, const Draw& draw);
std::optional<double> held(const Pieces& pieces, const Draw& draw);
std::optional<double> dropped_per_minute(const Pieces& pieces, const Draw& draw);
std::optional<double> false_silence(const Pieces& pieces, const Draw& draw);
std::optional<double> episodes_per_minute(const Pieces& pieces, const Draw& draw);
std::optional<double> episodes_per_100m(const Pieces& pieces, const Draw& draw);
std::optional<double> median_distance_error(const Pieces& pieces, const Draw& draw);

/// A value with the 2.5 and 97.5 percentiles of its resamples; the value itself when none of them has one.
Estimate make_estimate(double value, const std::vector<double>& resampled);

}  // namespace brink
