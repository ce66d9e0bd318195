#include "ground/plane_search.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <mutex>
#include <numbers>
#include <random>

#include <Eigen/Cholesky>
#include <tbb/parallel_for.h>

#include "ground/normal_equations_simd.hpp"

namespace brink {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;
constexpr double kRollStepDeg = 2.5;     // the refinement takes the rest
constexpr int kTargetSamples = 60000;    // enough for 0.01 px in the plane; keeps the stage below the paper's 8.4 ms
constexpr std::size_t kRefined = 4;      // hypotheses that are refined to a plane
constexpr std::size_t kCoarseShare = 4;  // every fourth sample finds the best hypothesis, all of them refine it
constexpr int kCoarseRefinements = 8;    // steps of the iteratively reweighted least squares on that part ...
constexpr int kFineRefinements = 4;      // ... and on all

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
std::optional<PlaneHypothesis> search_line(const BinnedSamples& binned, double roll_deg, const cv::Size& size, double cx,
                                           const Plausibility& plausible, const GroundParams& params, std::size_t roll,
                                           Leaders& leaders) {
  const double tan_roll = std::tan(roll_deg / kDegPerRad);
  const std::vector<DisparitySample>& samples = binned.samples();
  VDisparity histogram(binned, tan_roll, size.height);
  std::mt19937 random(static_cast<std::mt19937::result_type>(params.seed));
  // Not std::uniform_int_distribution: its sequence differs between standard libraries.
  const auto draw = [&] { return samples[random() % samples.size()]; };
  std::optional<PlaneHypothesis> best;
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
    best = PlaneHypothesis{plane, *score};
    leaders.note(roll, *score);
  }
  return best;
}

/// The best lines of the roll angles, best first; those that are not among the first kRefined may be missing.
std::vector<PlaneHypothesis> search_lines(const GroundSamples& samples, const Plausibility& plausible, const RollRange& rolls,
                                          const GroundParams& params) {
  const int first = static_cast<int>(std::floor(rolls.min_deg / kRollStepDeg));
  const int last = static_cast<int>(std::ceil(rolls.max_deg / kRollStepDeg));
  std::vector<std::optional<PlaneHypothesis>> lines(static_cast<std::size_t>(last - first + 1));
  Leaders leaders(lines.size());
  // From the middle outwards: most likely the best come first.
  const std::size_t middle = (lines.size() - 1) / 2;
  tbb::parallel_for(std::size_t{0}, lines.size(), [&](std::size_t i) {
    const std::size_t roll = i % 2 == 0 ? middle - i / 2 : middle + (i + 1) / 2;
    const double roll_deg = (first + static_cast<int>(roll)) * kRollStepDeg;
    lines[roll] = search_line(samples.coarse, roll_deg, samples.size, samples.camera.cx, plausible, params, roll, leaders);
  });
  std::vector<PlaneHypothesis> found;
  for (const std::optional<PlaneHypothesis>& line : lines) {
    if (line) found.push_back(*line);
  }
  std::ranges::stable_sort(found, std::greater<>(), &PlaneHypothesis::score);
  return found;
}

std::vector<DisparitySample> take_every(const std::vector<DisparitySample>& samples, std::size_t step) {
  std::vector<DisparitySample> some;
  some.reserve(samples.size() / step + 1);
  for (std::size_t i = 0; i < samples.size(); i += step) some.push_back(samples[i]);
  return some;
}

/// Adds a prior to the normal equations of d = a u + b v + c: samples of its plane at the corners of the image's lower half.
void add_prior(const PlanePrior& prior, const GroundSamples& frame, NormalEquations& sums) {
  const double weight = prior.weight / 4.0;
  for (const double v : {0.5 * frame.size.height, frame.size.height - 1.0}) {
    for (const double column : {0.0, frame.size.width - 1.0}) {
      const double u = column - frame.camera.cx;
      const double d = prior.plane.disparity(column, v);
      const NormalEquations terms{u * u, u * v, u, v * v, v, 1.0, d * u, d * v, d};
      for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += weight * terms[i];
    }
  }
}

}  // namespace

