#include "brink/sim/simulate.hpp"

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "brink/sequence_writer.hpp"
#include "common.hpp"

namespace brink::app {
namespace {

struct SimulateOptions {
  sim::SimulationParams params;
  std::optional<double> focal;  // px; without it in proportion to the width
  int jpeg_quality = 0;
  std::string out;
  int threads = 0;
  bool list = false;
  bool force = false;
  bool resume = false;
};

int list_families() {
  std::string text;
  for (const sim::Family& family : sim::families()) text += fmt::format("{}: {}\n", family.name, family.meaning);
  print(text);
  return kExitOk;
}

// The whole command line that matters, so that a run is only resumed as it was begun, and a sequence tells how it was made.
std::string recipe(const sim::SimulationParams& params, int jpeg_quality) {
  return fmt::format(
      "brink: {}\nfamily: {}\nseed: {}\nframes: {}\nwidth: {}\nheight: {}\nfocal_px: {}\nbaseline_m: {}\nfps: {}\n"
      "light: {}\nnoise: {}\nblur: {}\njpeg_quality: {}\nvertical_offset_px: {}\nrotation_deg: {}\ndropped: {}\n",
      BRINK_VERSION, params.family, params.seed, params.frames, params.width, params.height, params.focal_px, params.baseline_m,
      params.fps, params.light.empty() ? "by the seed" : params.light, params.noise, params.blur, jpeg_quality,
      params.vertical_offset_px, params.rotation_deg, params.dropped);
}

Existing existing(const SimulateOptions& options) {
  if (options.resume) return Existing::resume;
  return options.force ? Existing::replace : Existing::refuse;
}

void write_frames(sim::Simulator& simulator, const SequenceWriter& writer, int jpeg_quality) {
  Progress progress(simulator.params().frames);
  for (int frame = 0; frame < simulator.params().frames; ++frame) {
    if (writer.has_frame(frame)) {
      progress.skip();
      continue;
    }
    if (!simulator.is_dropped(frame)) {
      const sim::StereoPictures pictures = simulator.pictures(frame);
      writer.write_pictures(frame, pictures.left, pictures.right, jpeg_quality);
    }
    const sim::Truth truth = simulator.truth(frame);
    writer.write_truth(frame, truth.disparity, truth.obstacle);
    progress.tell(frame + 1);
  }
}

void write_the_rest(const sim::Simulator& simulator, const SequenceWriter& writer) {
  std::vector<double> times;
  std::vector<Eigen::Isometry3d> poses;
  for (int frame = 0; frame < simulator.params().frames; ++frame) {
    times.push_back(simulator.time(frame));
    poses.push_back(simulator.world_from_camera(frame));
  }
  std::vector<InstanceTruth> instances;
  for (const sim::Instance& instance : simulator.instances()) {
    instances.push_back({instance.id, instance.type, instance.depth_m, instance.opening});
  }
  writer.write_calibration(simulator.camera());
  writer.write_times(times);
  writer.write_poses(poses);
  writer.write_imu(simulator.imu());
  writer.write_instances(instances);
}

int simulate(const SimulateOptions& options) {
  if (options.list) return list_families();
  if (options.params.family.empty()) throw std::invalid_argument("no FAMILY given; brink simulate --list names them");
  if (options.out.empty()) throw std::invalid_argument("no --out DIR given, which is to hold the sequence");
  constexpr double kFocalToWidth = 700.0 / 1280.0;
  sim::SimulationParams params = options.params;
  params.focal_px = options.focal.value_or(kFocalToWidth * params.width);

  const auto threads = limit_threads(options.threads);
  sim::Simulator simulator(params);  // first of all: says what is wrong with the parameters
  SequenceWriter writer(options.out, recipe(params, options.jpeg_quality), existing(options));
  if (writer.is_complete()) {
    say(options.out + ": is complete already");
    return kExitOk;
  }
  write_frames(simulator, writer, options.jpeg_quality);
  write_the_rest(simulator, writer);
  writer.commit();
  say(fmt::format("{}: {} frames of {}x{} px, seed {}, obstacles: {}", options.out, params.frames, params.width, params.height,
                  params.seed, simulator.instances().size()));
  return kExitOk;
}

}  // namespace

Run add_simulate(CLI::App& command) {
  const auto options = std::make_shared<SimulateOptions>();
  sim::SimulationParams& params = options->params;
  command.add_option("FAMILY", params.family, "What kind of place to walk through; --list names them");
  command.add_option("--out", options->out, "Folder for the sequence. It must not be there yet")->type_name("DIR");
  command.add_flag("--list", options->list, "Print the families with their meaning");
  const auto add = [&command](const char* name, auto& value, const char* type, const char* meaning) {
    command.add_option(name, value, meaning)->type_name(type)->capture_default_str();
  };
  add("--frames", params.frames, "N", "Number of frames");
  add("--seed", params.seed, "S", "Chooses layout, sizes, materials, light, path, speed, camera height and noise");
  add("--width", params.width, "PX", "Width of the pictures");
  add("--height", params.height, "PX", "Height of the pictures");
  command.add_option("--focal", options->focal, "Focal length in pixels. Without it 700 for a width of 1280, in proportion")
      ->type_name("PX");
  add("--baseline", params.baseline_m, "M", "Distance of the eyes in metres");
  add("--fps", params.fps, "HZ", "Frames per second");
  command.add_option("--light", params.light, "sunny, overcast or dusk. Without it by the seed")->type_name("NAME");
  add("--noise", params.noise, "X", "Factor on the noise of the sensor");
  command.add_flag("--blur", params.blur, "With motion blur");
  command.add_option("--jpeg", options->jpeg_quality, "Store pictures as JPEG of this quality, 1 to 100. Without it as PNG")
      ->type_name("Q")
      ->check(CLI::Range(1, 100).description(""));
  add("--vertical-offset", params.vertical_offset_px, "PX", "Shift the right picture down: a camera badly rectified");
  add("--rotation", params.rotation_deg, "DEG", "Turn the right picture about its centre: a camera badly rectified");
  add("--dropped", params.dropped, "SHARE", "Share of the frames without pictures, 0 to 0.9");
  add_threads_option(command, options->threads);
  CLI::Option* force = command.add_flag("--force", options->force, "Replace a simulated sequence that is there already");
  command.add_flag("--resume", options->resume, "Go on with an interrupted run; leave alone what is complete")->excludes(force);
  command.footer(
      "Examples:\n"
      "  brink simulate manholes --out walk --frames 60\n"
      "  brink simulate stairs --out walk --seed 7 --width 640 --height 360 --light dusk --blur\n"
      "The sequence has its truth with it: docs/formats.md. The same seed gives the same bytes, for any number of threads.\n"
      "It grows in DIR.part and gets its name when it is whole.");
  return [options] { return simulate(*options); };
}

}  // namespace brink::app
