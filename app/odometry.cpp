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

/// What one frame told, a picture that cannot be read included.
EgoMotionEstimate estimate(EgoMotionEstimator& estimator, const FrameReading& reading) {
  if (reading.status == FrameStatus::ok) return estimator.estimate(reading.frame);
  return {std::nullopt, reading.reason, std::nullopt, 0, 0};
}

int compute_path(const OdometryOptions& options) {
  const DetectorParams params = make_params(options.method);
  const Sequence sequence = open_input(options.input);
  const auto threads = limit_threads(options.threads);
  OutputFile out(options.out);
  EgoMotionEstimator estimator(params.ego_motion);
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
  Trajectory path;
  int failed = 0;
  catch_interruption();
  Progress progress(sequence.size());
  for (int position = 0; position < sequence.size() && !is_interrupted(); ++position) {
    const FrameReading reading = sequence.read(position);
    const EgoMotionEstimate estimated = estimate(estimator, reading);
    if (estimated.motion) {
      world_from_camera = world_from_camera * estimated.motion->current_from_previous.inverse();
    } else if (position > 0) {
      ++failed;
      say(fmt::format("frame {}: no motion: {}", reading.frame.index, estimated.reason));
    }
    path.times.push_back(reading.frame.time);
    path.world_from_camera.push_back(world_from_camera);
    progress.tell(position + 1);
  }
  if (path.times.size() > 1 && failed == static_cast<int>(path.times.size()) - 1) {
    say(fmt::format("no motion between any of {} frames", sequence.size()));
    return kExitData;
  }
  if (is_interrupted())
    say(fmt::format("interrupted after {} of {} frames, which are written", path.times.size(), sequence.size()));
  out.write(options.format == PoseFormat::tum ? to_tum(path) : to_kitti(path));
  out.commit();
  say(fmt::format("{} frames, {:.2f} m from start to end; {} steps without motion{}", sequence.size(),
                  world_from_camera.translation().norm(), failed,
                  failed > 0 ? ": the poses stand still there, and all later ones are off by what was missed" : ""));
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
