#include "io/parameter_table.hpp"

namespace brink {
namespace {

void append(std::vector<ParameterEntry>& table, const std::vector<ParameterEntry>& group) {
  table.insert(table.end(), group.begin(), group.end());
}

std::vector<ParameterEntry> elas_table(ElasParams& p) {
  return {
      {"elas.min_disparity", &p.min_disparity, "px", "smallest disparity of support points"},
      {"elas.max_disparity", &p.max_disparity, "px", "largest disparity tried, inclusive"},
      {"elas.support_threshold", &p.support_threshold, "",
       "a support point's best cost must be below this times the second best"},
      {"elas.support_exclusion_px", &p.support_exclusion_px, "px",
       "disparities this near to the best do not count as second best"},
      {"elas.support_texture", &p.support_texture, "", "least texture (sum of 16 gradient magnitudes) of a support point"},
      {"elas.candidate_step_px", &p.candidate_step_px, "px", "grid step of support candidates"},
      {"elas.inconsistency_window", &p.inconsistency_window, "grid cells", "half window of the consistency test"},
      {"elas.inconsistency_threshold_px", &p.inconsistency_threshold_px, "px",
       "two support points agree up to this difference"},
      {"elas.inconsistency_min_support", &p.inconsistency_min_support, "",
       "least number of agreeing support points, itself included"},
      {"elas.add_corners", &p.add_corners, "", "support points in the picture's corners, extrapolation to its borders"},
      {"elas.grid_size_px", &p.grid_size_px, "px", "cell size of the disparities taken over from nearby support points"},
      {"elas.match_outside", &p.match_outside, "",
       "match pixels outside all triangles among nearby support points' disparities alone"},
      {"elas.beta", &p.beta, "", "weight of the likelihood"},
      {"elas.gamma", &p.gamma, "", "constant of the prior"},
      {"elas.sigma_px", &p.sigma_px, "px", "standard deviation of the prior"},
      {"elas.prior_radius", &p.prior_radius, "sigmas", "range around the prior's plane that is searched"},
      {"elas.match_texture", &p.match_texture, "", "least mean texture around a pixel for dense matching"},
      {"elas.texture_radius_px", &p.texture_radius_px, "px", "half window of that mean"},
      {"elas.match_margin", &p.match_margin, "",
       "share by which the least energy must be below that of any disparity further than 1 px away; 0 = no test"},
      {"elas.consistency_threshold_px", &p.consistency_threshold_px, "px", "left-right tolerance, support and dense"},
      {"elas.speckle_similarity_px", &p.speckle_similarity_px, "px", "neighbours closer than this belong to one segment"},
      {"elas.speckle_size_px", &p.speckle_size_px, "px", "segments of fewer pixels are removed"},
      {"elas.gap_width_px", &p.gap_width_px, "px", "longest gap that is interpolated"},
      {"elas.fill_across_steps", &p.fill_across_steps, "",
       "fill gaps between two surfaces as well, with the farther one's disparity"},
      {"elas.filter_median", &p.filter_median, "", "7-tap separable median"},
      {"elas.filter_adaptive_mean", &p.filter_adaptive_mean, "", "edge-preserving mean"},
      {"elas.subpixel", &p.subpixel, "", "refine each disparity below one pixel"},
  };
}

std::vector<ParameterEntry> bm_table(BmParams& p) {
  return {
      {"bm.max_disparity", &p.max_disparity, "px", "largest disparity tried, inclusive"},
      {"bm.block_size_px", &p.block_size_px, "px", "side of the compared block, odd"},
      {"bm.texture_threshold", &p.texture_threshold, "", "least texture of a block"},
      {"bm.uniqueness_percent", &p.uniqueness_percent, "percent", "the best cost must win by this much"},
      {"bm.consistency_threshold_px", &p.consistency_threshold_px, "px", "left-right tolerance"},
      {"bm.speckle_size_px", &p.speckle_size_px, "px", "segments of fewer pixels are removed"},
      {"bm.speckle_range_px", &p.speckle_range_px, "px", "disparity difference inside one segment"},
  };
}

std::vector<ParameterEntry> sgbm_table(SgbmParams& p) {
  return {
      {"sgbm.max_disparity", &p.max_disparity, "px", "largest disparity tried, inclusive"},
      {"sgbm.block_size_px", &p.block_size_px, "px", "side of the compared block, odd"},
      {"sgbm.uniqueness_percent", &p.uniqueness_percent, "percent", "the best cost must win by this much"},
      {"sgbm.consistency_threshold_px", &p.consistency_threshold_px, "px", "left-right tolerance"},
      {"sgbm.speckle_size_px", &p.speckle_size_px, "px", "segments of fewer pixels are removed"},
      {"sgbm.speckle_range_px", &p.speckle_range_px, "px", "disparity difference inside one segment"},
      {"sgbm.wls_lambda", &p.wls_lambda, "", "sgbm-wls: smoothness of the weighted-least-squares filter"},
      {"sgbm.wls_sigma", &p.wls_sigma, "", "sgbm-wls: sensitivity of the filter to edges of the picture"},
  };
}

std::vector<ParameterEntry> ground_table(GroundParams& p) {
  return {
      {"ground.min_height_m", &p.min_height_m, "m", "least height of the camera over the ground"},
      {"ground.max_height_m", &p.max_height_m, "m", "greatest height of the camera over the ground"},
      {"ground.min_pitch_deg", &p.min_pitch_deg, "degrees", "least pitch of the camera, positive = looking down"},
      {"ground.max_pitch_deg", &p.max_pitch_deg, "degrees", "greatest pitch of the camera"},
      {"ground.max_roll_deg", &p.max_roll_deg, "degrees", "greatest roll of the camera, to either side"},
      {"ground.gravity_tolerance_deg", &p.gravity_tolerance_deg, "degrees",
       "slope of the ground and error of gravity, where that is known"},
      {"ground.max_range_m", &p.max_range_m, "m", "ground farther away takes no part"},
      {"ground.tolerance_ratio", &p.tolerance_ratio, "camera heights", "roughness: half width of the band counted as ground"},
      {"ground.tolerance_px", &p.tolerance_px, "px", "noise of disparities: the band is never narrower than this"},
      {"ground.ransac_iterations", &p.ransac_iterations, "", "line hypotheses per roll angle"},
      {"ground.track", &p.track, "",
       "the ground is what the bearer stands on, from frame to frame; false = the plane of each frame"},
      {"ground.follow", &p.follow, "", "follow the surface where it bends away from the plane"},
      {"ground.follow_slope_deg", &p.follow_slope_deg, "degrees", "steepest surface that is followed"},
      {"ground.follow_cell_m", &p.follow_cell_m, "m", "the surface is followed in square cells of this size"},
      {"ground.follow_reach_m", &p.follow_reach_m, "m", "the slope must hold towards all of it that is this near"},
      {"ground.follow_step_m", &p.follow_step_m, "m", "what begins with a higher step is no bend of the ground"},
      {"ground.follow_extent_m", &p.follow_extent_m, "m", "smaller bends are none: shallow holes"},
      {"ground.seed", &p.seed, "", "seed of the random line hypotheses"},
      {"ground.seen_confidence", &p.seen_confidence, "", "confidence from which the ground counts as seen"},
      {"ground.uncertain_confidence", &p.uncertain_confidence, "",
       "confidence from which it counts as uncertain, not visible below"},
  };
}

std::vector<ParameterEntry> candidates_table(CandidateParams& p) {
  return {
      {"candidates.ground_tolerance_m", &p.ground_tolerance_m, "m", "a pixel nearer to the ground than this is a ground pixel"},
      {"candidates.min_depth_m", &p.min_depth_m, "m", "Type 1 lies at least this far below the ground"},
      {"candidates.below_ground_min_area_px", &p.below_ground_min_area_px, "px", "Type 1: the area must be greater"},
      {"candidates.below_ground_min_msr", &p.below_ground_min_msr, "1e-3 sr",
       "Type 1: ... and so must its solid angle; 0 = any"},
      {"candidates.no_disparity_min_area_px", &p.no_disparity_min_area_px, "px", "Type 2: the area must be greater"},
      {"candidates.min_touching_px", &p.min_touching_px, "px",
       "pixels of the other kind in the ring around a region that count as touching"},
      {"candidates.black_level", &p.black_level, "grey levels",
       "Type 2: mean colour, greatest of blue, green and red, is at most this"},
      {"candidates.measured_depth_ratio", &p.measured_depth_ratio, "", "share of min_depth_m that it may measure"},
      {"candidates.rim_depth_ratio", &p.rim_depth_ratio, "share of min_depth_m",
       "Type 1 is drawn out to where the surface is this deep; 1 = not"},
      {"candidates.min_slope_deg", &p.min_slope_deg, "degrees",
       "Type 1: a quarter of its rim must be steeper than this; 0 = any"},
      {"candidates.max_share_beyond", &p.max_share_beyond, "share",
       "Type 1: at most this share of it may lie beyond its far rim; 1 = no test"},
      {"candidates.max_roughness", &p.max_roughness, "",
       "Type 1: scatter of its disparities over that of the ground's, at most; 0 = any"},
      {"candidates.min_agreement", &p.min_agreement, "",
       "Type 1: the correlation of both pictures that three quarters of its windows reach, at least; 0 = no test"},
      {"candidates.min_ground_misfit", &p.min_ground_misfit, "share",
       "Type 1: the ground must explain the two pictures worse by this share; 0 = no test"},
      {"candidates.max_share_standing", &p.max_share_standing, "share",
       "Type 2: at most this share of its border may stand above the ground; 1 = no test"},
      {"candidates.touching_gap_px", &p.touching_gap_px, "px",
       "pixels without disparity between a region and what it touches, at most"},
      {"candidates.min_sigmas", &p.min_sigmas, "", "Type 1: depth in standard deviations of a single pixel, at least; 0 = any"},
      {"candidates.black_share", &p.black_share, "share",
       "Type 2: or its mean colour is at most this share of how bright the ground around it is; 0 = not"},
      {"candidates.black_by_median", &p.black_by_median, "",
       "Type 2: ... or the brightness that half of its pixels do not exceed is"},
      {"candidates.border_px", &p.border_px, "px",
       "Type 2 is looked for this far inside of what both cameras see of the ground"},
      {"candidates.merge_gap_m", &p.merge_gap_m, "m",
       "parts of one drop this near to each other, behind a handrail, are one candidate; 0 = never"},
      {"candidates.max_range_m", &p.max_range_m, "m", "candidates are looked for up to this distance in the ground plane"},
      {"candidates.tell_kind", &p.tell_kind, "", "tell stairs, edges and holes apart by their shape"},
      {"candidates.min_listed_area_px", &p.min_listed_area_px, "px", "smaller regions are not even listed as rejected"},
  };
}

std::vector<ParameterEntry> ego_motion_table(EgoMotionParams& p) {
  return {
      {"ego_motion.half_resolution_from_px", &p.half_resolution_from_px, "px",
       "pictures of at least this many pixels are searched for features at half size"},
      {"ego_motion.feature_radius_px", &p.feature_radius_px, "px",
       "no stronger feature within this distance, px of the searched picture"},
      {"ego_motion.min_response", &p.min_response, "", "least |filter response| of a feature"},
      {"ego_motion.feature_bucket_px", &p.feature_bucket_px, "px", "of each square of this size ..."},
      {"ego_motion.features_per_bucket", &p.features_per_bucket, "", "... so many of the strongest features are kept"},
      {"ego_motion.search_deg", &p.search_deg, "degrees", "half window around the predicted place"},
      {"ego_motion.wide_search_deg", &p.wide_search_deg, "degrees",
       "half window where nothing is predicted, or that prediction was wrong"},
      {"ego_motion.max_disparity_px", &p.max_disparity_px, "px", "greatest disparity of a feature"},
      {"ego_motion.row_tolerance_px", &p.row_tolerance_px, "px", "difference of rows between left and right"},
      {"ego_motion.max_match_cost", &p.max_match_cost, "", "greatest difference of two descriptors, 0 .. 8160"},
      {"ego_motion.match_ratio", &p.match_ratio, "", "the best match must cost less than this times the second best"},
      {"ego_motion.neighbour_radius_px", &p.neighbour_radius_px, "px", "matches within this distance are compared"},
      {"ego_motion.neighbour_tolerance_px", &p.neighbour_tolerance_px, "px",
       "they agree when flow and disparity differ by less than this ..."},
      {"ego_motion.neighbour_tolerance", &p.neighbour_tolerance, "",
       "... plus this share of their distance: flow changes over slanted ground"},
      {"ego_motion.neighbour_support", &p.neighbour_support, "", "agreeing neighbours that a match needs"},
      {"ego_motion.bucket_px", &p.bucket_px, "px", "of each square of this size ..."},
      {"ego_motion.matches_per_bucket", &p.matches_per_bucket, "", "... so many of the best matches are kept"},
      {"ego_motion.match_noise_px", &p.match_noise_px, "px", "standard deviation of a feature's place"},
      {"ego_motion.ransac_iterations", &p.ransac_iterations, "", "samples of three matches at most"},
      {"ego_motion.seed", &p.seed, "", "of these samples"},
      {"ego_motion.inlier_sigmas", &p.inlier_sigmas, "", "error of an inlier, expected standard deviations"},
      {"ego_motion.min_inliers", &p.min_inliers, "", "fewer give no motion"},
      {"ego_motion.min_inlier_ratio", &p.min_inlier_ratio, "", "inliers among the matches, less give no motion"},
      {"ego_motion.keyframes", &p.keyframes, "", "older frames that motions are measured against"},
      {"ego_motion.keyframe_points", &p.keyframe_points, "", "most points of one"},
      {"ego_motion.keyframe_overlap", &p.keyframe_overlap, "",
       "a new one is made when a smaller share of the newest one's points is seen"},
      {"ego_motion.slope_radius_px", &p.slope_radius_px, "px", "a surface's slope is fitted to points this near"},
      {"ego_motion.disparity_offset_sd_px", &p.disparity_offset_sd_px, "px",
       "constant error of disparities that rectification may leave, estimated; 0 = none"},
      {"ego_motion.max_error_scale", &p.max_error_scale, "",
       "errors larger than expected by this factor give no motion: eyes out of step"},
      {"ego_motion.max_translation_sd_m", &p.max_translation_sd_m, "m",
       "a motion known worse than this is none, standard deviation in any direction"},
      {"ego_motion.max_rotation_sd_deg", &p.max_rotation_sd_deg, "degrees", "likewise"},
      {"ego_motion.gyroscope_tolerance_deg", &p.gyroscope_tolerance_deg, "degrees",
       "a motion whose rotation differs more from the gyroscope's is none"},
      {"ego_motion.turn_jerk_deg", &p.turn_jerk_deg, "degrees", "velocity filter: change of angular acceleration, degrees/s^3"},
      {"ego_motion.jerk_m", &p.jerk_m, "m", "velocity filter: change of acceleration, m/s^3"},
  };
}

std::vector<ParameterEntry> tracking_table(TrackingParams& p) {
  return {
      {"tracking.association_radius_m", &p.association_radius_m, "m",
       "a candidate is the same as one whose place was this near a frame ago"},
      {"tracking.associate_rims", &p.associate_rims, "", "compare places by the nearest point of the rim, too"},
      {"tracking.max_unseen_s", &p.max_unseen_s, "s", "a track that is not seen lives on for this long"},
      {"tracking.max_coast_s", &p.max_coast_s, "s",
       "a validated track is told for this long unseen, while nothing contradicts it; 0 = never"},
      {"tracking.max_blind_s", &p.max_blind_s, "s",
       "so long may frames fail, or the camera's motion be unknown, before all tracks end"},
      {"tracking.validation_s", &p.validation_s, "s", "a candidate is validated when it was seen in a row for this long"},
      {"tracking.min_probability", &p.min_probability, "",
       "a candidate is not validated below this probability; 0 = whatever it is, and none is told"},
      {"tracking.min_sightings", &p.min_sightings, "", "but never before it was seen so often"},
  };
}

}  // namespace

std::vector<ParameterEntry> parameter_table(DetectorParams& params) {
  std::vector<ParameterEntry> table = {
      {"disparity.matcher", &params.disparity.matcher, "", "elas, bm, sgbm or sgbm-wls"},
      {"detector.report_range_m", &params.report_range_m, "m", "obstacles are reported up to this distance of their rim"},
      {"detector.report_slack_m", &params.report_slack_m, "m", "... and, once they were, up to this much farther"},
      {"detector.path_width_m", &params.path_width_m, "m",
       "time to edge: the strip of ground that a bearer walks on; 0 = it is not told"},
      {"detector.stills", &params.stills, "", "unrelated pictures: every candidate in range is an obstacle at once"},
  };
  append(table, elas_table(params.disparity.elas));
  append(table, bm_table(params.disparity.bm));
  append(table, sgbm_table(params.disparity.sgbm));
  append(table, ground_table(params.ground));
  append(table, candidates_table(params.candidates));
  append(table, ego_motion_table(params.ego_motion));
  append(table, tracking_table(params.tracking));
  return table;
}

}  // namespace brink
