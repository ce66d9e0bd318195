#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "brink/ground.hpp"
#include "ground/plane_search.hpp"

namespace brink {

/// What the pixels show whose rays meet a plane within GroundParams::max_range_m, on the grid of the samples.
struct PlaneCounts {
  std::size_t expected = 0;  ///< all of them
  std::size_t valid = 0;     ///< with a disparity
  std::size_t on = 0;        ///< on the plane
  std::size_t level = 0;     ///< of these, with the plane going on above and below them in the image: no wall that crosses it
  std::size_t below = 0;     ///< clearly below it: the ground is not there
  double residual_px = 0.0;  ///< robust standard deviation of the disparities on the plane
};
PlaneCounts count_pixels(const GroundPlane& plane, const cv::Mat1f& disparity, const GroundSamples& samples,
                         const GroundParams& params);

/// A ground from one frame alone: confidence and state follow from the share of the expected pixels that lie on the plane.
GroundEstimate assess_plane(const GroundPlane& plane, const cv::Mat1f& disparity, const GroundSamples& samples,
                            const GroundParams& params);

/// Share of the expected pixels on the ground that gives full confidence.
inline constexpr double kFullCoverage = 0.4;

/// State, and reason where it is not `seen`, from the confidence; without a plane when that is too low.
void set_state(GroundEstimate& estimate, const GroundParams& params);

GroundEstimate make_invisible_ground(const std::string& reason);
/// For fewer than kMinGroundSamples.
GroundEstimate make_ground_without_samples(const GroundSamples& samples, const GroundParams& params);

/// @throws std::invalid_argument when gravity is given and is not a finite non-zero vector.
void check_gravity(const std::optional<Eigen::Vector3d>& gravity);

}  // namespace brink
