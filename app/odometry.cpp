#include <map>
#include <memory>
#include <stdexcept>
#include <string>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "brink/ego_motion.hpp"
#include "brink/files.hpp"
#include "brink/trajectory.hpp"
#include "common.hpp"
#include "input.hpp"

namespace brink::app {
namespace {

enum class PoseFormat { kitti, tum };

struct OdometryOptions {
  InputOptions input;
  std::string out = "-";
  PoseFormat format = PoseFormat::kitti;
  MethodOptions method;
  int threads = 0;
};

/// Frames for which no motion is known, by the reason.
struct Gaps {
  int unread = 0;  ///< the next motion bridges them: it is measured from the last frame that could be read
  int failed = 0;  ///< what happened there is missing in all later poses
};

std::string to_text(const Gaps& gaps) {
  std::string text;
  if (gaps.unread > 0) text += fmt::format("; {} frames could not be read: their poses are those before", gaps.unread);
  if (gaps.failed > 0) {
    text +=
        fmt::format("; {} steps without motion: the path stands still there, and what was missed is missing in all later poses",
                    gaps.failed);
  }
  return text;
}

/// The path frame by frame.
class PathBuilder {
 public:
  explicit PathBuilder(const EgoMotionParams& params) : estimator_(params) {}

  void add(const FrameReading& reading) {
    if (reading.status == FrameStatus::ok) {
      add_motion(reading.frame);
    } else {
      ++gaps_.unread;
      say(reading.reason);
    }
    path_.times.push_back(reading.frame.time);
    path_.world_from_camera.push_back(world_from_camera_);
  }
  [[nodiscard]] const Trajectory& path() const { return path_; }
  [[nodiscard]] const Gaps& gaps() const { return gaps_; }
  [[nodiscard]] bool has_motion() const { return has_motion_; }

 private:
  void add_motion(const Frame& frame) {
    if (frame.left.empty()) throw std::runtime_error("there are no left pictures: the path of the camera is measured in them");
    const EgoMotionEstimate estimated = estimator_.estimate(frame);
    if (estimated.motion) {
      world_from_camera_ = world_from_camera_ * estimated.motion->current_from_previous.inverse();
      has_motion_ = true;
    } else if (has_frame_) {
      ++gaps_.failed;
      say(fmt::format("frame {}: no motion: {}", frame.index, estimated.reason));
    }
    has_frame_ = true;
  }

  EgoMotionEstimator estimator_;
  Eigen::Isometry3d world_from_camera_ = Eigen::Isometry3d::Identity();
  Trajectory path_;
  Gaps gaps_;
  bool has_motion_ = false;
  bool has_frame_ = false;
};

int compute_path(const OdometryOptions& options) {
  const DetectorParams params = make_params(options.method);
  const Sequence sequence = open_input(options.input);
  const auto threads = limit_threads(options.threads);
  OutputFile out(options.out);
  PathBuilder builder(params.ego_motion);
  catch_interruption();
  Progress progress(sequence.size());
  for (int position = 0; position < sequence.size() && !is_interrupted(); ++position) {
    builder.add(sequence.read(position));
    progress.tell(position + 1);
  }
  const Trajectory& path = builder.path();
  if (!builder.has_motion()) {
    say(fmt::format("no motion in any of {} frames", path.times.size()));
    return kExitData;
  }
  out.write(options.format == PoseFormat::tum ? to_tum(path) : to_kitti(path));
  out.commit();
  say(fmt::format("{} frames, {:.2f} m from start to end{}", path.times.size(),
                  path.world_from_camera.back().translation().norm(), to_text(builder.gaps())));
  if (!is_interrupted()) return kExitOk;
  say(fmt::format("interrupted after {} of {} frames, which are written", path.times.size(), sequence.size()));
  return kExitInterrupted;
}

}  // namespace

Run add_odometry(CLI::App& command) {
  const auto options = std::make_shared<OdometryOptions>();
  const std::map<std::string, PoseFormat> formats = {{"kitti", PoseFormat::kitti}, {"tum", PoseFormat::tum}};
  add_input_options(command, options->input);
  command
      .add_option("--out", options->out,
                  "Write the poses of the left camera, one line a frame, to this file. Without it they go to standard output")
      ->type_name("FILE");
  command
      .add_option("--format", options->format,
                  "kitti: 12 numbers, the 3x4 matrix row by row; tum: time, position, quaternion. Without it kitti")
      ->type_name("FORMAT")
      ->transform(CLI::CheckedTransformer(formats).description(""));
  add_method_options(command, options->method);
  add_threads_option(command, options->threads);
  command.footer(
      "Examples:\n"
      "  brink odometry walk/ --out poses.txt\n"
      "  brink odometry walk/ --out poses.tum --format tum\n"
      "The first camera is the world: its pose is the identity. A step whose motion cannot be told is told on standard error, "
      "and\n"
      "the path goes on from where it was, as if the camera had stood still.");
  return [options] { return compute_path(*options); };
}

}  // namespace brink::app
