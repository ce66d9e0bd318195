#include "ground/assess.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "ground/range.hpp"

namespace brink {
namespace {

/// Whether a pixel lies on a plane; so do those outside of the image, of which nothing is known.
bool is_on(int u, int v, const GroundPlane& plane, const cv::Mat1f& disparity, const GroundParams& params) {
  if (v < 0 || v >= disparity.rows) return true;
  const float d = disparity(v, u);
  return d > 0.0F && std::abs(d - plane.disparity(u, v)) <= ground_tolerance_px(d, params);
}

}  // namespace

PlaneCounts count_pixels(const GroundPlane& plane, const cv::Mat1f& disparity, const GroundSamples& samples,
                         const GroundParams& params) {
  constexpr double kClearly = 3.0;  // bands below the plane
  constexpr double kApart = 0.03;   // of the image's height: farther than the band of a wall that crosses the plane
  const int apart = std::max(1, static_cast<int>(kApart * disparity.rows));
  const StereoCamera& camera = samples.camera;
  const GroundPose pose = compute_ground_pose(plane, camera);
  const int step = samples.step;
  PlaneCounts counts;
  std::vector<float> residuals;
  residuals.reserve(static_cast<std::size_t>(disparity.rows / step + 1) * static_cast<std::size_t>(disparity.cols / step + 1));
  const int first = step / 2;
  const int columns = (disparity.cols - first + step - 1) / step;
  const GroundRange range(pose, camera, params.max_range_m);
  for (int v = first; v < disparity.rows; v += step) {
    const Span in_range = find_span(columns, (range.peak(v) - first) / step, [&](int column) {
      const auto point = pose.intersect(first + column * step, v, camera);
      return point && pose.distance(*point) <= params.max_range_m;
    });
    counts.expected += static_cast<std::size_t>(in_range.end - in_range.begin);
    for (int column = in_range.begin; column < in_range.end; ++column) {
      const int u = first + column * step;
      const float d = disparity(v, u);
      if (d <= 0.0F) continue;
      ++counts.valid;
      const double residual = d - plane.disparity(u, v);
      const double tolerance = ground_tolerance_px(d, params);
      if (std::abs(residual) <= tolerance) {
        counts.level += is_on(u, v - apart, plane, disparity, params) && is_on(u, v + apart, plane, disparity, params) ? 1 : 0;
        residuals.push_back(static_cast<float>(std::abs(residual)));
      }
      if (residual < -kClearly * tolerance) ++counts.below;
    }
  }
  counts.on = residuals.size();
  if (residuals.empty()) return counts;
  const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
  std::ranges::nth_element(residuals, middle);
  counts.residual_px = 1.4826 * *middle;  // median absolute deviation of a normal distribution
  return counts;
}

GroundEstimate assess_plane(const GroundPlane& plane, const cv::Mat1f& disparity, const GroundSamples& samples,
                            const GroundParams& params) {
  GroundEstimate estimate;
  estimate.plane = plane;
  estimate.pose = compute_ground_pose(plane, samples.camera);
  const PlaneCounts counts = count_pixels(plane, disparity, samples, params);
  if (counts.on > 0) {
    const auto on = static_cast<double>(counts.on);
    estimate.inlier_ratio = on / static_cast<double>(counts.valid);
    estimate.confidence = std::min(1.0, on / static_cast<double>(counts.expected) / kFullCoverage);
    estimate.residual_px = counts.residual_px;
  }
  set_state(estimate, params);
  return estimate;
}

void set_state(GroundEstimate& estimate, const GroundParams& params) {
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

GroundEstimate make_invisible_ground(const std::string& reason) {
  GroundEstimate estimate;
  estimate.reason = reason;
  return estimate;
}

GroundEstimate make_ground_without_samples(const GroundSamples& samples, const GroundParams& params) {
  return make_invisible_ground(fmt::format("{} valid disparities within {} m, at least {} needed", samples.all.size(),
                                           params.max_range_m, kMinGroundSamples));
}

void check_gravity(const std::optional<Eigen::Vector3d>& gravity) {
  if (gravity && !(gravity->allFinite() && gravity->norm() > 0.0)) {
    throw std::invalid_argument("gravity = not a finite direction, must be a non-zero vector");
  }
}

}  // namespace brink
