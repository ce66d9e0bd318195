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
#include "brink/video.hpp"
#include "common.hpp"
#include "input.hpp"

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

std::string ego_motion_text(const Detection& detection) {
  std::string text = "ego-motion " + to_string(detection.ego_motion_state);
  if (!detection.ego_motion.reason.empty()) text += ": " + detection.ego_motion.reason;
  return text;
}

/// Where --overlay goes: a video of all frames, or a folder of pictures of those that are ok.
class Overlay {
 public:
  Overlay(const std::string& path, const Sequence& sequence) {
    if (path.empty()) return;
    if (!is_video_name(path)) {
      folder_.emplace(path);
      return;
    }
    std::vector<double> times;
    for (const FrameStamp& stamp : sequence.stamps()) times.push_back(stamp.time);
    video_.emplace(path, cv::Size(kVideoWidth, kVideoHeight), compute_video_fps(times));
  }

  void add(const Frame& frame, const Detection& detection, const CandidateParams& params) {
    const std::optional<EgoMotion>& motion = detection.ego_motion.motion;
    const bool is_known = motion && detection.ego_motion_state != EgoMotionState::ground;  // that tells no place
    trail_.add(is_known ? std::optional(motion->current_from_previous) : std::nullopt);
    if (video_) video_->write(draw_video_frame(frame, detection, trail_.path(), ego_motion_text(detection), params));
    if (folder_ && detection.status == FrameStatus::ok) write_pictures(frame, detection, params);
  }
  void commit() {
    if (video_) video_->commit();
  }

 private:
  void write_pictures(const Frame& frame, const Detection& detection, const CandidateParams& params) const {
    const auto write = [&](const char* name, const cv::Mat3b& picture) {
      write_file(folder_->file(fmt::format("{:06}_{}.png", frame.index, name)), encode_png(picture));
    };
    write("ground", draw_ground(frame, detection, params));
    write("disparity", draw_disparity(detection.disparity));
    write("candidates", draw_candidates(frame, detection));
    write("drops", draw_obstacles(frame, detection));
  }

  std::optional<OutputFolder> folder_;
  std::optional<VideoWriter> video_;
  PathTrail trail_;
};

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
  const bool pair = is_one_pair(options.input);
  params.stills = params.stills || options.stills || pair;
  const auto threads = limit_threads(options.threads);
  Overlay overlay(options.overlay, sequence);
  OutputFile out(options.out);

  Summary summary;
  Faults faults;
  const auto on_frame = [&](const FrameReading& reading, const Detection& detection) {
    faults.tell(reading);
    out.write(to_json_line(detection));
    overlay.add(reading.frame, detection, params.candidates);
    summary.add(detection);
  };
  const bool whole = process_sequence(sequence, params, on_frame, read_given_poses(options.poses, sequence));
  if (summary.ok == 0) {
    if (!pair) say(fmt::format("none of {} frames can be used", summary.frames));
    return kExitData;
  }
  overlay.commit();
  out.commit();
  if (pair) say("one pair: candidates are reported as obstacles at once, as with --stills");
  say(summary.text());
  if (!whole) say(fmt::format("interrupted after {} of {} frames, which are written", summary.frames, sequence.size()));
  return whole ? kExitOk : kExitInterrupted;
}

}  // namespace

Run add_detect(CLI::App& command) {
  const auto options = std::make_shared<DetectOptions>();
  add_input_options(command, options->input);
  command
      .add_option("--out", options->out,
                  "Write the detections, JSON Lines, to this file. Without it they go to standard output")
      ->type_name("FILE");
  command
      .add_option(
          "--overlay", options->overlay,
          "Named .mp4, .avi or .mkv: write an annotated video of all frames. Any other name: write four pictures of each "
          "frame into this folder: ground, disparity, candidates, drops")
      ->type_name("FILE|FOLDER");
  command.add_flag("--stills", options->stills,
                   "The pictures are unrelated: report what is likely at once instead of following it over frames");
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
      "  brink detect walk/ --out walk.jsonl --overlay walk.mp4\n"
      "  brink detect left.png --right right.png --calib calib.txt\n"
      "  brink detect left.png --right depth.png --as depth --calib calib.txt\n"
      "  brink detect 'left/*.png' --right 'right/*.png' --calib calib.txt --fps 15 --out walk.jsonl\n"
      "  brink detect side_by_side.mp4 --calib calib.txt --out walk.jsonl\n"
      "  brink detect potholes/ --stills --set candidates.min_depth_m=0.01\n"
      "Ctrl-C ends cleanly: what is done so far is written, and the exit code is 130.\n"
      "A frame that cannot be read is told on standard error and in the output, and the next one goes on. When no frame at all "
      "can\n"
      "be used, the exit code is 1 and no file is written.");
  return [options] { return detect(*options); };
}

}  // namespace brink::app
