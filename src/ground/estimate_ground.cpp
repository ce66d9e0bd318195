#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <mutex>
#include <numbers>
#include <random>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "brink/ground.hpp"
#include "ground/normal_equations_simd.hpp"
#include "ground/range.hpp"
#include "ground/v_disparity.hpp"

namespace brink {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;
constexpr double kRollStepDeg = 2.5;      // the refinement takes the rest
constexpr int kTargetSamples = 60000;     // enough for 0.01 px in the plane; keeps the stage below the paper's 8.4 ms
constexpr std::size_t kRefined = 4;       // hypotheses that are refined to a plane
constexpr std::size_t kCoarseShare = 4;   // every fourth sample finds the best hypothesis, all of them refine it
constexpr int kCoarseRefinements = 8;     // steps of the iteratively reweighted least squares on that part ...
constexpr int kFineRefinements = 4;       // ... and on all
constexpr double kFullCoverage = 0.4;     // share of the ground's part of the picture that gives full confidence
constexpr std::size_t kMinSamples = 100;  // fewer valid pixels than this say nothing about a ground

struct Hypothesis {
  GroundPlane plane;
  double score = 0.0;
};

/// What a plane must satisfy to be the ground under a person or a robot (algorithms.md C.2).
class Plausibility {
 public:
  Plausibility(const StereoCamera& camera, const GroundParams& params, const std::optional<Eigen::Vector3d>& gravity)
      : camera_(camera), params_(params), min_cos_(std::cos(params.gravity_tolerance_deg / kDegPerRad)) {
    if (gravity) gravity_ = gravity->normalized();
  }

  [[nodiscard]] bool operator()(const GroundPlane& plane) const {
    if (!(plane.b > 0.0)) return false;
    const GroundPose pose = compute_ground_pose(plane, camera_);
    return pose.height_m >= params_.min_height_m && pose.height_m <= params_.max_height_m &&
           pose.pitch_deg >= params_.min_pitch_deg && pose.pitch_deg <= params_.max_pitch_deg &&
           std::abs(pose.roll_deg) <= params_.max_roll_deg && (!gravity_ || pose.down.dot(*gravity_) >= min_cos_);
  }

 private:
  StereoCamera camera_;
  GroundParams params_;
  std::optional<Eigen::Vector3d> gravity_;
  double min_cos_;
};

double tolerance_at(double d, const GroundParams& params) { return std::max(params.tolerance_px, params.tolerance_ratio * d); }

/// The scores of the best lines of all roll angles so far: what cannot be among the best of these in the end need not be
/// counted out. Whatever the order in which they come, the same lines remain.
class Leaders {
 public:
  explicit Leaders(std::size_t rolls) : scores_(rolls, 0.0) {}

  /// A line that scores less is not among the best kRefined.
  [[nodiscard]] double least() const { return least_; }
  void note(std::size_t roll, double score) {
    const std::lock_guard lock(mutex_);
    scores_[roll] = score;
    if (scores_.size() < kRefined) return;
    std::array<double, kRefined> leading{};
    std::ranges::partial_sort_copy(scores_, leading, std::greater<>());
    least_ = leading.back();
  }

