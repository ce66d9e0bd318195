#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "brink/ground.hpp"
#include "ground/assess.hpp"
#include "ground/plane_search.hpp"

namespace brink {

GroundParams GroundParams::paper() {
  GroundParams params;
  params.track = false;
  params.follow = false;
  params.min_height_m = 0.3;
  params.max_height_m = 2.5;
  params.max_pitch_deg = 60.0;
  params.max_roll_deg = 25.0;
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
  check_gravity(gravity);
  const GroundSamples samples = take_ground_samples(disparity, camera, params);
  if (samples.all.size() < kMinGroundSamples) return make_ground_without_samples(samples, params);

  const Plausibility plausible(camera, params, gravity);
  const RollRange all_rolls{-params.max_roll_deg, params.max_roll_deg};
  std::optional<PlaneHypothesis> best;
  for (const PlaneHypothesis& hypothesis : search_planes(samples, plausible, all_rolls, params, previous)) {
    if (plausible(hypothesis.plane) && (!best || hypothesis.score > best->score)) best = hypothesis;
  }
  if (best) best->plane = finish_plane(samples, best->plane, params);
  if (!best || !plausible(best->plane)) return make_invisible_ground("no plane of plausible height and tilt");
  return assess_plane(best->plane, disparity, samples, params);
}

}  // namespace brink
