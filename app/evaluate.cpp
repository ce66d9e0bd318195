#include "evaluate.hpp"

#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "brink/detections.hpp"
#include "brink/disparity.hpp"
#include "brink/evaluation_report.hpp"
#include "brink/files.hpp"
#include "brink/pictures.hpp"
#include "brink/trajectory.hpp"

namespace brink::app {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

struct EvaluateOptions {
  std::vector<std::string> detections;
  std::vector<std::string> truth;
  std::string suite;
  std::string results;
  std::string poses;
  std::string disparity;
  std::string mask;
  std::string out = "-";
  std::optional<DepthKind> as;
  bool run = false;
  bool stills = false;
  bool json = false;
  int threads = 0;
  double segment_m = 20.0;
  MethodOptions method;
  EvaluationParams params;
  EvaluationOutputs outputs;
};

const std::string& only_truth(const EvaluateOptions& options) {
  if (options.truth.size() != 1 || !options.detections.empty() || !options.suite.empty()) {
    throw std::invalid_argument("--poses and --disparity go with one --truth, and with nothing else to evaluate");
  }
  return options.truth.front();
}

std::string evaluate_poses(const EvaluateOptions& options) {
  std::error_code error;
  const fs::path truth = only_truth(options);
  const std::string file = fs::is_directory(truth, error) ? (truth / "poses.txt").string() : truth.string();
  const Trajectory estimated = read_trajectory(options.poses);
  const Trajectory exact = read_trajectory(file);
  if (estimated.world_from_camera.size() != exact.world_from_camera.size()) {
    throw std::runtime_error(fmt::format("{}: has {} poses, expected the {} of {}", options.poses,
                                         estimated.world_from_camera.size(), exact.world_from_camera.size(), file));
  }
  const TrajectoryErrors errors = compute_trajectory_errors(estimated, exact, options.segment_m);
  return options.json ? to_json(errors) : to_text(errors);
}

std::string evaluate_disparity(const EvaluateOptions& options) {
  const std::string& file = only_truth(options);
  const cv::Mat1f estimated = read_disparity(options.disparity);
  cv::Mat1f exact = read_disparity(file);
  exact.setTo(0.0F, exact == kInvalidDisparity);  // not known
  const cv::Mat1b mask = options.mask.empty() ? cv::Mat1b() : read_mask(options.mask);
  try {
    const DisparityErrors errors = compute_disparity_errors(estimated, exact, mask);
    return options.json ? to_json(errors) : to_text(errors);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(fmt::format("{} and {}: {}", options.disparity, file, error.what()));
  }
}

std::vector<EvaluationPair> list_pairs(const EvaluateOptions& options) {
  if (!options.suite.empty()) {
    if (!options.detections.empty() || !options.truth.empty() || options.results.empty()) {
      throw std::invalid_argument(
          "--suite DIR goes with --results DIR, which holds NAME.jsonl of each sequence, and without --truth");
    }
    std::vector<EvaluationPair> pairs = list_suite(options.suite, options.results);
    for (EvaluationPair& pair : pairs) pair.as = options.as;
    return pairs;
  }
  if (options.as) throw std::invalid_argument("--as goes with --suite");
  if (options.run) throw std::invalid_argument("--run goes with --suite");
  if (options.detections.empty() || options.detections.size() != options.truth.size()) {
    throw std::invalid_argument(
        fmt::format("{} files of detections and {} times --truth, expected one --truth SEQUENCE for each",
                    options.detections.size(), options.truth.size()));
  }
  std::vector<EvaluationPair> pairs;
  for (std::size_t i = 0; i < options.detections.size(); ++i) {
    const fs::path folder = fs::path(options.truth[i]).lexically_normal();
    const fs::path name = folder.has_filename() ? folder.filename() : folder.parent_path().filename();
    pairs.push_back({name.string(), options.detections[i], options.truth[i]});
  }
  return pairs;
}

std::string evaluate_detections(const EvaluateOptions& options) {
  options.params.validate();
  const std::vector<EvaluationPair> pairs = list_pairs(options);
  DetectorParams params = make_params(options.method);
  params.stills = options.stills;
  if (options.run) run_missing(pairs, options.results, params);
  const std::vector<SequenceScore> scores = evaluate_pairs(pairs, options.params, params.candidates, options.outputs);
  if (!options.json) return to_text(scores, options.params);
  Json json = Json::parse(to_json(scores, options.params));
  json["summary"] = Json::parse(to_json(summarise(scores, options.params)));
  json["by_domain"] = Json::parse(to_json(summarise_by_domain(scores, options.params)));
  return json.dump() + "\n";
}

int evaluate(const EvaluateOptions& options) {
  const auto threads = limit_threads(options.threads);
  OutputFile out(options.out);
  out.write(!options.poses.empty()       ? evaluate_poses(options)
            : !options.disparity.empty() ? evaluate_disparity(options)
                                         : evaluate_detections(options));
  out.commit();
  return kExitOk;
}

void add_protocol_options(CLI::App& command, EvaluationParams& params) {
  command.add_option("--min-depth", params.min_depth_m, "Instances that are shallower do not count")
      ->type_name("M")
      ->capture_default_str();
  command.add_option("--block", params.block_frames, "Frames are resampled in blocks of this many; 5 for short sequences")
      ->type_name("N")
      ->capture_default_str();
  command
      .add_option("--sightings", params.validation_sightings,
                  "Sightings in a row that a track needs, which the ceiling of the raw rate follows from")
      ->type_name("N")
      ->capture_default_str();
}

void add_run_options(CLI::App& command, EvaluateOptions& options) {
  command.add_option("--suite", options.suite, "Folder of sequences with truth, all of which are evaluated")->type_name("DIR");
  command.add_option("--results", options.results, "Folder of NAME.jsonl for each sequence NAME of the suite")
      ->type_name("DIR");
  command.add_flag("--run", options.run, "First detect in every sequence of the suite whose NAME.jsonl is missing");
  add_as_option(command, options.as,
                "With --suite: detect from the disparity/ or depth/ of each sequence, with its left pictures if there are any: "
                "an ideal sensor");
  command.add_flag("--stills", options.stills, "With --run: as brink detect --stills");
  add_method_options(command, options.method);
  add_threads_option(command, options.threads);
}

}  // namespace

