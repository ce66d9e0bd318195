#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "brink/disparity.hpp"
#include "disparity/consistency.hpp"
#include "disparity/delaunay.hpp"
#include "disparity/dense_matching.hpp"
#include "disparity/descriptors.hpp"
#include "disparity/expected_disparities_simd.hpp"
#include "disparity/postprocess.hpp"
#include "disparity/support_points.hpp"
#include "pair.hpp"
#include "yardstick.hpp"

// Time of each matcher on one pair, 0 to 255 px, and of each step of ELAS, 0 to 127 px, beside the yardstick of BENCHMARKS.md.
// BRINK_BENCHMARK_PAIR names the folder of a sequence; a synthetic wall of 1280x720 otherwise.
namespace {

using brink::benchmarks::Pair;
using brink::benchmarks::read_pair;

void match(benchmark::State& state, const brink::DisparityParams& params) {
  const Pair pair = read_pair();
  const auto matcher = brink::make_stereo_matcher(params);
  while (state.KeepRunning()) benchmark::DoNotOptimize(matcher->compute(pair.left, pair.right));
  state.SetLabel(std::to_string(pair.left.cols) + "x" + std::to_string(pair.left.rows));
}

void match_with(benchmark::State& state, brink::Matcher matcher) {
  brink::DisparityParams params;
  params.matcher = matcher;
  match(state, params);
}

void match_elas(benchmark::State& state, const brink::ElasParams& elas) {
  brink::DisparityParams params;
  params.elas = elas;
  match(state, params);
}

BENCHMARK_CAPTURE(match_elas, robotics, brink::ElasParams::robotics())->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(match_elas, paper, brink::ElasParams::paper())->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(match_elas, middlebury, brink::ElasParams::middlebury())->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(match_with, bm, brink::Matcher::bm)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(match_with, sgbm, brink::Matcher::sgbm)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(match_with, sgbm_wls, brink::Matcher::sgbm_wls)->Unit(benchmark::kMillisecond)->UseRealTime();

constexpr int kMostDisparity = 127;

void yardstick(benchmark::State& state) {
  const Pair pair = read_pair();
  while (state.KeepRunning()) brink::run_yardstick(pair.left, pair.right);
}
BENCHMARK(yardstick)->Unit(benchmark::kMillisecond)->UseRealTime();

/// What each step of ELAS gets from the one before.
struct Steps {
  explicit Steps(const Pair& pair)
      : left(pair.left),
        right(pair.right),
        points(brink::find_support_points(left, right, params(), support_memory)),
        dense(brink::match_dense(brink::View::left, left, right, points, params())),
        dense_right(brink::match_dense(brink::View::right, right, left, brink::move_to_right_view(points), params())),
        checked(brink::check_consistency(dense, dense_right, 2.0F)) {}

  static brink::ElasParams params() {
    brink::ElasParams params;
    params.max_disparity = kMostDisparity;
    return params;
  }

  brink::DescriptorImage left;
  brink::DescriptorImage right;
  brink::SupportMemory support_memory;
  std::vector<brink::SupportPoint> points;
  cv::Mat1f dense;
  cv::Mat1f dense_right;
  cv::Mat1f checked;
};

template <typename Step>
void time_step(benchmark::State& state, const Step& step) {
  const Pair pair = read_pair();
  const Steps steps(pair);
  while (state.KeepRunning()) benchmark::DoNotOptimize(step(pair, steps));
}

void register_step(const char* name, const auto& step) {
  benchmark::RegisterBenchmark(name, [step](benchmark::State& state) { time_step(state, step); })
      ->Unit(benchmark::kMillisecond)
      ->UseRealTime();
}

[[maybe_unused]] const bool kRegistered = [] {
  register_step("elas", [](const Pair& pair, const Steps&) {
    brink::DisparityParams params;
    params.elas = Steps::params();
    return brink::compute_disparity(pair.left, pair.right, params);
  });
  register_step("elas/gradients", [](const Pair& pair, const Steps&) { return brink::DescriptorImage(pair.left).width(); });
  register_step("elas/descriptors", [](const Pair&, const Steps& steps) {
    brink::DescriptorRow row;
    for (int v = 0; v < steps.left.height(); ++v) benchmark::DoNotOptimize(row.gather(steps.left, v));
    return steps.left.height();
  });
  register_step("elas/support_candidates", [](const Pair&, const Steps& steps) {
    brink::SupportMemory memory;
    return brink::match_support_candidates(steps.left, steps.right, Steps::params(), memory);
  });
  register_step("elas/support_points", [](const Pair&, const Steps& steps) {
    brink::SupportMemory memory;
    return brink::find_support_points(steps.left, steps.right, Steps::params(), memory).size();
  });
  register_step("elas/triangulate", [](const Pair&, const Steps& steps) { return brink::triangulate(steps.points).size(); });
  register_step("elas/textured",
                [](const Pair&, const Steps& steps) { return brink::find_textured(steps.left, Steps::params()); });
  register_step("elas/expected", [](const Pair& pair, const Steps& steps) {
    const std::vector<brink::Triangle> triangles = brink::triangulate(steps.points);
    const std::vector<brink::PriorPlane> planes = brink::fit_planes(brink::View::left, steps.points, triangles);
    return brink::expect_disparities(steps.points, triangles, planes, pair.left.size());
  });
  register_step("elas/dense_left", [](const Pair&, const Steps& steps) {
    return brink::match_dense(brink::View::left, steps.left, steps.right, steps.points, Steps::params());
  });
  register_step("elas/dense_both", [](const Pair&, const Steps& steps) {
    brink::DenseMemory memory;
    return brink::match_both_views(steps.left, steps.right, steps.points, Steps::params(), memory);
  });
  register_step("elas/consistency",
                [](const Pair&, const Steps& steps) { return brink::check_consistency(steps.dense, steps.dense_right, 2.0F); });
  register_step("elas/speckles", [](const Pair&, const Steps& steps) {
    cv::Mat1f disparity = steps.checked.clone();
    brink::remove_speckles(disparity, 1.0F, 200);
    return disparity;
  });
  register_step("elas/gaps", [](const Pair&, const Steps& steps) {
    cv::Mat1f disparity = steps.checked.clone();
    brink::fill_gaps(disparity, 5, false);
    return disparity;
  });
  register_step("elas/mean", [](const Pair&, const Steps& steps) { return brink::filter_adaptive_mean(steps.checked); });
  return true;
}();

}  // namespace
