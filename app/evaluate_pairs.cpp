#include <algorithm>
#include <filesystem>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include "brink/detections.hpp"
#include "brink/evaluation_report.hpp"
#include "brink/files.hpp"
#include "brink/parameters.hpp"
#include "evaluate.hpp"

namespace brink::app {
namespace fs = std::filesystem;
namespace {

// Detections of another sequence must never be scored: the frames have to be the same ones.
void check_frames(const EvaluationPair& pair, const std::vector<Detection>& detections, const SequenceTruth& truth) {
  if (detections.size() != truth.frames().size()) {
    throw std::runtime_error(fmt::format("{}: has {} frames, expected the {} of {}", pair.detections, detections.size(),
                                         truth.frames().size(), pair.truth));
  }
  for (std::size_t i = 0; i < detections.size(); ++i) {
    if (detections[i].frame == truth.frames()[i]) continue;
    throw std::runtime_error(fmt::format("{}: frame {} = {}, expected {} as in {}", pair.detections, i, detections[i].frame,
                                         truth.frames()[i], pair.truth));
  }
}

SequenceScore evaluate_pair(const EvaluationPair& pair, const EvaluationParams& params, const CandidateParams& rules,
                            CocoWriter* coco) {
  const std::vector<Detection> detections = read_detections(pair.detections);
  const SequenceTruth truth(pair.truth);
  check_frames(pair, detections, truth);
  SequenceEvaluator evaluator(pair.name, params, rules);
  Progress progress(truth.size());
  for (int position = 0; position < truth.size(); ++position) {
    const Detection& detection = detections[static_cast<std::size_t>(position)];
    const FrameTruth frame = truth.read(position);
    try {
      evaluator.add(frame, detection);
    } catch (const std::invalid_argument& error) {
      throw std::runtime_error(fmt::format("{}: {}", pair.detections, error.what()));
    }
    const std::string picture = fmt::format("{}/image_2/{:06}.png", pair.name, detection.frame);
    if (coco != nullptr) coco->add(picture, frame.negative.size(), detection);
    progress.tell(position + 1);
  }
  return evaluator.finish();
}

}  // namespace

std::vector<EvaluationPair> list_suite(const std::string& suite, const std::string& results) {
  std::error_code error;
  std::vector<EvaluationPair> pairs;
  for (const fs::directory_entry& entry : fs::directory_iterator(suite, error)) {
    if (!fs::is_directory(entry.path() / "negative", error)) continue;
    const std::string name = entry.path().filename().string();
    if (!name.ends_with(".part"))
      pairs.push_back({name, (fs::path(results) / (name + ".jsonl")).string(), entry.path().string()});
  }
  if (pairs.empty())
    throw std::runtime_error(suite + ": holds no sequences with truth, expected folders with negative/ in them");
  std::sort(pairs.begin(), pairs.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return pairs;
}

Sequence open_sequence_of(const EvaluationPair& pair) {
  return pair.as ? open_depth_sequence(pair.truth, *pair.as) : open_sequence(pair.truth);
}

void run_missing(const std::vector<EvaluationPair>& pairs, const std::string& results, const DetectorParams& params) {
  const OutputFolder folder(results);
  const std::string noted = folder.file("parameters.yaml");
  std::string recipe = fmt::format("# brink {}\n{}stills: {}\n", BRINK_VERSION, to_yaml(params), params.stills);
  if (pairs.front().as) recipe += fmt::format("as: {}\n", to_string(*pairs.front().as));
  std::error_code error;
  if (!fs::exists(noted, error)) {
    write_file(noted, recipe);
  } else if (read_file(noted) != recipe) {
    throw std::runtime_error(noted + ": other parameters made these results, expected the same ones or an empty folder");
  }
  for (const EvaluationPair& pair : pairs) {
    if (fs::exists(pair.detections, error)) continue;
    OutputFile out(pair.detections);
    const auto on_frame = [&out](const FrameReading&, const Detection& detection) { out.write(to_json_line(detection)); };
    if (!process_sequence(open_sequence_of(pair), params, on_frame)) {
      throw std::runtime_error(pair.truth + ": interrupted; the same command goes on with this sequence");
    }
    out.commit();
  }
}

std::vector<SequenceScore> evaluate_pairs(const std::vector<EvaluationPair>& pairs, const EvaluationParams& params,
                                          const CandidateParams& rules, const EvaluationOutputs& outputs) {
  std::optional<CocoWriter> coco;
  if (!outputs.coco.empty()) coco.emplace();
  std::vector<SequenceScore> scores;
  scores.reserve(pairs.size());
  for (const EvaluationPair& pair : pairs) scores.push_back(evaluate_pair(pair, params, rules, coco ? &*coco : nullptr));
  if (coco) write_file(outputs.coco, coco->text());
  if (!outputs.gallery.empty()) write_gallery(pairs, scores, outputs);
  return scores;
}

}  // namespace brink::app
