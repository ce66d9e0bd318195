#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>
#include <tbb/global_control.h>

#include "brink/detector.hpp"
#include "brink/sequence.hpp"

namespace brink::app {

constexpr int kExitOk = 0;
constexpr int kExitData = 1;           ///< a file or the scene is at fault
constexpr int kExitInterrupted = 130;  ///< Ctrl-C, as shells have it
constexpr int kExitUsage = 2;          ///< the command line is at fault: std::invalid_argument

/// What a subcommand does once its options are read; returns the exit code.
using Run = std::function<int()>;

/// Options that choose the method and its parameters, the same for all subcommands that compute something.
struct MethodOptions {
  std::string method = "brink";
  std::string params;
  std::string matcher;
  std::vector<std::string> settings;
};
void add_method_options(CLI::App& command, MethodOptions& options);
/// In this order, later ones winning: --method, --params, --matcher, --set.
/// @throws std::invalid_argument or std::runtime_error (a parameter file) with the fault.
DetectorParams make_params(const MethodOptions& options);

/// What happens with each frame, in order.
using ProcessedFrame = std::function<void(const FrameReading&, const Detection&)>;
/// The detector over a whole sequence; a frame that cannot be read is told as such and the next one goes on.
/// @param world_from_camera poses from elsewhere, one for each frame; empty = none.
/// @return false when it was interrupted before the last frame.
bool process_sequence(const Sequence& sequence, const DetectorParams& params, const ProcessedFrame& on_frame,
                      const std::vector<Eigen::Isometry3d>& world_from_camera = {});

/// Ctrl-C was pressed: end cleanly with what is done so far.
bool is_interrupted();
/// From here on Ctrl-C is noted instead of ending the process; a second one ends it.
void catch_interruption();

/// Says why frames cannot be read: a reason that holds for many frames in a row is said once.
class Faults {
 public:
  void tell(const FrameReading& reading);

 private:
  std::string last_;
};

/// --threads; no limit when it is not given.
void add_threads_option(CLI::App& command, int& threads);
/// The limit holds as long as the result lives. @param threads 0 = the option was not given.
std::unique_ptr<tbb::global_control> limit_threads(int threads);

/// One line for people, on standard error.
void say(std::string text);
/// A result, on standard output. @throws std::runtime_error when it cannot be written.
void print(std::string_view text);

/// Says on a terminal how far the work is and how long it will still take; elsewhere nothing.
class Progress {
 public:
  explicit Progress(int frames);
  /// One frame was there already: it takes no time.
  void skip() { ++skipped_; }
  /// @param done frames, with those skipped.
  void tell(int done);

 private:
  int frames_;
  int skipped_ = 0;
  bool shown_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point last_ = start_;
};

// The subcommands: each adds its options and tells what to run.
Run add_detect(CLI::App& command);
Run add_disparity(CLI::App& command);
Run add_odometry(CLI::App& command);
Run add_params(CLI::App& command);
Run add_envelope(CLI::App& command);
Run add_bench(CLI::App& command);
Run add_simulate(CLI::App& command);
Run add_evaluate(CLI::App& command);
Run add_compare(CLI::App& command);

}  // namespace brink::app