 private:
  std::mutex mutex_;
  std::vector<double> scores_;
  std::atomic<double> least_ = 0.0;
};

/// Lines through two random samples of one sheared v-disparity histogram; the best one as a plane, if it may be a leader.
std::optional<Hypothesis> search_line(const BinnedSamples& binned, double roll_deg, const cv::Size& size, double cx,
                                      const Plausibility& plausible, const GroundParams& params, std::size_t roll,
                                      Leaders& leaders) {
  const double tan_roll = std::tan(roll_deg / kDegPerRad);
  const std::vector<DisparitySample>& samples = binned.samples();
  VDisparity histogram(binned, tan_roll, size.height);
  std::mt19937 random(static_cast<std::mt19937::result_type>(params.seed));
  // Not std::uniform_int_distribution: its sequence differs between standard libraries.
  const auto draw = [&] { return samples[random() % samples.size()]; };
  std::optional<Hypothesis> best;
  for (int i = 0; i < params.ransac_iterations; ++i) {
    const DisparitySample first = draw();
    const DisparitySample second = draw();
    const double v1 = first.v + tan_roll * first.u;
    const double v2 = second.v + tan_roll * second.u;
    if (std::abs(v1 - v2) < 0.05 * size.height) continue;
    const double slope = (first.d - second.d) / (v1 - v2);
    const double offset = first.d - slope * v1;
    const GroundPlane plane{slope * tan_roll, slope, offset - slope * tan_roll * cx};
    if (!plausible(plane)) continue;
    const double least = std::max(leaders.least(), best ? best->score : 0.0);
    const auto score = histogram.support(slope, offset, params.tolerance_ratio, params.tolerance_px, least);
    if (!score || (best && *score <= best->score)) continue;
    best = Hypothesis{plane, *score};
    leaders.note(roll, *score);
  }
  return best;
}

/// The best lines of the roll angles, best first; those that are not among the first kRefined may be missing.
std::vector<Hypothesis> search_lines(const BinnedSamples& samples, const cv::Size& size, double cx,
                                     const Plausibility& plausible, const GroundParams& params) {
  const auto steps = static_cast<std::size_t>(std::ceil(params.max_roll_deg / kRollStepDeg));
  std::vector<std::optional<Hypothesis>> lines(2 * steps + 1);
  Leaders leaders(lines.size());
  // From the upright camera outwards: most likely the best come first.
  tbb::parallel_for(std::size_t{0}, lines.size(), [&](std::size_t i) {
    const std::size_t roll = i % 2 == 0 ? steps + i / 2 : steps - (i + 1) / 2;
    const double roll_deg = (static_cast<double>(roll) - static_cast<double>(steps)) * kRollStepDeg;
    lines[roll] = search_line(samples, roll_deg, size, cx, plausible, params, roll, leaders);
  });
  std::vector<Hypothesis> found;
  for (const std::optional<Hypothesis>& line : lines) {
    if (line) found.push_back(*line);
  }
  std::ranges::stable_sort(found, [](const Hypothesis& x, const Hypothesis& y) { return x.score > y.score; });
  return found;
}

/// Iteratively reweighted least squares of d = a u + b v + c with Tukey's weights.
/// @param widen the band of the first step, in final widths; it shrinks by half of one each step.
GroundPlane refine_plane(const std::vector<DisparitySample>& samples, GroundPlane plane, double cx, int steps, double widen,
                         const GroundParams& params) {
  for (int i = 0; i < steps; ++i, widen = std::max(1.0, widen - 0.5)) {
    const SampleBand band{params.tolerance_ratio, params.tolerance_px, widen};
    const NormalEquations sums = add_up_normal_equations(samples, cx, plane, band);
    Eigen::Matrix3d normal;
    normal << sums[0], sums[1], sums[2], sums[1], sums[3], sums[4], sums[2], sums[4], sums[5];
    const Eigen::Vector3d right_side(sums[6], sums[7], sums[8]);
    const Eigen::LDLT<Eigen::Matrix3d> solver(normal);
    const Eigen::Vector3d solution = solver.solve(right_side);
    if (solver.info() != Eigen::Success || !solver.isPositive() || !solution.allFinite()) return {};
    plane = {solution[0], solution[1], solution[2] - solution[0] * cx};
  }
  return plane;
}

std::vector<DisparitySample> take_every(const std::vector<DisparitySample>& samples, std::size_t step) {
  std::vector<DisparitySample> some;
  some.reserve(samples.size() / step + 1);
  for (std::size_t i = 0; i < samples.size(); i += step) some.push_back(samples[i]);
  return some;
}

double score_plane(const std::vector<DisparitySample>& samples, const GroundPlane& plane, const cv::Size& size, double cx,
                   const GroundParams& params) {
  double score = 0.0;
  for (const DisparitySample& s : samples) {
    const double expected = plane.disparity(s.u + cx, s.v);
    if (expected > 0.0 && std::abs(s.d - expected) <= tolerance_at(s.d, params)) score += row_weight(s.v, size.height);
  }
  return score;
}

/// Counts how much of the picture, where the ground would be in range, really shows it.
void assess(GroundEstimate& estimate, const cv::Mat1f& disparity, const StereoCamera& camera, const GroundParams& params,
            int step) {
  const GroundPlane& plane = *estimate.plane;
  std::size_t expected_count = 0;
  std::size_t valid_count = 0;
  std::vector<float> residuals;
  residuals.reserve(static_cast<std::size_t>(disparity.rows / step + 1) * static_cast<std::size_t>(disparity.cols / step + 1));
  const int first = step / 2;
  const int columns = (disparity.cols - first + step - 1) / step;
  const GroundRange range(estimate.pose, camera, params.max_range_m);
  for (int v = first; v < disparity.rows; v += step) {
    const Span in_range = find_span(columns, (range.peak(v) - first) / step, [&](int column) {
      const auto point = estimate.pose.intersect(first + column * step, v, camera);
      return point && estimate.pose.distance(*point) <= params.max_range_m;
    });
    expected_count += static_cast<std::size_t>(in_range.end - in_range.begin);
    for (int column = in_range.begin; column < in_range.end; ++column) {
      const int u = first + column * step;
      const float d = disparity(v, u);
      if (d <= 0.0F) continue;
      ++valid_count;
      const double residual = d - plane.disparity(u, v);
      if (std::abs(residual) <= tolerance_at(d, params)) residuals.push_back(static_cast<float>(std::abs(residual)));
    }
  }
  if (residuals.empty()) return;
  const auto inliers = static_cast<double>(residuals.size());
  estimate.inlier_ratio = inliers / static_cast<double>(valid_count);
  estimate.confidence = std::min(1.0, inliers / static_cast<double>(expected_count) / kFullCoverage);
  const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
  std::ranges::nth_element(residuals, middle);
  estimate.residual_px = 1.4826 * *middle;  // median absolute deviation of a normal distribution
}

void tell_state(GroundEstimate& estimate, const GroundParams& params) {
  const auto below = [&](double limit) {
    return fmt::format("ground confidence {:.2f} is below {}", estimate.confidence, limit);
  };
  if (estimate.confidence >= params.seen_confidence) {
    estimate.state = GroundState::seen;
  } else if (estimate.confidence >= params.uncertain_confidence) {
    estimate.state = GroundState::uncertain;
    estimate.reason = below(params.seen_confidence);
  } else {
    estimate.reason = below(params.uncertain_confidence);
    estimate.plane.reset();
  }
}

GroundEstimate not_visible(const std::string& reason) {
  GroundEstimate estimate;
  estimate.reason = reason;
  return estimate;
}

}  // namespace

