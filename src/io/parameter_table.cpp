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
       "slope of the ground against gravity, where that is known"},
      {"ground.max_range_m", &p.max_range_m, "m", "ground farther away takes no part"},
      {"ground.tolerance_ratio", &p.tolerance_ratio, "camera heights", "roughness: half width of the band counted as ground"},
      {"ground.tolerance_px", &p.tolerance_px, "px", "noise of disparities: the band is never narrower than this"},
      {"ground.ransac_iterations", &p.ransac_iterations, "", "line hypotheses per roll angle"},
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
      {"candidates.no_disparity_min_area_px", &p.no_disparity_min_area_px, "px", "Type 2: the area must be greater"},
      {"candidates.min_touching_px", &p.min_touching_px, "px",
       "pixels of the other kind in the ring around a region that count as touching"},
      {"candidates.black_level", &p.black_level, "grey levels",
       "Type 2: mean colour, greatest of blue, green and red, is at most this"},
      {"candidates.rim_depth_ratio", &p.rim_depth_ratio, "share of min_depth_m",
       "Type 1 is drawn out to where the surface is this deep; 1 = not"},
      {"candidates.min_slope_deg", &p.min_slope_deg, "degrees",
       "Type 1: a quarter of its rim must be steeper than this; 0 = any"},
      {"candidates.border_px", &p.border_px, "px",
       "Type 2 is looked for this far inside of what both cameras see of the ground"},
      {"candidates.max_range_m", &p.max_range_m, "m", "candidates are looked for up to this distance in the ground plane"},
      {"candidates.min_listed_area_px", &p.min_listed_area_px, "px", "smaller regions are not even listed as rejected"},
  };
}

}  // namespace

std::vector<ParameterEntry> parameter_table(DetectorParams& params) {
  std::vector<ParameterEntry> table = {
      {"disparity.matcher", &params.disparity.matcher, "", "elas, bm, sgbm or sgbm-wls"},
      {"detector.report_range_m", &params.report_range_m, "m", "obstacles are reported up to this distance of their rim"},
      {"detector.stills", &params.stills, "", "unrelated pictures: every candidate in range is an obstacle at once"},
  };
  append(table, elas_table(params.disparity.elas));
  append(table, bm_table(params.disparity.bm));
  append(table, sgbm_table(params.disparity.sgbm));
  append(table, ground_table(params.ground));
  append(table, candidates_table(params.candidates));
  return table;
}

}  // namespace brink
