#include "brink/envelope.hpp"

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "brink/calibration.hpp"
#include "brink/files.hpp"
#include "brink/overlay.hpp"
#include "brink/pictures.hpp"
#include "common.hpp"
#include "input.hpp"

namespace brink::app {
namespace {

using Json = nlohmann::ordered_json;

struct EnvelopeOptions {
  CalibrationFiles calibration;
  std::vector<int> size;  // width, height of the pictures; empty = the calibration's
  ViewpointParams stand;
  DropShape hole;
  std::vector<double> distances_m = {1.0, 2.0, 3.0, 4.0, 5.0};
  std::vector<double> depths_m = {0.05, 0.15, 0.30};
  std::string picture;
  std::string out = "-";
  bool json = false;
  MethodOptions method;
  int threads = 0;
};

/// The largest disparity that the chosen matcher tries.
double max_disparity_of(const DisparityParams& params) {
  switch (params.matcher) {
    case Matcher::bm:
      return params.bm.max_disparity;
    case Matcher::sgbm:
    case Matcher::sgbm_wls:
      return params.sgbm.max_disparity;
    case Matcher::elas:
      break;
  }
  return params.elas.max_disparity;
}

Viewpoint open_viewpoint(const EnvelopeOptions& options, const DetectorParams& params) {
  cv::Size size = options.size.empty() ? cv::Size() : cv::Size(options.size[0], options.size[1]);
  const StereoCalibration calibration = read_calibration(options.calibration, size);
  std::string remark = fmt::format("{}; calibration: {}", options.calibration.path, describe(calibration));
  if (size.empty()) size = calibration.size;
  if (size.empty()) {
    size = {cvRound(2.0 * calibration.camera.cx + 1.0), cvRound(2.0 * calibration.camera.cy + 1.0)};
    remark +=
        fmt::format("; no size of pictures (--size): taken for {}x{} px, twice the principal point", size.width, size.height);
  }
  Viewpoint viewpoint = make_viewpoint(calibration.camera, size, options.stand);
  viewpoint.max_disparity = max_disparity_of(params.disparity);
  say(remark);
  return viewpoint;
}

/// What is told of one kind of drop.
struct KindOfDrop {
  std::string name;
  DropShape shape;
  std::vector<EnvelopePoint> smallest;           // by distances_m
  std::vector<std::optional<double>> largest_m;  // by depths_m
  std::vector<std::string> answers;              // "seen" or the rule, by distances_m, in each by depths_m
};

KindOfDrop compute_kind(const std::string& name, const DropShape& shape, const EnvelopeOptions& options,
                        const Viewpoint& viewpoint, const CandidateParams& params) {
  KindOfDrop kind{name, shape, compute_envelope(options.distances_m, shape, viewpoint, params), {}, {}};
  for (const double depth : options.depths_m) {
    kind.largest_m.push_back(estimate_largest_distance(depth, shape, viewpoint, params));
  }
  for (const double distance : options.distances_m) {
    for (const double depth : options.depths_m) {
      const DropSighting sighting = compute_sighting(make_drop(distance, depth, shape), viewpoint, params);
      kind.answers.push_back(sighting.rejection ? sighting.rejection->rule : "seen");
    }
  }
  return kind;
}

std::string to_cell(const std::optional<double>& value) { return value ? fmt::format("{:.2f} m", *value) : "none"; }

/// A table in Markdown: names of columns, then the rows with their cells.
std::string to_table(const std::vector<std::string>& columns, const std::vector<std::vector<std::string>>& rows) {
  std::string text = fmt::format("| {} |\n|", fmt::join(columns, " | "));
  for (std::size_t i = 0; i < columns.size(); ++i) text += "---|";
  for (const std::vector<std::string>& row : rows) text += fmt::format("\n| {} |", fmt::join(row, " | "));
  return text + "\n";
}

std::string describe(const Viewpoint& viewpoint) {
  const GroundPose& pose = viewpoint.ground.pose;
  return fmt::format("{}x{} px, {:.2f} m over the ground, looking down by {:.1f} deg, noise of disparities {} px",
                     viewpoint.size.width, viewpoint.size.height, pose.height_m, pose.pitch_deg,
                     viewpoint.ground.disparity_sd_px);
}

std::string to_text(const std::vector<KindOfDrop>& kinds, const EnvelopeOptions& options, const Viewpoint& viewpoint) {
  std::vector<std::string> smallest_columns{"rim at"};
  std::vector<std::string> largest_columns{"depth"};
  std::vector<std::string> answer_columns{"rim at"};
  for (const KindOfDrop& kind : kinds) {
    smallest_columns.push_back(kind.name + ", smallest depth seen");
    largest_columns.push_back(kind.name + ", seen up to");
    for (const double depth : options.depths_m) answer_columns.push_back(fmt::format("{}, {} m deep", kind.name, depth));
  }
  std::vector<std::vector<std::string>> smallest;
  std::vector<std::vector<std::string>> answers;
  for (std::size_t i = 0; i < options.distances_m.size(); ++i) {
    smallest.push_back({fmt::format("{} m", options.distances_m[i])});
    answers.push_back(smallest.back());
    for (const KindOfDrop& kind : kinds) {
      smallest.back().push_back(to_cell(kind.smallest[i].smallest_depth_m));
      const auto first = kind.answers.begin() + static_cast<std::ptrdiff_t>(i * options.depths_m.size());
      answers.back().insert(answers.back().end(), first, first + static_cast<std::ptrdiff_t>(options.depths_m.size()));
    }
  }
  std::vector<std::vector<std::string>> largest;
  for (std::size_t i = 0; i < options.depths_m.size(); ++i) {
    largest.push_back({fmt::format("{} m", options.depths_m[i])});
    for (const KindOfDrop& kind : kinds) largest.back().push_back(to_cell(kind.largest_m[i]));
  }
  return fmt::format("{}\n\n{}\n{}\nSeen, or the rule that the drop fails:\n{}", describe(viewpoint),
                     to_table(smallest_columns, smallest), to_table(largest_columns, largest),
                     to_table(answer_columns, answers));
}

std::string to_json(const std::vector<KindOfDrop>& kinds, const EnvelopeOptions& options, const Viewpoint& viewpoint) {
  const auto number = [](const std::optional<double>& value) { return value ? Json(*value) : Json(); };
  Json list = Json::array();
  for (const KindOfDrop& kind : kinds) {
    Json smallest = Json::array();
    Json sightings = Json::array();
    for (std::size_t i = 0; i < kind.smallest.size(); ++i) {
      const EnvelopePoint& point = kind.smallest[i];
      smallest.push_back({{"distance_m", point.distance_m}, {"depth_m", number(point.smallest_depth_m)}});
      for (std::size_t k = 0; k < options.depths_m.size(); ++k) {
        const std::string& answer = kind.answers[i * options.depths_m.size() + k];
        sightings.push_back({{"distance_m", point.distance_m}, {"depth_m", options.depths_m[k]}, {"answer", answer}});
      }
    }
    Json largest = Json::array();
    for (std::size_t i = 0; i < options.depths_m.size(); ++i) {
      largest.push_back({{"depth_m", options.depths_m[i]}, {"distance_m", number(kind.largest_m[i])}});
    }
    list.push_back({{"name", kind.name},
                    {"length_m", kind.shape.length_m},
                    {"width_m", kind.shape.width_m},
                    {"smallest_depths", smallest},
                    {"largest_distances", largest},
                    {"sightings", sightings}});
  }
  const Json json = {{"width_px", viewpoint.size.width},
                     {"height_px", viewpoint.size.height},
                     {"height_m", options.stand.height_m},
                     {"pitch_deg", options.stand.pitch_deg},
                     {"disparity_sd_px", options.stand.disparity_sd_px},
                     {"drops", list}};
  return json.dump(2) + "\n";
}

std::string draw(const std::vector<KindOfDrop>& kinds, const Viewpoint& viewpoint, const CandidateParams& params) {
  constexpr double kStep = 0.25;  // m
  std::vector<double> distances_m;
  const int steps = static_cast<int>(params.max_range_m / kStep);
  distances_m.reserve(static_cast<std::size_t>(steps));
  for (int i = 1; i <= steps; ++i) distances_m.push_back(i * kStep);
  std::vector<EnvelopeCurve> curves;
  curves.reserve(kinds.size());
  for (const KindOfDrop& kind : kinds) {
    curves.push_back({kind.name, compute_envelope(distances_m, kind.shape, viewpoint, params)});
  }
  return encode_png(draw_envelope(curves, describe(viewpoint)));
}

int tell(const EnvelopeOptions& options) {
  const auto threads = limit_threads(options.threads);
  const DetectorParams params = make_params(options.method);
  const Viewpoint viewpoint = open_viewpoint(options, params);
  OutputFile out(options.out);
  std::optional<OutputFile> picture;
  if (!options.picture.empty()) picture.emplace(options.picture);
  std::vector<KindOfDrop> kinds;
  const std::string hole = fmt::format("hole {} x {} m", options.hole.length_m, options.hole.width_m);
  kinds.push_back(compute_kind(hole, options.hole, options, viewpoint, params.candidates));
  kinds.push_back(compute_kind("edge", {kOpenEnded, kOpenEnded}, options, viewpoint, params.candidates));
  if (picture) {
    picture->write(draw(kinds, viewpoint, params.candidates));
    picture->commit();
  }
  out.write(options.json ? to_json(kinds, options, viewpoint) : to_text(kinds, options, viewpoint));
  out.commit();
  return kExitOk;
}

void add_stand_options(CLI::App& command, EnvelopeOptions& options) {
  command.add_option("--camera-height", options.stand.height_m, "Of the camera over the ground")
      ->type_name("M")
      ->capture_default_str();
  command.add_option("--pitch", options.stand.pitch_deg, "How far the camera looks down")
      ->type_name("DEG")
      ->capture_default_str();
  command
      .add_option(
          "--noise", options.stand.disparity_sd_px,
          "Standard deviation of a disparity in pixels. brink detect tells it for every frame (ground.disparity_sd_px); "
          "on simulated walks at 640x360 it is 0.1 by day to 0.3 at dusk")
      ->type_name("PX")
      ->capture_default_str();
  command.add_option("--size", options.size, "Width and height of the pictures, where the calibration does not tell them")
      ->type_name("W H")
      ->expected(2);
}

}  // namespace

Run add_envelope(CLI::App& command) {
  const auto options = std::make_shared<EnvelopeOptions>();
  add_calibration_options(command, options->calibration)->required();
  add_stand_options(command, *options);
  command.add_option("--length", options->hole.length_m, "Of the hole, along the line of sight")
      ->type_name("M")
      ->capture_default_str();
  command.add_option("--width", options->hole.width_m, "Of the hole, across")->type_name("M")->capture_default_str();
  command.add_option("--distances", options->distances_m, "Distances of the rim to tell the smallest drop at, in metres")
      ->type_name("M...")
      ->capture_default_str();
  command.add_option("--depths", options->depths_m, "Depths to tell the largest distance of, in metres")
      ->type_name("M...")
      ->capture_default_str();
  command.add_option("--picture", options->picture, "Also draw it as a diagram, PNG")->type_name("FILE");
  command.add_flag("--json", options->json, "JSON instead of text");
  command.add_option("--out", options->out, "Write the result to this file. Without it it goes to standard output")
      ->type_name("FILE");
  add_method_options(command, options->method);
  add_threads_option(command, options->threads);
  command.footer(
      "The smallest drops that this camera can show to the rules of Type 1, straight ahead in level ground: a hole of the "
      "given "
      "size,\n"
      "and an edge without end. Light, texture and what stands in the way are not in it (docs/algorithm.md, The envelope).\n"
      "Examples:\n"
      "  brink envelope --calib walk/calib.txt --picture envelope.png\n"
      "  brink envelope --calib calib.txt --size 1280 720 --camera-height 0.4 --pitch 10 --set candidates.min_depth_m=0.05");
  return [options] { return tell(*options); };
}

}  // namespace brink::app
