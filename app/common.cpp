#include "common.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <unistd.h>

#include "brink/files.hpp"
#include "brink/parameters.hpp"

namespace brink::app {
namespace {

constexpr const char* kClearLine = "\r\x1b[K";  // on a terminal; there a bar may stand in the line

volatile std::sig_atomic_t interrupted = 0;

extern "C" void note_interruption(int signal) {
  interrupted = 1;
  std::signal(signal, SIG_DFL);
}

bool is_terminal() { return ::isatty(STDERR_FILENO) != 0; }

}  // namespace

void add_method_options(CLI::App& command, MethodOptions& options) {
  command.add_option("--method", options.method, "brink: what measures best, or paper: the rules of the paper to the letter")
      ->type_name("NAME")
      ->check(CLI::IsMember({"brink", "paper"}).description(""))
      ->capture_default_str();
  command.add_option("--params", options.params, "File of parameters (YAML), as brink params --yaml writes it")
      ->type_name("FILE");
  command
      .add_option("--matcher", options.matcher, "Stereo matcher: elas, bm, sgbm or sgbm-wls. Without it that of the parameters")
      ->type_name("NAME")
      ->check(CLI::IsMember({"elas", "bm", "sgbm", "sgbm-wls"}).description(""));
  command
      .add_option("--set", options.settings,
                  "Set one parameter, as in --set candidates.min_depth_m=0.01. May be given many times; brink params lists all")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false)  // one value each: the next word is something else
      ->take_all();
}

DetectorParams make_params(const MethodOptions& options) {
  DetectorParams params = options.method == "paper" ? DetectorParams::paper() : DetectorParams::brink();
  if (!options.params.empty()) params = read_parameters(options.params, params);
  if (!options.matcher.empty()) params.disparity.matcher = matcher_from_string(options.matcher);
  std::vector<Setting> settings;
  for (const std::string& text : options.settings) settings.push_back(parse_setting(text));
  params = with_settings(params, settings);
  params.validate();
  return params;
}

void Faults::tell(const FrameReading& reading) {
  if (reading.reason != last_ && !reading.reason.empty()) say(reading.reason);
  last_ = reading.reason;
}

void add_threads_option(CLI::App& command, int& threads) {
  constexpr int kMostThreads = 1024;
  command.add_option("--threads", threads, "Use at most this many threads. Without it all cores. Results do not depend on it")
      ->type_name("N")
      ->check(CLI::Range(1, kMostThreads).description(""));
}

std::unique_ptr<tbb::global_control> limit_threads(int threads) {
  if (threads == 0) return nullptr;
  cv::setNumThreads(threads);
  return std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
}

bool process_sequence(const Sequence& sequence, const DetectorParams& params, const ProcessedFrame& on_frame,
                      const std::vector<Eigen::Isometry3d>& world_from_camera) {
  catch_interruption();
  Detector detector(params);
  Progress progress(sequence.size());
  for (int position = 0; position < sequence.size() && !is_interrupted(); ++position) {
    FrameReading reading = sequence.read(position);
    const Frame& frame = reading.frame;
    if (!world_from_camera.empty()) reading.frame.world_from_camera = world_from_camera[static_cast<std::size_t>(position)];
    const bool readable = reading.status == FrameStatus::ok;
    on_frame(reading, readable ? detector.process(frame)
                               : detector.process_failed(frame.index, frame.time, reading.status, reading.reason));
    progress.tell(position + 1);
  }
  return !is_interrupted();
}

bool is_interrupted() { return interrupted != 0; }

void catch_interruption() { std::signal(SIGINT, note_interruption); }

void say(std::string text) {
  // One line, and nothing that a terminal would obey: names and texts of files are in it.
  std::replace_if(
      text.begin(), text.end(), [](unsigned char letter) { return std::iscntrl(letter) != 0; }, ' ');
  fmt::print(stderr, "{}brink: {}\n", is_terminal() ? kClearLine : "", text);
}

Progress::Progress(int frames) : frames_(frames), shown_(is_terminal()) {}

void Progress::tell(int done) {
  const auto now = std::chrono::steady_clock::now();
  if (!shown_ || (done < frames_ && now - last_ < std::chrono::seconds(1))) return;
  last_ = now;
  if (done == frames_) {
    fmt::print(stderr, "{}", kClearLine);
    return;
  }
  constexpr int kBar = 30;
  constexpr int kMinute = 60;
  const double each = std::chrono::duration<double>(now - start_).count() / (done - skipped_);
  const int left = static_cast<int>(std::ceil(each * (frames_ - done)));
  const auto filled = static_cast<std::size_t>(static_cast<std::int64_t>(kBar) * done / frames_);
  fmt::print(stderr, "{}[{:-<{}}] {} of {} frames, {} min {:02} s left", kClearLine, std::string(filled, '#'), kBar, done,
             frames_, left / kMinute, left % kMinute);
}

void print(std::string_view text) {
  OutputFile output("-");
  output.write(text);
  output.commit();
}

}  // namespace brink::app
