#include "evaluation/expectation.hpp"

#include <cmath>
#include <numbers>

#include "brink/envelope.hpp"
#include "io/rim_plane.hpp"

namespace brink {

std::optional<bool> is_in_envelope(const VisibleInstance& instance, const FrameTruth& truth, const Detection& detection,
                                   const CandidateParams& rules) {
  const std::optional<GroundPose> ground = fit_rim_plane(instance.opening);
  if (!ground || !instance.depth_m || !truth.camera || !detection.disparity_sd_px) return std::nullopt;
  constexpr double kDegPerRad = 180.0 / std::numbers::pi;
  const Viewpoint viewpoint = make_viewpoint(*truth.camera, truth.negative.size(),
                                             {.height_m = ground->height_m,
                                              .pitch_deg = std::asin(ground->down.z()) * kDegPerRad,
                                              .roll_deg = std::atan2(ground->down.x(), ground->down.y()) * kDegPerRad,
                                              .disparity_sd_px = *detection.disparity_sd_px});
  const GroundPose& pose = viewpoint.ground.pose;
  Drop drop;
  drop.depth_m = *instance.depth_m;
  for (const Eigen::Vector3d& point : instance.opening) drop.rim.emplace_back(pose.right.dot(point), pose.forward.dot(point));
  const Shown shown{cv::Mat1b(truth.negative == instance.id), cv::Mat1b(truth.negative == 0)};
  return !compute_sighting(drop, viewpoint, rules, shown).rejection;
}

}  // namespace brink
