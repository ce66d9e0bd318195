#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "brink/camera.hpp"
#include "brink/ground.hpp"
#include "ground/v_disparity.hpp"

namespace brink {

/// The disparities of one frame in which ground planes are searched: a regular grid of its pixels, those within
/// GroundParams::max_range_m.
struct GroundSamples {
  std::vector<DisparitySample> all;
  BinnedSamples coarse{{}};  ///< every fourth of them
  int step = 1;              ///< px between samples, along rows and columns
  cv::Size size;             ///< of the disparity image
  StereoCamera camera;
};

/// Fewer samples than this say nothing about a ground.
inline constexpr std::size_t kMinGroundSamples = 100;

GroundSamples take_ground_samples(const cv::Mat1f& disparity, const StereoCamera& camera, const GroundParams& params);

/// Half width of the band around a plane in which a disparity counts as ground, px.
double ground_tolerance_px(double disparity, const GroundParams& params);

/// What a plane must satisfy to be the ground under a person or a robot (algorithms.md C.2).
class Plausibility {
 public:
  Plausibility(const StereoCamera& camera, const GroundParams& params, const std::optional<Eigen::Vector3d>& gravity);
  [[nodiscard]] bool operator()(const GroundPlane& plane) const;

 private:
  StereoCamera camera_;
  GroundParams params_;
  std::optional<Eigen::Vector3d> gravity_;
  double min_cos_;
};

/// Roll angles that are searched, degrees.
struct RollRange {
  double min_deg = 0.0;
  double max_deg = 0.0;
};

/// A plane that may be the ground, with the weight of the samples that lie on it, the lower rows of the image weighing more.
struct PlaneHypothesis {
  GroundPlane plane;
  double score = 0.0;
};

/// Section III.C.2: the best lines of the v-disparity histograms of all roll angles, each refined to a plane on the coarse
/// samples.
/// @param extra a further plane to refine, wherever it comes from.
/// @return unordered; planes that are not plausible any more after the refinement are among them.
std::vector<PlaneHypothesis> search_planes(const GroundSamples& samples, const Plausibility& plausible, const RollRange& rolls,
                                           const GroundParams& params, const std::optional<GroundPlane>& extra = std::nullopt);

/// The sum of the weights of the coarse samples on a plane, as in PlaneHypothesis.
double score_plane(const GroundSamples& samples, const GroundPlane& plane, const GroundParams& params);

/// How much of what is near the feet lies on a plane: each coarse sample weighs by the square of its disparity. @param plane
/// empty = all samples.
double score_near(const GroundSamples& samples, const std::optional<GroundPlane>& plane, const GroundParams& params,
                  const std::optional<GroundPlane>& among = std::nullopt);

/// What is known of a plane before this frame is looked at: it weighs as much as `weight` samples on it.
struct PlanePrior {
  GroundPlane plane;
  double weight = 0.0;
};

/// Iteratively reweighted least squares of d = a u + b v + c with Tukey's weights.
/// @param samples u from the principal point, as in GroundSamples. @param plane to start from.
/// @param widen the band of the first step, in final widths; it shrinks by half of one each step.
/// @return all zero when the samples determine no plane.
GroundPlane refine_plane(const std::vector<DisparitySample>& samples, GroundPlane plane, const GroundSamples& frame, int steps,
                         double widen, const GroundParams& params, const std::optional<PlanePrior>& prior = std::nullopt);

/// Last step for the plane that was chosen: on all samples, with the final band.
GroundPlane finish_plane(const GroundSamples& samples, const GroundPlane& plane, const GroundParams& params);

}  // namespace brink
