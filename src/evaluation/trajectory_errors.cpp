#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "brink/trajectory.hpp"

namespace brink {
namespace {

using Poses = std::vector<Eigen::Isometry3d>;

constexpr double kDegPerRad = 180.0 / std::numbers::pi;

void validate(const Trajectory& estimate, const Trajectory& truth, double segment_m) {
  const std::size_t poses = truth.world_from_camera.size();
  if (estimate.world_from_camera.size() != poses) {
    throw std::invalid_argument(
        fmt::format("estimate has {} poses, must be {} like the truth", estimate.world_from_camera.size(), poses));
  }
  if (poses < 2) throw std::invalid_argument(fmt::format("trajectory has {} poses, must be at least 2", poses));
  if (!(segment_m > 0.0)) throw std::invalid_argument(fmt::format("segment_m = {}, must be > 0", segment_m));
}

/// The same motion, begun at the identity.
Poses from_first(const Poses& world_from_camera) {
  const Eigen::Isometry3d first_from_world = world_from_camera.front().inverse();
  Poses poses;
  for (const Eigen::Isometry3d& pose : world_from_camera) poses.emplace_back(first_from_world * pose);
  return poses;
}

/// The motion from each pose to the next one.
Poses steps_of(const Poses& poses) {
  Poses steps;
  for (std::size_t i = 1; i < poses.size(); ++i) steps.emplace_back(poses[i - 1].inverse() * poses[i]);
  return steps;
}

MeanAndDeviation summarise(const std::vector<double>& values) {
  const auto count = static_cast<double>(values.size());
  MeanAndDeviation result;
  for (const double value : values) result.mean += value / count;
  double variance = 0.0;
  for (const double value : values) variance += (value - result.mean) * (value - result.mean) / count;
  result.deviation = std::sqrt(variance);
  return result;
}

MeanAndDeviation compare_rotations(const Poses& estimate, const Poses& truth) {
  std::vector<double> differences;
  for (std::size_t i = 0; i < truth.size(); ++i) differences.push_back((truth[i].linear() - estimate[i].linear()).norm());
  return summarise(differences);
}

MeanAndDeviation compare_translations(const Poses& estimate, const Poses& truth) {
  std::vector<double> differences;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    differences.push_back((truth[i].translation() - estimate[i].translation()).norm());
  }
  return summarise(differences);
}

/// Length of the path up to each pose, m.
std::vector<double> path_lengths(const Poses& poses) {
  std::vector<double> lengths{0.0};
  for (const Eigen::Isometry3d& step : steps_of(poses)) lengths.push_back(lengths.back() + step.translation().norm());
  return lengths;
}

/// Not by the trace: its arc cosine knows no angle below 1e-8.
double rotation_angle(const Eigen::Isometry3d& motion) {
  const Eigen::Quaterniond q(motion.linear());
  return 2.0 * std::atan2(q.vec().norm(), std::abs(q.w()));
}

/// Sums over all segments.
struct SegmentErrors {
  int segments = 0;
  double translation = 0.0;  // m/m
  double rotation_deg_per_m = 0.0;
};

/// KITTI's relative errors: Geiger, Lenz, Urtasun (CVPR 2012), but a segment starts at every frame, and its error is divided by
/// its own length, which is a little more than segment_m.
SegmentErrors measure_segments(const Poses& estimate, const Poses& truth, double segment_m) {
  constexpr double kRounding = 1.0 - 1e-9;  // a sum of steps may miss the length that it has by the last digit
  const std::vector<double> lengths = path_lengths(truth);
  SegmentErrors errors;
  std::size_t last = 0;
  for (std::size_t first = 0; first < truth.size(); ++first) {
    while (last < truth.size() && lengths[last] - lengths[first] < segment_m * kRounding) ++last;
    if (last == truth.size()) break;
    const Eigen::Isometry3d true_motion = truth[first].inverse() * truth[last];
    const Eigen::Isometry3d estimated_motion = estimate[first].inverse() * estimate[last];
    const Eigen::Isometry3d error = estimated_motion.inverse() * true_motion;
    const double length = lengths[last] - lengths[first];
    errors.translation += error.translation().norm() / length;
    errors.rotation_deg_per_m += kDegPerRad * rotation_angle(error) / length;
    ++errors.segments;
  }
  return errors;
}

/// Umeyama (PAMI 1991) without scale. A straight path leaves the turn about itself open, which moves none of its points.
double compute_ate_rmse(const Poses& estimate, const Poses& truth) {
  const auto count = static_cast<Eigen::Index>(truth.size());
  Eigen::Matrix3Xd estimated(3, count);
  Eigen::Matrix3Xd expected(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    estimated.col(i) = estimate[static_cast<std::size_t>(i)].translation();
    expected.col(i) = truth[static_cast<std::size_t>(i)].translation();
  }
  const Eigen::Isometry3d alignment(Eigen::umeyama(estimated, expected, false));
  return std::sqrt((alignment * estimated - expected).colwise().squaredNorm().mean());
}

}  // namespace

TrajectoryErrors compute_trajectory_errors(const Trajectory& estimate, const Trajectory& truth, double segment_m) {
  validate(estimate, truth, segment_m);
  const Poses estimated = from_first(estimate.world_from_camera);
  const Poses expected = from_first(truth.world_from_camera);
  TrajectoryErrors errors;
  errors.poses = static_cast<int>(expected.size());
  errors.length_m = path_lengths(expected).back();
  errors.rotation = compare_rotations(estimated, expected);
  errors.translation_m = compare_translations(estimated, expected);
  errors.step_rotation = compare_rotations(steps_of(estimated), steps_of(expected));
  errors.step_translation_m = compare_translations(steps_of(estimated), steps_of(expected));
  const SegmentErrors sums = measure_segments(estimated, expected, segment_m);
  errors.segments = sums.segments;
  if (sums.segments > 0) {
    errors.segment_translation_percent = 100.0 * sums.translation / sums.segments;
    errors.segment_rotation_deg_per_m = sums.rotation_deg_per_m / sums.segments;
  }
  if (errors.length_m > 0.0) {
    const double end_error = (estimated.back().translation() - expected.back().translation()).norm();
    errors.end_error_percent = 100.0 * end_error / errors.length_m;
  }
  errors.ate_rmse_m = compute_ate_rmse(estimated, expected);
  return errors;
}

}  // namespace brink
