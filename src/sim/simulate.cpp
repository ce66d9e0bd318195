#include "brink/sim/simulate.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include "brink/frame.hpp"
#include "sim/random.hpp"

namespace brink::sim {
namespace {

void require(bool valid, const char* name, double value, const std::string& expected) {
  if (!valid) throw std::invalid_argument(fmt::format("{} = {}, must be {}", name, value, expected));
}

void require_within(const char* name, double value, double low, double high) {
  require(value >= low && value <= high, name, value, fmt::format("{} to {}", low, high));
}

StereoCamera make_camera(const SimulationParams& params) {
  return {params.focal_px, (params.width - 1) / 2.0, (params.height - 1) / 2.0, params.baseline_m};
}

std::vector<bool> choose_dropped(const SimulationParams& params) {
  Random random(static_cast<unsigned>(params.seed));
  std::vector<bool> dropped;
  for (int frame = 0; frame < params.frames; ++frame) {
    const bool inside = frame > 0 && frame + 1 < params.frames;  // a sequence begins and ends with pictures
    dropped.push_back(random.chance(params.dropped) && inside);
  }
  return dropped;
}

const SimulationParams& checked(const SimulationParams& params) {
  params.validate();
  return params;
}

World make_checked_world(const SimulationParams& params) {
  constexpr double kSpare = 1.0;  // s: corners are cut when they are rounded
  return make_world(params.family, params.seed, params.frames / params.fps + kSpare, params.light);
}

}  // namespace

void SimulationParams::validate() const {
  constexpr double kLongest = 3600.0;
  require_within("frames", frames, 1, 100000);
  require_within("width", width, kMinImageWidth, 4096);
  require_within("height", height, kMinImageHeight, 4096);
  require_within("focal_px", focal_px, 10.0, 1e5);
  require_within("baseline_m", baseline_m, 0.001, 10.0);
  require_within("fps", fps, 0.1, 1000.0);
  require(frames / fps <= kLongest, "frames / fps", frames / fps, fmt::format("at most {} s", kLongest));
  require_within("noise", noise, 0.0, 100.0);
  require_within("vertical_offset_px", vertical_offset_px, -20.0, 20.0);
  require_within("rotation_deg", rotation_deg, -5.0, 5.0);
  require_within("dropped", dropped, 0.0, 0.9);
  if (!light.empty() && light != "sunny" && light != "overcast" && light != "dusk") {
    throw std::invalid_argument(fmt::format("light = {}, must be sunny, overcast or dusk", light));
  }
}

/// What a Simulator is made of.
class Simulator::Walker {
 public:
  explicit Walker(const SimulationParams& given)
      : params(checked(given)),
        camera(make_camera(given)),
        world(make_checked_world(given)),
        renderer(world.scene),
        motion(world.walk, [this](double x, double y, double z) { return renderer.ground_height(x, y, z); }),
        dropped(choose_dropped(given)),
        metered_(static_cast<std::size_t>(given.frames)) {}

  [[nodiscard]] double time(int frame) const { return frame / params.fps; }

  [[nodiscard]] cv::Mat3b picture(int frame, int eye) {
    constexpr double kShutter = 0.008;  // s, of a small camera in the shade
    RenderParams render;
    render.shutter_s = params.blur ? kShutter : 0.0;
    SensorParams sensor;
    sensor.noise = params.noise;
    sensor.vertical_offset_px = params.vertical_offset_px;
    sensor.rotation_deg = params.rotation_deg;
    const cv::Size size(params.width, params.height);
    const cv::Mat3f radiance = renderer.render(camera, size, motion, time(frame), eye, render, seed_of(frame));
    return expose(radiance, gain(frame), eye, sensor, seed_of(frame));
  }

  const SimulationParams params;
  const StereoCamera camera;
  const World world;
  Renderer renderer;
  const HeadMotion motion;
  const std::vector<bool> dropped;

 private:
  [[nodiscard]] unsigned seed_of(int frame) const {
    constexpr unsigned kApart = 1000003;  // more than there are frames
    return static_cast<unsigned>(params.seed) * kApart + static_cast<unsigned>(frame);
  }

  // The automatic exposure lags behind the light as a camera's does: a mean over the last frames, weighted by age. It is
  // computed anew from small pictures, so that it is the same wherever a run starts.
  [[nodiscard]] double gain(int frame) {
    constexpr double kLag = 0.4;  // s
    const int oldest = std::max(0, frame - static_cast<int>(std::ceil(3.0 * kLag * params.fps)));
    double sum = 0.0;
    double weights = 0.0;
    for (int i = oldest; i <= frame; ++i) {
      const double weight = std::exp((time(i) - time(frame)) / kLag);
      sum += weight * std::log(meter(i));
      weights += weight;
    }
    return std::exp(sum / weights);
  }

  [[nodiscard]] double meter(int frame) {
    std::optional<double>& known = metered_[static_cast<std::size_t>(frame)];
    if (!known) {
      constexpr int kAcross = 96;  // px
      const double scale = static_cast<double>(kAcross) / params.width;
      const cv::Size size(kAcross, std::max(1, static_cast<int>(std::lround(scale * params.height))));
      const StereoCamera small{scale * camera.focal, (size.width - 1) / 2.0, (size.height - 1) / 2.0, camera.baseline};
      RenderParams render;
      render.samples = 1;
      known = compute_auto_gain(renderer.render(small, size, motion, time(frame), 0, render, seed_of(frame)));
    }
    return *known;
  }

  std::vector<std::optional<double>> metered_;
};

Simulator::Simulator(const SimulationParams& params) : walker_(std::make_unique<Walker>(params)) {}
Simulator::~Simulator() = default;

const SimulationParams& Simulator::params() const { return walker_->params; }
StereoCamera Simulator::camera() const { return walker_->camera; }
double Simulator::time(int frame) const { return walker_->time(frame); }
bool Simulator::is_dropped(int frame) const { return walker_->dropped.at(static_cast<std::size_t>(frame)); }

Eigen::Isometry3d Simulator::world_from_camera(int frame) const {
  return walker_->motion(0.0).inverse() * walker_->motion(time(frame));
}

std::vector<Instance> Simulator::instances() const {
  const Eigen::Isometry3d first_from_scene = walker_->motion(0.0).inverse();
  std::vector<Instance> instances = walker_->world.scene.instances;
  for (Instance& instance : instances) {
    for (Eigen::Vector3d& point : instance.opening) point = first_from_scene * point;
  }
  return instances;
}

std::vector<ImuSample> Simulator::imu() const {
  return make_imu(walker_->motion, time(params().frames - 1), {}, static_cast<unsigned>(params().seed));
}

StereoPictures Simulator::pictures(int frame) { return {walker_->picture(frame, 0), walker_->picture(frame, 1)}; }

Truth Simulator::truth(int frame) {
  return walker_->renderer.trace(walker_->camera, {params().width, params().height}, walker_->motion(time(frame)), time(frame));
}

}  // namespace brink::sim
