#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include "common.hpp"
#include "input.hpp"
#include "yardstick.hpp"

namespace brink::app {
namespace {

using Json = nlohmann::ordered_json;

struct BenchOptions {
  InputOptions input;
  MethodOptions method;
  int threads = 0;
  int repeat = 7;
  int frames = 30;
  bool stills = false;
  bool json = false;
};

using Stage = std::pair<const char*, double StageTimes::*>;
constexpr std::array<Stage, 7> kStages{{{"disparity", &StageTimes::disparity},
                                        {"ground", &StageTimes::ground},
                                        {"below_ground", &StageTimes::below_ground},
                                        {"no_disparity", &StageTimes::no_disparity},
                                        {"ego_motion", &StageTimes::ego_motion},
                                        {"tracking", &StageTimes::tracking},
                                        {"total", &StageTimes::total}}};

/// The smallest value that at least this share of all values do not exceed. @param sorted ascending, not empty.
double quantile(const std::vector<double>& sorted, double share) {
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  return sorted[std::max<std::size_t>(rank, 1) - 1];
}

double peak_memory_mb() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

// Decoding takes longer than several stages together and is no part of the method.
std::vector<Frame> decode(const Sequence& sequence, int most) {
  std::vector<Frame> frames;
  Faults faults;
  for (int position = 0; position < std::min(most, sequence.size()); ++position) {
    FrameReading reading = sequence.read(position);
    faults.tell(reading);
    if (reading.status == FrameStatus::ok) frames.push_back(std::move(reading.frame));
  }
  return frames;
}

/// Machines differ and are noisy, the ratios of two times on one less.
double measure_yardstick_ms(const Frame& frame) {
  const auto start = std::chrono::steady_clock::now();
  run_yardstick(frame.left, frame.right);
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

struct Measurement {
  std::vector<StageTimes> times;
  std::vector<double> yardstick_ms;  ///< one of each round; none without both pictures
};

Measurement measure(const std::vector<Frame>& frames, const DetectorParams& params, int repeat) {
  Measurement measurement;
  for (int round = 0; round < repeat; ++round) {
    const Frame& first = frames.front();
    if (!first.left.empty() && !first.right.empty()) measurement.yardstick_ms.push_back(measure_yardstick_ms(first));
    Detector detector(params);  // every round begins anew: time does not run backwards
    for (const Frame& frame : frames) measurement.times.push_back(detector.process(frame).times);
  }
  return measurement;
}

Json summarise(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return {{"median", quantile(values, 0.5)}, {"p95", quantile(values, 0.95)}, {"max", values.back()}};
}

Json summarise_stages(const std::vector<StageTimes>& times) {
  Json stages;
  for (const auto& [name, member] : kStages) {
    std::vector<double> values;
    values.reserve(times.size());
    for (const StageTimes& one : times) values.push_back(one.*member);
    stages[name] = summarise(std::move(values));
  }
  return stages;
}

std::string to_text(const Json& result) {
  std::string text = fmt::format(
      "{} frames of {}x{} px, {} times, {}\n", result["frames"].get<int>(), result["width"].get<int>(),
      result["height"].get<int>(), result["repeat"].get<int>(),
      result["threads"].is_null() ? "all threads" : fmt::format("at most {} threads", result["threads"].get<int>()));
  const double yardstick_ms = result["yardstick_ms"].is_null() ? 0.0 : result["yardstick_ms"]["median"].get<double>();
  for (const auto& [name, stage] : result["times_ms"].items()) {
    const double median = stage["median"].get<double>();
    text += fmt::format("{}: median {:.2f} ms{}, p95 {:.2f} ms, max {:.2f} ms\n", name, median,
                        yardstick_ms > 0.0 ? fmt::format(" = {:.3f} Y", median / yardstick_ms) : "", stage["p95"].get<double>(),
                        stage["max"].get<double>());
  }
  if (yardstick_ms > 0.0) {
    text += fmt::format("Y = {:.1f} ms: StereoSGBM, 3 ways, 128 disparities, one thread, the first pair, once a round\n",
                        yardstick_ms);
  }
  return text + fmt::format("frames per second: {:.2f}\npeak resident memory: {:.0f} MB\n", result["fps"].get<double>(),
                            result["peak_memory_mb"].get<double>());
}

int bench(const BenchOptions& options) {
  DetectorParams params = make_params(options.method);
  params.stills = params.stills || options.stills;
  const auto threads = limit_threads(options.threads);
  const std::vector<Frame> frames = decode(open_input(options.input), options.frames);
  if (frames.empty()) return kExitData;
  Json result = {{"frames", frames.size()},
                 {"width", frames.front().size().width},
                 {"height", frames.front().size().height},
                 {"repeat", options.repeat},
                 {"threads", options.threads > 0 ? Json(options.threads) : Json()}};
  const Measurement measurement = measure(frames, params, options.repeat);
  result["times_ms"] = summarise_stages(measurement.times);
  result["yardstick_ms"] = measurement.yardstick_ms.empty() ? Json() : summarise(measurement.yardstick_ms);
  result["fps"] = 1000.0 / result["times_ms"]["total"]["median"].get<double>();
  result["peak_memory_mb"] = peak_memory_mb();
  print(options.json ? result.dump(2) + "\n" : to_text(result));
  return kExitOk;
}

}  // namespace

Run add_bench(CLI::App& command) {
  const auto options = std::make_shared<BenchOptions>();
  constexpr int kMostRepeats = 10000;
  add_input_options(command, options->input);
  command.add_option("--repeat", options->repeat, "Process all frames this many times")
      ->type_name("N")
      ->check(CLI::Range(1, kMostRepeats).description(""))
      ->capture_default_str();
  constexpr int kMostFrames = 1000;  // they are all kept in memory
  command.add_option("--frames", options->frames, "Take the first N frames")
      ->type_name("N")
      ->check(CLI::Range(1, kMostFrames).description(""))
      ->capture_default_str();
  command.add_flag("--stills", options->stills, "The pictures are unrelated: without ego-motion and tracking");
  command.add_flag("--json", options->json, "Print JSON instead of text");
  add_method_options(command, options->method);
  add_threads_option(command, options->threads);
  command.footer(
      "All pictures are decoded before the first measurement. Frames per second follow from the median of the total.\n"
      "Y is the time of OpenCV's StereoSGBM in the same run: a yardstick for other machines.\n"
      "Examples:\n"
      "  brink bench walk/ --threads 1\n"
      "  brink bench left.png --right right.png --calib calib.txt --repeat 20 --json");
  return [options] { return bench(*options); };
}

}  // namespace brink::app
