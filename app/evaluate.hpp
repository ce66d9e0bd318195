#pragma once

#include <optional>
#include <string>
#include <vector>

#include "brink/evaluation.hpp"
#include "common.hpp"
#include "input.hpp"

namespace brink::app {

/// Detections and the sequence whose truth they are compared with.
struct EvaluationPair {
  std::string name;                            ///< of the sequence's folder
  std::string detections;                      ///< file
  std::string truth;                           ///< folder
  std::optional<DepthKind> as = std::nullopt;  ///< what its detections are made from in place of right pictures
};
/// The sequence that the detections are made from. @throws as open_sequence does.
Sequence open_sequence_of(const EvaluationPair& pair);

/// What an evaluation of detections writes beside the scores; empty = not.
struct EvaluationOutputs {
  std::string coco;
  std::string gallery;
  int gallery_size = 0;  ///< pictures of each kind
};

/// Sequences with truth in a folder, in the order of their names, with NAME.jsonl in the folder of results.
/// @throws std::runtime_error "folder: ..." when there is none.
std::vector<EvaluationPair> list_suite(const std::string& suite, const std::string& results);

/// Runs the detector where detections are missing. The parameters are noted in the folder of the results.
/// @throws std::runtime_error when results are there that were made with other parameters.
void run_missing(const std::vector<EvaluationPair>& pairs, const std::string& results, const DetectorParams& params);

/// Scores of all pairs, in their order. @param rules that the detections were made with. @throws std::runtime_error "file: ..."
/// when a pair does not fit together.
std::vector<SequenceScore> evaluate_pairs(const std::vector<EvaluationPair>& pairs, const EvaluationParams& params,
                                          const CandidateParams& rules, const EvaluationOutputs& outputs);

/// Writes the pictures of the worst misses, false alarms and distance errors, and causes.md: why all of them came about.
void write_gallery(const std::vector<EvaluationPair>& pairs, const std::vector<SequenceScore>& scores,
                   const EvaluationOutputs& outputs);

}  // namespace brink::app
