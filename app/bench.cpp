#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <fstream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <sys/resource.h>
#include <unistd.h>

#include "allocations.hpp"
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
  std::string size;
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

/// Memory that is held now.
double resident_memory_mb() {
  std::ifstream file("/proc/self/statm");
  double total_pages = 0.0;
  double resident_pages = 0.0;
  file >> total_pages >> resident_pages;
  return resident_pages * static_cast<double>(::sysconf(_SC_PAGESIZE)) / (1024.0 * 1024.0);
}

/// WIDTHxHEIGHT. @throws std::invalid_argument when it is not.
cv::Size parse_size(const std::string& text) {
  constexpr int kMostPx = 10000;
  int width = 0;
  int height = 0;
  int end = 0;
  const bool parsed =
      std::sscanf(text.c_str(), "%5dx%5d%n", &width, &height, &end) == 2 && end == static_cast<int>(text.size());
  if (!parsed || width < kMinImageWidth || height < kMinImageHeight || width > kMostPx || height > kMostPx) {
    throw std::invalid_argument(fmt::format("--size {}: must be WIDTHxHEIGHT, {}x{} to {}x{} px", text, kMinImageWidth,
                                            kMinImageHeight, kMostPx, kMostPx));
  }
  return {width, height};
}

/// The same frame as a camera with other pixels would see it; the shape of the picture stays.
Frame resize(const Frame& frame, const cv::Size& size) {
  if (!frame.disparity.empty()) throw std::invalid_argument("--size needs both pictures, not a disparity image");
  const double scale = static_cast<double>(size.width) / frame.left.cols;
  if (std::abs(scale * frame.left.rows - size.height) > 1.0) {
    throw std::invalid_argument(fmt::format("--size {}x{}: must have the shape of the pictures, {}x{}", size.width, size.height,
                                            frame.left.cols, frame.left.rows));
  }
  const auto scaled = [&](const cv::Mat& picture) {
    cv::Mat other;
    cv::resize(picture, other, size, 0.0, 0.0, scale < 1.0 ? cv::INTER_AREA : cv::INTER_CUBIC);
    return other;
  };
  StereoCamera camera = frame.camera;
  camera.focal *= scale;
  camera.cx = (camera.cx + 0.5) * scale - 0.5;  // pixels are known by their middles
  camera.cy = (camera.cy + 0.5) * scale - 0.5;
  const cv::Mat left = frame.left_color.empty() ? cv::Mat(frame.left) : cv::Mat(frame.left_color);
  return make_frame(scaled(left), scaled(frame.right), camera, frame.index, frame.time);
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
  std::vector<double> resident_mb;   ///< after each round
  std::vector<double> allocated_mb;  ///< likewise; empty where it cannot be told
  std::optional<Allocations> allocations;
};

/// The frame at a place of an endless walk to and fro over all of them: the scene always moves smoothly, and one detector sees
/// as many frames as are wanted.
Frame walk_to_and_fro(const std::vector<Frame>& frames, int place, double step_s) {
  const int last = static_cast<int>(frames.size()) - 1;
  const int there = last > 0 ? place % (2 * last) : 0;
  Frame frame = frames[static_cast<std::size_t>(there <= last ? there : 2 * last - there)];
  frame.index = place;
  frame.time = place * step_s;
  frame.current_from_previous_rotation.reset();  // told for one direction only
  return frame;
}