GroundParams GroundParams::paper() {
  GroundParams params;
  params.follow = false;
  return params;
}

void GroundParams::validate() const {
  const auto require = [](bool valid, const char* name, double value, const char* expected) {
    if (!valid) throw std::invalid_argument(fmt::format("ground.{} = {}, must be {}", name, value, expected));
  };
  require(min_height_m > 0.0 && min_height_m <= 100.0, "min_height_m", min_height_m, "above 0 to 100");
  require(max_height_m > min_height_m && max_height_m <= 100.0, "max_height_m", max_height_m, "above min_height_m to 100");
  require(min_pitch_deg >= -89.0 && min_pitch_deg <= 89.0, "min_pitch_deg", min_pitch_deg, "-89 to 89");
  require(max_pitch_deg > min_pitch_deg && max_pitch_deg <= 89.0, "max_pitch_deg", max_pitch_deg, "above min_pitch_deg to 89");
  require(max_roll_deg >= 0.0 && max_roll_deg <= 60.0, "max_roll_deg", max_roll_deg, "0 to 60");
  require(gravity_tolerance_deg > 0.0 && gravity_tolerance_deg <= 90.0, "gravity_tolerance_deg", gravity_tolerance_deg,
          "above 0 to 90");
  require(max_range_m > 0.0 && max_range_m <= 1000.0, "max_range_m", max_range_m, "above 0 to 1000");
  require(tolerance_ratio >= 0.0 && tolerance_ratio < 0.5, "tolerance_ratio", tolerance_ratio, "0 to below 0.5");
  require(tolerance_px > 0.0 && tolerance_px <= 20.0, "tolerance_px", tolerance_px, "above 0 to 20");
  require(ransac_iterations >= 1 && ransac_iterations <= 100000, "ransac_iterations", ransac_iterations, "1 to 100000");
  require(follow_slope_deg > 0.0 && follow_slope_deg <= 45.0, "follow_slope_deg", follow_slope_deg, "above 0 to 45");
  require(follow_cell_m >= 0.05 && follow_cell_m <= 2.0, "follow_cell_m", follow_cell_m, "0.05 to 2");
  require(follow_reach_m > 0.0 && follow_reach_m <= 5.0, "follow_reach_m", follow_reach_m, "above 0 to 5");
  require(follow_step_m > 0.0 && follow_step_m <= 10.0, "follow_step_m", follow_step_m, "above 0 to 10");
  require(follow_extent_m >= 0.0 && follow_extent_m <= 100.0, "follow_extent_m", follow_extent_m, "0 to 100");
  require(seed >= 0, "seed", seed, "0 or more");
  require(seen_confidence > 0.0 && seen_confidence <= 1.0, "seen_confidence", seen_confidence, "above 0 to 1");
  require(uncertain_confidence > 0.0 && uncertain_confidence <= seen_confidence, "uncertain_confidence", uncertain_confidence,
          "above 0 to seen_confidence");
}

