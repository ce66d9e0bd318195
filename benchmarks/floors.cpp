// Counting before cutting: what each step of ELAS must do on one pair, how long that takes this machine at the least, and how
// long it takes. Prints a table in Markdown. The pair is that of disparity_benchmark; one thread, medians of several rounds.
//
// The floor is the longer of two: all matching costs (sums of 16 absolute differences) at the rate at which those of rows in
// the cache can be added up, and all bytes that are read or written once at the rate at which memory is copied. Nothing else
// that a step does is in it.
#include <algorithm>
#include <bit>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <tbb/global_control.h>

#include "add_differences_simd.hpp"
#include "disparity/dense_matching.hpp"
#include "disparity/descriptors.hpp"
#include "disparity/expected_disparities_simd.hpp"
#include "disparity/postprocess.hpp"
#include "disparity/support_points.hpp"
#include "pair.hpp"

namespace brink::benchmarks {
namespace {

constexpr int kRounds = 7;
constexpr double kGradientBytes = 2.0;  // of a pixel; descriptors are gathered from them row by row

/// Median time of a call, ms.
double median_ms(const std::function<void()>& call) {
  std::vector<double> times;
  for (int i = 0; i < kRounds; ++i) {
    const auto start = std::chrono::steady_clock::now();
    call();
    times.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  }
  std::ranges::nth_element(times, times.begin() + kRounds / 2);
  return times[kRounds / 2];
}

/// Matching costs, millions a second, of two rows that lie in the cache.
double measure_cost_rate() {
  constexpr std::size_t kWidth = 1024;
  constexpr int kTimes = 20000;
  const std::vector<Descriptor> a(kWidth, Descriptor{1, 2, 3});
  const std::vector<Descriptor> b(kWidth, Descriptor{5, 4, 3});
  volatile std::uint64_t sum = 0;
  const double ms = median_ms([&] {
    for (int i = 0; i < kTimes; ++i) sum = add_differences(a.data(), b.data(), kWidth);
  });
  return static_cast<double>(kWidth) * kTimes / ms / 1000.0;
}

/// Bytes read and written, millions a second.
double measure_copy_rate() {
  constexpr std::size_t kBytes = std::size_t{1} << 26U;
  const std::vector<char> from(kBytes, 1);
  std::vector<char> to(kBytes, 2);
  return 2.0 * kBytes / median_ms([&] { std::memcpy(to.data(), from.data(), kBytes); }) / 1000.0;
}

/// Every grid point is compared with every disparity in the picture at four corners; so is what was found, back again.
double count_support_costs(const SupportGrid& grid, int width, const ElasParams& params) {
  double costs = 0.0;
  for (int j = 0; j < grid.rows; ++j) {
    for (int i = 0; i < grid.cols; ++i) {
      const int u = i * params.candidate_step_px;
      costs += 4.0 * (std::min(u, params.max_disparity) + 1);
      if (grid(j, i) != kNoSupport) costs += 4.0 * (std::min(width - 1 - (u - grid(j, i)), params.max_disparity) + 1);
    }
  }
  return costs;
}

/// The candidates of each pixel of a view: those of its cell and those near its plane.
double count_dense_costs(View view, const DescriptorImage& image, const std::vector<SupportPoint>& points,
                         const ElasParams& params) {
  const cv::Size size(image.width(), image.height());
  const auto [expectations, textured, grid] = make_dense_prior(view, image, points, params);
  const int radius = static_cast<int>(make_penalty(params).near_plane.size()) - 1;
  double costs = 0.0;
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      if (textured(v, u) == 0) continue;
      const std::uint64_t* const cell = grid.words_at(u, v);
      int candidates = 0;
      for (std::size_t k = 0; k < grid.words; ++k) candidates += std::popcount(cell[k]);
      if (expectations(v, u) != ExpectedDisparity::kNoPlane) {
        const int expected = ExpectedDisparity::disparity(expectations(v, u));
        for (int d = std::max(0, expected - radius); d <= std::min(params.max_disparity, expected + radius); ++d) {
          const auto word = static_cast<std::size_t>(d / 64);
          candidates += ((cell[word] >> static_cast<unsigned>(d % 64)) & 1U) == 0 ? 1 : 0;
        }
      }
      costs += candidates;
    }
  }
  return costs;
}

struct Step {
  std::string name;
  double costs = 0.0;
  double bytes = 0.0;
  double ms = 0.0;
};