Measurement measure(const std::vector<Frame>& frames, const DetectorParams& params, int repeat) {
  constexpr double kStep = 1.0 / 15.0;  // s, where the frames tell none
  const double told = frames.size() > 1 ? frames[1].time - frames[0].time : 0.0;
  const double step_s = told > 0.0 ? told : kStep;
  Measurement measurement;
  Detector detector(params);
  int place = 0;
  for (int round = 0; round < repeat; ++round) {
    const Frame& first = frames.front();
    if (!first.left.empty() && !first.right.empty()) measurement.yardstick_ms.push_back(measure_yardstick_ms(first));
    start_counting_allocations();
    for (std::size_t i = 0; i < frames.size(); ++i) {
      measurement.times.push_back(detector.process(walk_to_and_fro(frames, place++, step_s)).times);
    }
    measurement.allocations = stop_counting_allocations();  // of the last round
    measurement.resident_mb.push_back(resident_memory_mb());
    if (const std::optional<double> allocated = allocated_mb()) measurement.allocated_mb.push_back(*allocated);
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
  text += fmt::format("frames per second: {:.2f}\n", result["fps"].get<double>());
  const Json& allocations = result["allocations"];
  if (!allocations.is_null()) {
    text += fmt::format("allocations per frame, last round: {:.0f}, {:.1f} MB\n", allocations["calls"].get<double>(),
                        allocations["mb"].get<double>());
  }
  const Json& allocated = result["allocated_mb"];
  if (!allocated.is_null()) {
    text += fmt::format("allocated memory: {:.1f} MB after the first round, {:.1f} MB after the last\n",
                        allocated["first"].get<double>(), allocated["last"].get<double>());
  }
  return text + fmt::format("resident memory: peak {:.0f} MB, {:.1f} MB after the first round, {:.1f} MB after the last\n",
                            result["peak_memory_mb"].get<double>(), result["resident_mb"]["first"].get<double>(),
                            result["resident_mb"]["last"].get<double>());
}

int bench(const BenchOptions& options) {
  DetectorParams params = make_params(options.method);
  params.stills = params.stills || options.stills;
  const auto threads = limit_threads(options.threads);
  const std::optional<cv::Size> size = options.size.empty() ? std::nullopt : std::optional(parse_size(options.size));
  std::vector<Frame> frames = decode(open_input(options.input), options.frames);
  if (frames.empty()) return kExitData;
  if (size) {
    for (Frame& frame : frames) frame = resize(frame, *size);
  }
  Json result = {{"frames", frames.size()},
                 {"width", frames.front().size().width},
                 {"height", frames.front().size().height},
                 {"repeat", options.repeat},
                 {"threads", options.threads > 0 ? Json(options.threads) : Json()}};
  const Measurement measurement = measure(frames, params, options.repeat);
  result["times_ms"] = summarise_stages(measurement.times);
  result["yardstick_ms"] = measurement.yardstick_ms.empty() ? Json() : summarise(measurement.yardstick_ms);
  result["fps"] = 1000.0 / result["times_ms"]["total"]["median"].get<double>();
  // Linux notes the peak only now and then: what was measured in between may lie above it.
  result["peak_memory_mb"] = std::max(peak_memory_mb(), *std::ranges::max_element(measurement.resident_mb));
  const auto first_and_last = [](const std::vector<double>& values) {
    return values.empty() ? Json() : Json{{"first", values.front()}, {"last", values.back()}};
  };
  result["resident_mb"] = first_and_last(measurement.resident_mb);
  result["allocated_mb"] = first_and_last(measurement.allocated_mb);
  result["allocations"] = Json();
  if (measurement.allocations) {
    const auto per_frame = static_cast<double>(frames.size());
    result["allocations"] = {{"calls", static_cast<double>(measurement.allocations->calls) / per_frame},
                             {"mb", static_cast<double>(measurement.allocations->bytes) / per_frame / (1024.0 * 1024.0)}};
  }
  print(options.json ? result.dump(2) + "\n" : to_text(result));
  return kExitOk;
}

}  // namespace

Run add_bench(CLI::App& command) {
  const auto options = std::make_shared<BenchOptions>();
  constexpr int kMostRepeats = 10000;
  add_input_options(command, options->input);
  command.add_option("--repeat", options->repeat, "Process all frames this many times, to and fro")
      ->type_name("N")
      ->check(CLI::Range(1, kMostRepeats).description(""))
      ->capture_default_str();
  constexpr int kMostFrames = 1000;  // they are all kept in memory
  command.add_option("--frames", options->frames, "Take the first N frames")
      ->type_name("N")
      ->check(CLI::Range(1, kMostFrames).description(""))
      ->capture_default_str();
  command.add_option("--size", options->size, "Resize the pictures to so many pixels, of the same shape")->type_name("WxH");
  command.add_flag("--stills", options->stills, "The pictures are unrelated: without ego-motion and tracking");
  command.add_flag("--json", options->json, "Print JSON instead of text");
  add_method_options(command, options->method);
  add_threads_option(command, options->threads);
  command.footer(
      "All pictures are decoded before the first measurement, and one detector sees them all. Frames per second follow from "
      "the median of the total.\n"
      "Y is the time of OpenCV's StereoSGBM in the same run: a yardstick for other machines.\n"
      "Examples:\n"
      "  brink bench walk/ --threads 1\n"
      "  brink bench walk/ --size 640x360 --set elas.max_disparity=127\n"
      "  brink bench left.png --right right.png --calib calib.txt --repeat 20 --json");
  return [options] { return bench(*options); };
}

}  // namespace brink::app