GroundEstimate estimate_ground(const cv::Mat1f& disparity, const StereoCamera& camera, const GroundParams& params,
                               const std::optional<Eigen::Vector3d>& gravity, const std::optional<GroundPlane>& previous) {
  camera.validate();
  params.validate();
  if (gravity && !(gravity->allFinite() && gravity->norm() > 0.0)) {
    throw std::invalid_argument("gravity = not a finite direction, must be a non-zero vector");
  }
  const double reach = std::hypot(params.max_range_m, params.max_height_m);
  const double min_disparity = camera.focal * camera.baseline / reach;
  const auto pixels = static_cast<double>(disparity.total());
  const int step = std::max(1, static_cast<int>(std::lround(std::sqrt(pixels / kTargetSamples))));
  const std::vector<DisparitySample> samples = sample_disparities(disparity, camera.cx, min_disparity, step);
  if (samples.size() < kMinSamples) {
    return not_visible(
        fmt::format("{} valid disparities within {} m, at least {} needed", samples.size(), params.max_range_m, kMinSamples));
  }

  const Plausibility plausible(camera, params, gravity);
  const BinnedSamples binned(take_every(samples, kCoarseShare));
  const std::vector<DisparitySample>& some = binned.samples();
  std::vector<Hypothesis> hypotheses = search_lines(binned, disparity.size(), camera.cx, plausible, params);
  hypotheses.resize(std::min(hypotheses.size(), kRefined));
  if (previous) hypotheses.push_back({*previous, 0.0});

  // The band starts at three times its final width, because a hypothesis comes from two pixels and a coarse roll.
  tbb::parallel_for(std::size_t{0}, hypotheses.size(), [&](std::size_t i) {
    const GroundPlane plane = refine_plane(some, hypotheses[i].plane, camera.cx, kCoarseRefinements, 3.0, params);
    hypotheses[i] = {plane, score_plane(some, plane, disparity.size(), camera.cx, params)};
  });
  std::optional<Hypothesis> best;
  for (const Hypothesis& hypothesis : hypotheses) {
    if (plausible(hypothesis.plane) && (!best || hypothesis.score > best->score)) best = hypothesis;
  }
  if (best) best->plane = refine_plane(samples, best->plane, camera.cx, kFineRefinements, 1.0, params);
  if (!best || !plausible(best->plane)) return not_visible("no plane of plausible height and tilt");

  GroundEstimate estimate;
  estimate.plane = best->plane;
  estimate.pose = compute_ground_pose(*estimate.plane, camera);
  assess(estimate, disparity, camera, params, step);
  tell_state(estimate, params);
  return estimate;
}

}  // namespace brink