std::vector<Step> measure_steps(const Pair& pair, const ElasParams& params) {
  const auto pixels = static_cast<double>(pair.left.total());
  const double map_bytes = sizeof(float) * pixels;
  const double gradient_bytes = kGradientBytes * pixels;
  DescriptorImage left;
  DescriptorImage right;
  SupportGrid candidates;
  SupportMemory support_memory;
  std::vector<SupportPoint> points;
  cv::Mat1f map;
  std::vector<Step> steps;
  const auto add = [&steps](const char* name, double costs, double bytes, double ms) {
    steps.push_back({name, costs, bytes, ms});
  };

  const double describing = median_ms([&] {
    left.assign(pair.left);
    right.assign(pair.right);
  });
  add("gradients", 0.0, 2.0 * (pixels + gradient_bytes), describing);
  const double supporting = median_ms([&] { candidates = match_support_candidates(left, right, params, support_memory); });
  add("support candidates", count_support_costs(candidates, left.width(), params), 2.0 * gradient_bytes, supporting);
  points = find_support_points(left, right, params, support_memory);
  const std::vector<SupportPoint> right_points = move_to_right_view(points);
  DenseMemory memory;
  const double matching = median_ms([&] { map = match_both_views(left, right, points, params, memory); });
  add("dense matching",
      count_dense_costs(View::left, left, points, params) + count_dense_costs(View::right, right, right_points, params),
      2.0 * gradient_bytes + map_bytes, matching);
  const auto similarity = static_cast<float>(params.speckle_similarity_px);
  // In place: the copies that they change are made before.
  const auto time_change = [&](const auto& change) {
    std::vector<cv::Mat1f> copies;
    copies.reserve(kRounds);
    for (int i = 0; i < kRounds; ++i) copies.push_back(map.clone());
    auto copy = copies.begin();
    const double ms = median_ms([&] { change(*copy++); });
    map = copies.front();
    return ms;
  };
  add("segments", 0.0, 2.0 * map_bytes,
      time_change([&](cv::Mat1f& copy) { remove_speckles(copy, similarity, params.speckle_size_px); }));
  add("gaps", 0.0, 2.0 * map_bytes,
      time_change([&](cv::Mat1f& copy) { fill_gaps(copy, params.gap_width_px, params.fill_across_steps); }));
  const cv::Mat1f filled = map;
  add("mean", 0.0, 2.0 * map_bytes, median_ms([&] { map = filter_adaptive_mean(filled); }));
  return steps;
}

void print_table(const Pair& pair, int max_disparity, double cost_rate, double copy_rate) {
  ElasParams params;
  params.max_disparity = max_disparity;
  const auto pixels = static_cast<double>(pair.left.total());
  fmt::print(
      "\n{}x{}, 0 to {} px\n\n| step | costs a pixel | MB | floor, ms | measured, ms | ratio |\n|---|---|---|---|---|---|\n",
      pair.left.cols, pair.left.rows, max_disparity);
  Step all{.name = "all"};
  double all_floor = 0.0;
  for (const Step& step : measure_steps(pair, params)) {
    const double floor_ms = std::max(step.costs / cost_rate, step.bytes / copy_rate) / 1000.0;
    fmt::print("| {} | {:.1f} | {:.1f} | {:.2f} | {:.2f} | {:.1f} |\n", step.name, step.costs / pixels, step.bytes / 1e6,
               floor_ms, step.ms, step.ms / floor_ms);
    all.costs += step.costs;
    all.bytes += step.bytes;
    all.ms += step.ms;
    all_floor += floor_ms;
  }
  fmt::print("| all | {:.1f} | {:.1f} | {:.2f} | {:.2f} | {:.1f} |\n", all.costs / pixels, all.bytes / 1e6, all_floor, all.ms,
             all.ms / all_floor);
}

}  // namespace
}  // namespace brink::benchmarks

int main() {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  cv::setNumThreads(1);
  const brink::benchmarks::Pair pair = brink::benchmarks::read_pair();
  const double cost_rate = brink::benchmarks::measure_cost_rate();
  const double copy_rate = brink::benchmarks::measure_copy_rate();
  fmt::print("{:.0f} million matching costs a second, {:.1f} GB of memory a second\n", cost_rate, copy_rate / 1000.0);
  for (const int max_disparity : {127, 255}) brink::benchmarks::print_table(pair, max_disparity, cost_rate, copy_rate);
  return 0;
}