GroundSamples take_ground_samples(const cv::Mat1f& disparity, const StereoCamera& camera, const GroundParams& params) {
  const double reach = std::hypot(params.max_range_m, params.max_height_m);
  const double min_disparity = camera.focal * camera.baseline / reach;
  const auto pixels = static_cast<double>(disparity.total());
  GroundSamples samples;
  samples.step = std::max(1, static_cast<int>(std::lround(std::sqrt(pixels / kTargetSamples))));
  samples.size = disparity.size();
  samples.camera = camera;
  samples.all = sample_disparities(disparity, camera.cx, min_disparity, samples.step);
  samples.coarse = BinnedSamples(take_every(samples.all, kCoarseShare));
  return samples;
}

double ground_tolerance_px(double disparity, const GroundParams& params) {
  return std::max(params.tolerance_px, params.tolerance_ratio * disparity);
}

Plausibility::Plausibility(const StereoCamera& camera, const GroundParams& params,
                           const std::optional<Eigen::Vector3d>& gravity)
    : camera_(camera), params_(params), min_cos_(std::cos(params.gravity_tolerance_deg / kDegPerRad)) {
  if (gravity) gravity_ = gravity->normalized();
}

bool Plausibility::operator()(const GroundPlane& plane) const {
  if (!(plane.b > 0.0)) return false;
  const GroundPose pose = compute_ground_pose(plane, camera_);
  return pose.height_m >= params_.min_height_m && pose.height_m <= params_.max_height_m &&
         pose.pitch_deg >= params_.min_pitch_deg && pose.pitch_deg <= params_.max_pitch_deg &&
         std::abs(pose.roll_deg) <= params_.max_roll_deg && (!gravity_ || pose.down.dot(*gravity_) >= min_cos_);
}

std::vector<PlaneHypothesis> search_planes(const GroundSamples& samples, const Plausibility& plausible, const RollRange& rolls,
                                           const GroundParams& params, const std::optional<GroundPlane>& extra) {
  std::vector<PlaneHypothesis> hypotheses = search_lines(samples, plausible, rolls, params);
  hypotheses.resize(std::min(hypotheses.size(), kRefined));
  if (extra) hypotheses.push_back({*extra, 0.0});
  // The band starts at three times its final width, because a hypothesis comes from two pixels and a coarse roll.
  tbb::parallel_for(std::size_t{0}, hypotheses.size(), [&](std::size_t i) {
    const std::vector<DisparitySample>& coarse = samples.coarse.samples();
    const GroundPlane plane = refine_plane(coarse, hypotheses[i].plane, samples, kCoarseRefinements, 3.0, params);
    hypotheses[i] = {plane, score_plane(samples, plane, params)};
  });
  return hypotheses;
}

double score_plane(const GroundSamples& samples, const GroundPlane& plane, const GroundParams& params) {
  double score = 0.0;
  for (const DisparitySample& s : samples.coarse.samples()) {
    const double expected = plane.disparity(s.u + samples.camera.cx, s.v);
    if (expected > 0.0 && std::abs(s.d - expected) <= ground_tolerance_px(s.d, params)) {
      score += row_weight(s.v, samples.size.height);
    }
  }
  return score;
}

double score_near(const GroundSamples& samples, const std::optional<GroundPlane>& plane, const GroundParams& params,
                  const std::optional<GroundPlane>& among) {
  double score = 0.0;
  for (const DisparitySample& s : samples.coarse.samples()) {
    const double tolerance = ground_tolerance_px(s.d, params);
    if (among && !(std::abs(s.d - among->disparity(s.u + samples.camera.cx, s.v)) < tolerance)) continue;
    const double expected = plane ? plane->disparity(s.u + samples.camera.cx, s.v) : s.d;
    const double off = (s.d - expected) / tolerance;
    if (expected > 0.0 && std::abs(off) < 1.0) score += s.d * s.d * (1.0 - off * off);
  }
  return score;
}

GroundPlane refine_plane(const std::vector<DisparitySample>& samples, GroundPlane plane, const GroundSamples& frame, int steps,
                         double widen, const GroundParams& params, const std::optional<PlanePrior>& prior) {
  const double cx = frame.camera.cx;
  for (int i = 0; i < steps; ++i, widen = std::max(1.0, widen - 0.5)) {
    const SampleBand band{params.tolerance_ratio, params.tolerance_px, widen};
    NormalEquations sums = add_up_normal_equations(samples, cx, plane, band);
    if (prior) add_prior(*prior, frame, sums);
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

GroundPlane finish_plane(const GroundSamples& samples, const GroundPlane& plane, const GroundParams& params) {
  return refine_plane(samples.all, plane, samples, kFineRefinements, 1.0, params);
}

}  // namespace brink
