#include "disparity/parameters.hpp"

#include <string_view>

#include "brink/ego_motion.hpp"

namespace brink {

void EgoMotionParams::validate() const {
  const auto between = [](std::string_view name, auto value, decltype(value) least, decltype(value) most) {
    require_between(fmt::format("ego_motion.{}", name), value, least, most);
  };
  between("half_resolution_from_px", half_resolution_from_px, 0, 1000000000);
  between("feature_radius_px", feature_radius_px, 1, 20);
  between("min_response", min_response, 1, 10000);
  between("feature_bucket_px", feature_bucket_px, 4, 10000);
  between("features_per_bucket", features_per_bucket, 1, 10000);
  between("search_deg", search_deg, 0.1, 60.0);
  between("wide_search_deg", wide_search_deg, 0.1, 60.0);
  between("max_disparity_px", max_disparity_px, 1.0, 10000.0);
  between("row_tolerance_px", row_tolerance_px, 0.0, 100.0);
  between("max_match_cost", max_match_cost, 0, 8160);
  between("match_ratio", match_ratio, 0.1, 1.0);
  between("neighbour_radius_px", neighbour_radius_px, 1.0, 10000.0);
  between("neighbour_tolerance_px", neighbour_tolerance_px, 0.0, 1000.0);
  between("neighbour_tolerance", neighbour_tolerance, 0.0, 10.0);
  between("neighbour_support", neighbour_support, 0, 1000);
  between("bucket_px", bucket_px, 4.0, 10000.0);
  between("matches_per_bucket", matches_per_bucket, 1, 10000);
  between("match_noise_px", match_noise_px, 0.01, 100.0);
  between("ransac_iterations", ransac_iterations, 1, 100000);
  between("seed", seed, 0, 2147483647);
  between("inlier_sigmas", inlier_sigmas, 0.1, 100.0);
  between("min_inliers", min_inliers, 6, 10000);
  between("min_inlier_ratio", min_inlier_ratio, 0.0, 1.0);
  between("keyframes", keyframes, 1, 100);
  between("keyframe_points", keyframe_points, 12, 100000);
  between("keyframe_overlap", keyframe_overlap, 0.0, 1.0);
  between("slope_radius_px", slope_radius_px, 1.0, 10000.0);
  between("disparity_offset_sd_px", disparity_offset_sd_px, 0.0, 10.0);
  between("max_error_scale", max_error_scale, 0.1, 1000.0);
  between("max_translation_sd_m", max_translation_sd_m, 1e-6, 1000.0);
  between("max_rotation_sd_deg", max_rotation_sd_deg, 1e-6, 180.0);
  between("gyroscope_tolerance_deg", gyroscope_tolerance_deg, 0.0, 180.0);
  between("turn_jerk_deg", turn_jerk_deg, 1e-3, 1e9);
  between("jerk_m", jerk_m, 1e-6, 1e9);
}

}  // namespace brink
