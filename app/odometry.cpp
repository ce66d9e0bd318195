#include <map>
#include <memory>
#include <string>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "brink/ego_motion.hpp"
#include "brink/files.hpp"
#include "brink/trajectory.hpp"
#include "common.hpp"

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

int compute_path(const OdometryOptions& options) {
  const DetectorParams params = make_params(options.method);
  const Sequence sequence = open_input(options.input);
  const auto threads = limit_threads(options.threads);
  OutputFile out(options.out);
  EgoMotionEstimator estimator(params.ego_motion);
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
  Trajectory path;
  Gaps gaps;
  bool has_motion = false;
  bool has_frame = false;
  catch_interruption();
  Progress progress(sequence.size());
  for (int position = 0; position < sequence.size() && !is_interrupted(); ++position) {
    const FrameReading reading = sequence.read(position);
    if (reading.status == FrameStatus::ok) {
      const EgoMotionEstimate estimated = estimator.estimate(reading.frame);
      if (estimated.motion) {
        world_from_camera = world_from_camera * estimated.motion->current_from_previous.inverse();
        has_motion = true;
      } else if (has_frame) {
        ++gaps.failed;
        say(fmt::format("frame {}: no motion: {}", reading.frame.index, estimated.reason));
      }
      has_frame = true;
    } else {
      ++gaps.unread;
      say(reading.reason);
    }
    path.times.push_back(reading.frame.time);
    path.world_from_camera.push_back(world_from_camera);
    progress.tell(position + 1);
  }
  if (!has_motion) {
    say(fmt::format("no motion in any of {} frames", sequence.size()));
    return kExitData;
  }
  if (is_interrupted())
    say(fmt::format("interrupted after {} of {} frames, which are written", path.times.size(), sequence.size()));
  out.write(options.format == PoseFormat::tum ? to_tum(path) : to_kitti(path));
  out.commit();
  say(fmt::format("{} frames, {:.2f} m from start to end{}", path.times.size(), world_from_camera.translation().norm(),
                  to_text(gaps)));
  return is_interrupted() ? kExitInterrupted : kExitOk;
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
