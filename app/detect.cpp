#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "brink/detections.hpp"
#include "brink/files.hpp"
#include "brink/overlay.hpp"
#include "brink/pictures.hpp"
#include "brink/trajectory.hpp"
#include "common.hpp"

namespace brink::app {
namespace {

struct DetectOptions {
  InputOptions input;
  MethodOptions method;
  std::string out = "-";
  std::string overlay;
  std::string poses;
  int threads = 0;
  bool stills = false;
};

/// What the last line on the screen tells.
struct Summary {
  int frames = 0;
  int ok = 0;
  int seen = 0;
  int uncertain = 0;
  int not_visible = 0;
  std::string last_reason;  ///< of a ground that was not visible
  std::size_t obstacles = 0;

  void add(const Detection& detection) {
    ++frames;
    if (detection.status != FrameStatus::ok) return;
    ++ok;
    obstacles += detection.obstacles.size();
    if (detection.ground.state == GroundState::seen) ++seen;
    if (detection.ground.state == GroundState::uncertain) ++uncertain;
    if (detection.ground.state == GroundState::not_visible) {
      ++not_visible;
      last_reason = detection.ground.reason;
    }
  }

  [[nodiscard]] std::string text() const {
    std::string text = fmt::format("{} of {} frames ok; ground seen in {}, uncertain in {}, not visible in {}", ok, frames,
                                   seen, uncertain, not_visible);
    if (!last_reason.empty()) text += fmt::format(" ({})", last_reason);
    return text + fmt::format("; obstacles: {}", obstacles);
  }
};

void write_overlays(const OutputFolder& folder, const Frame& frame, const Detection& detection, const CandidateParams& params) {
  const auto write = [&](const char* name, const cv::Mat3b& picture) {
    write_file(folder.file(fmt::format("{:06}_{}.png", frame.index, name)), encode_png(picture));
  };
  write("ground", draw_ground(frame, detection, params));
  write("disparity", draw_disparity(detection.disparity));
  write("candidates", draw_candidates(frame, detection));
  write("drops", draw_obstacles(frame, detection));
}

/// The poses of --poses, one for each frame.
std::vector<Eigen::Isometry3d> read_given_poses(const std::string& path, const Sequence& sequence) {
  if (path.empty()) return {};
  std::vector<Eigen::Isometry3d> poses = read_trajectory(path).world_from_camera;
  if (poses.size() != static_cast<std::size_t>(sequence.size())) {
    throw std::runtime_error(
        fmt::format("{}: has {} poses, expected one for each of {} frames", path, poses.size(), sequence.size()));
  }
  return poses;
}

int detect(const DetectOptions& options) {
  DetectorParams params = make_params(options.method);
  const Sequence sequence = open_input(options.input);
  const bool pair = !options.input.right.empty();
  params.stills = params.stills || options.stills || pair;
  const auto threads = limit_threads(options.threads);
  std::optional<OutputFolder> overlay;
  if (!options.overlay.empty()) overlay.emplace(options.overlay);
  OutputFile out(options.out);

  Summary summary;
  Faults faults;
  const auto on_frame = [&](const FrameReading& reading, const Detection& detection) {
    const bool readable = reading.status == FrameStatus::ok;
    faults.tell(reading);
    out.write(to_json_line(detection));
    if (readable && overlay) write_overlays(*overlay, reading.frame, detection, params.candidates);
    summary.add(detection);
  };
  const bool whole = process_sequence(sequence, params, on_frame, read_given_poses(options.poses, sequence));
  if (summary.ok == 0) {
    if (!pair) say(fmt::format("none of {} frames can be used", summary.frames));
    return kExitData;
  }
  out.commit();
  if (pair) say("one pair: candidates are reported as obstacles at once, as with --stills");
  say(summary.text());
  if (!whole) say(fmt::format("interrupted after {} of {} frames, which are written", summary.frames, sequence.size()));
  return whole ? kExitOk : kExitInterrupted;
}

}  // namespace

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

Run add_detect(CLI::App& command) {
  const auto options = std::make_shared<DetectOptions>();
  add_input_options(command, options->input);
  command
      .add_option("--out", options->out,
                  "Write the detections, JSON Lines, to this file. Without it they go to standard output")
      ->type_name("FILE");
  command
      .add_option("--overlay", options->overlay,
                  "Write four pictures of each frame into this folder: ground, disparity, candidates, drops")
      ->type_name("FOLDER");
  command.add_flag("--stills", options->stills,
                   "The pictures are unrelated: report every candidate at once instead of following it over frames");
  command
      .add_option(
          "--poses", options->poses,
          "Poses of the left camera, one for each frame, in KITTI's or TUM's format: used instead of the motion measured in "
          "the pictures")
      ->type_name("FILE");
  add_method_options(command, options->method);
  add_threads_option(command, options->threads);
  command.footer(
      "Examples:\n"
      "  brink detect walk/ --out walk.jsonl --overlay pictures/\n"
      "  brink detect left.png --right right.png --calib calib.txt\n"
      "  brink detect side_by_side.mp4 --calib calib.txt --out walk.jsonl\n"
      "  brink detect potholes/ --stills --set candidates.min_depth_m=0.01\n"
      "Ctrl-C ends cleanly: what is done so far is written, and the exit code is 130.\n"
      "A frame that cannot be read is told on standard error and in the output, and the next one goes on. When no frame at all "
      "can\n"
      "be used, the exit code is 1 and no file is written.");
  return [options] { return detect(*options); };
}

}  // namespace brink::app
