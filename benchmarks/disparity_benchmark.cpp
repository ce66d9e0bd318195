#include <cstdint>
#include <cstdlib>
#include <string>

#include <benchmark/benchmark.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "brink/disparity.hpp"

// Time of each matcher on one pair, 0 to 255 px: BRINK_TEST_DATA/aloe where it is set, a synthetic wall of 1280x720 otherwise.
namespace {

struct Pair {
  cv::Mat1b left;
  cv::Mat1b right;
};

Pair make_wall() {
  constexpr int kDisparity = 60;
  cv::Mat1b texture(720, 1280 + kDisparity);
  cv::RNG(1).fill(texture, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(texture, texture, {3, 3}, 0.8);
  return {texture.colRange(0, 1280).clone(), texture.colRange(kDisparity, 1280 + kDisparity).clone()};
}

Pair read_pair() {
  const char* root = std::getenv("BRINK_TEST_DATA");
  if (root == nullptr) return make_wall();
  const cv::Mat left = cv::imread(std::string(root) + "/aloe/image_2/000000.png", cv::IMREAD_COLOR);
  const cv::Mat right = cv::imread(std::string(root) + "/aloe/image_3/000000.png", cv::IMREAD_COLOR);
  if (left.empty() || right.empty()) return make_wall();
  Pair pair;
  cv::cvtColor(left, pair.left, cv::COLOR_BGR2GRAY);
  cv::cvtColor(right, pair.right, cv::COLOR_BGR2GRAY);
  return pair;
}

void match(benchmark::State& state, const brink::DisparityParams& params) {
  const Pair pair = read_pair();
  const auto matcher = brink::make_stereo_matcher(params);
  for (auto _ : state) benchmark::DoNotOptimize(matcher->compute(pair.left, pair.right));
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

// NOLINTBEGIN(cert-err58-cpp): that is how Google Benchmark registers.
BENCHMARK_CAPTURE(match_elas, robotics, brink::ElasParams::robotics())->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(match_elas, paper, brink::ElasParams::paper())->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(match_elas, middlebury, brink::ElasParams::middlebury())->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(match_with, bm, brink::Matcher::bm)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(match_with, sgbm, brink::Matcher::sgbm)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(match_with, sgbm_wls, brink::Matcher::sgbm_wls)->Unit(benchmark::kMillisecond)->UseRealTime();
// NOLINTEND(cert-err58-cpp)

}  // namespace
