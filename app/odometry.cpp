#include <map>
#include <memory>
#include <string>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "brink/ego_motion.hpp"
#include "brink/files.hpp"
#include "common.hpp"

namespace brink::app {
namespace {

enum class PoseFormat { kitti, tum };

struct OdometryOptions {
  std::string input;
  std::string out = "-";
  PoseFormat format = PoseFormat::kitti;
  MethodOptions method;
  int threads = 0;
};

/// One line of a file of poses. kitti: the 3x4 matrix, row by row; tum: time, position, quaternion with its real part last.
std::string to_line(const Eigen::Isometry3d& world_from_camera, double time, PoseFormat format) {
  if (format == PoseFormat::tum) {
    const Eigen::Vector3d t = world_from_camera.translation();
    const Eigen::Quaterniond q(world_from_camera.linear());
    return fmt::format("{:.6f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", time, t.x(), t.y(), t.z(), q.x(), q.y(),
                       q.z(), q.w());
  }
  std::string line;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      line += fmt::format("{}{:.9f}", line.empty() ? "" : " ", world_from_camera(row, column));
    }
  }
  return line + "\n";
}

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
  const Sequence sequence = open_sequence(options.input);
  const auto threads = limit_threads(options.threads);
  OutputFile out(options.out);
  EgoMotionEstimator estimator(params.ego_motion);
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
  Gaps gaps;
  bool has_motion = false;
  bool has_frame = false;
  Progress progress(sequence.size());
  for (int position = 0; position < sequence.size(); ++position) {
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
    out.write(to_line(world_from_camera, reading.frame.time, options.format));
    progress.tell(position + 1);
  }
  if (!has_motion) {
    say(fmt::format("no motion in any of {} frames", sequence.size()));
    return kExitData;
  }
  out.commit();
  say(fmt::format("{} frames, {:.2f} m from start to end{}", sequence.size(), world_from_camera.translation().norm(),
                  to_text(gaps)));
  return kExitOk;
}

}  // namespace

Run add_odometry(CLI::App& command) {
  const auto options = std::make_shared<OdometryOptions>();
  const std::map<std::string, PoseFormat> formats = {{"kitti", PoseFormat::kitti}, {"tum", PoseFormat::tum}};
  command.add_option("INPUT", options->input, "Folder of a sequence")->required();
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
