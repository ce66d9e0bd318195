#include <benchmark/benchmark.h>

#include "brink/sim/render.hpp"
#include "sim/small_scenes.hpp"

// Time of the simulator's steps on a sunny street of 1280x720 px: one eye's picture, the truth, the sensor.
namespace {

using brink::sim::CameraMotion;

constexpr int kWidth = 1280;
constexpr int kHeight = 720;

CameraMotion walk() {
  return [](double time) {
    Eigen::Isometry3d pose = brink::sim::test::make_pose(1.65, 28.0, 2.0);
    pose.translation().x() += 1.2 * time;
    return pose;
  };
}

void render(benchmark::State& state, double shutter_s) {
  brink::sim::Renderer renderer(brink::sim::test::make_street(1.2F));
  const brink::StereoCamera camera = brink::sim::test::make_camera(kWidth, kHeight, 700.0);
  brink::sim::RenderParams params;
  params.samples = static_cast<int>(state.range(0));
  params.shutter_s = shutter_s;
  while (state.KeepRunning()) benchmark::DoNotOptimize(renderer.render(camera, {kWidth, kHeight}, walk(), 0.5, 0, params, 1));
}

void trace(benchmark::State& state) {
  brink::sim::Renderer renderer(brink::sim::test::make_street(1.2F));
  const brink::StereoCamera camera = brink::sim::test::make_camera(kWidth, kHeight, 700.0);
  while (state.KeepRunning()) benchmark::DoNotOptimize(renderer.trace(camera, {kWidth, kHeight}, walk()(0.0), 0.5));
}

void expose(benchmark::State& state) {
  const cv::Mat3f radiance(kHeight, kWidth, cv::Vec3f(0.2F, 0.2F, 0.2F));
  while (state.KeepRunning()) benchmark::DoNotOptimize(brink::sim::expose(radiance, 1.0, 1, {}, 1));
}

BENCHMARK_CAPTURE(render, sharp, 0.0)->Arg(1)->Arg(4)->Arg(9)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(render, blurred, 0.008)->Arg(4)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(trace)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(expose)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