Run add_evaluate(CLI::App& command) {
  const auto options = std::make_shared<EvaluateOptions>();
  command.add_option("DETECTIONS", options->detections, "Files that brink detect wrote, JSON Lines");
  command
      .add_option("--truth", options->truth,
                  "Sequence with truth for each of them, in the same order; with --poses also a file of poses, with "
                  "--disparity the picture of true disparities")
      ->type_name("SEQUENCE");
  add_run_options(command, *options);
  command.add_option("--poses", options->poses, "Evaluate this trajectory instead, in KITTI's or TUM's format")
      ->type_name("FILE");
  command.add_option("--segment", options->segment_m, "With --poses: length of KITTI's segments in metres")
      ->type_name("M")
      ->capture_default_str();
  command.add_option("--disparity", options->disparity, "Evaluate this disparity image instead, PNG of 16 bit or PFM")
      ->type_name("FILE");
  command.add_option("--mask", options->mask, "With --disparity: only pixels count where this picture is not 0")
      ->type_name("FILE");
  command.add_flag("--json", options->json, "JSON instead of text: the tables and all that brink compare needs");
  command.add_option("--out", options->out, "Write the result to this file. Without it it goes to standard output")
      ->type_name("FILE");
  command.add_option("--coco", options->outputs.coco, "Also write the detections as a COCO data set")->type_name("FILE");
  command
      .add_option("--gallery", options->outputs.gallery,
                  "Also write pictures of the worst misses, false alarms and distance errors, and causes.md")
      ->type_name("DIR");
  constexpr int kGallery = 24;
  options->outputs.gallery_size = kGallery;
  command.add_option("--gallery-size", options->outputs.gallery_size, "Pictures of each kind")
      ->type_name("N")
      ->check(CLI::Range(1, 10000).description(""))
      ->capture_default_str();
  add_protocol_options(command, options->params);
  command.footer(
      "The protocol is docs/evaluation.md.\n"
      "Examples:\n"
      "  brink evaluate walk.jsonl --truth walk/\n"
      "  brink evaluate --suite walks/ --results out/ --run --json --out scores.json --gallery pictures/\n"
      "  brink evaluate --poses path.txt --truth walk/\n"
      "  brink evaluate --disparity disparity.png --truth walk/disparity/000000.png");
  return [options] { return evaluate(*options); };
}

}  // namespace brink::app
