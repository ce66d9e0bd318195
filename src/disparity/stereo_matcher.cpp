#include <array>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "brink/disparity.hpp"
#include "disparity/elas.hpp"
#include "disparity/opencv_matchers.hpp"
#include "disparity/parameters.hpp"

namespace brink {
namespace {

constexpr std::array<std::pair<Matcher, const char*>, 4> kMatcherNames = {{
    {Matcher::elas, "elas"},
    {Matcher::bm, "bm"},
    {Matcher::sgbm, "sgbm"},
    {Matcher::sgbm_wls, "sgbm-wls"},
}};

}  // namespace

ElasParams ElasParams::robotics() { return {}; }

ElasParams ElasParams::middlebury() {
  ElasParams params;
  params.support_threshold = 0.95;
  params.add_corners = true;
  params.gamma = 5.0;
  params.prior_radius = 3.0;
  params.match_texture = 0;
  params.match_margin = 0.0;
  params.gap_width_px = 5000;
  params.fill_across_steps = true;
  params.filter_median = true;
  params.filter_adaptive_mean = false;
  return params;
}

ElasParams ElasParams::paper() {
  ElasParams params;
  params.support_exclusion_px = 0;
  params.inconsistency_min_support = 5;
  params.match_outside = false;
  params.match_texture = 1;
  params.texture_radius_px = 0;
  params.match_margin = 0.0;
  params.gap_width_px = 3;
  params.fill_across_steps = true;
  params.subpixel = false;
  return params;
}

void ElasParams::validate() const {
  require_between("elas.min_disparity", min_disparity, 0, kLargestDisparity);
  require_between("elas.max_disparity", max_disparity, min_disparity, kLargestDisparity);
  require_parameter(support_threshold > 0.0 && support_threshold <= 1.0, "elas.support_threshold", support_threshold,
                    "above 0, at most 1");
  require_between("elas.support_exclusion_px", support_exclusion_px, 0, kLargestDisparity);
  require_between("elas.support_texture", support_texture, 0, 2048);
  require_between("elas.candidate_step_px", candidate_step_px, 1, 100);
  require_between("elas.inconsistency_window", inconsistency_window, 0, 100);
  require_between("elas.inconsistency_threshold_px", inconsistency_threshold_px, 0, kLargestDisparity);
  require_between("elas.inconsistency_min_support", inconsistency_min_support, 0, 10000);
  require_between("elas.grid_size_px", grid_size_px, 1, 10000);
  require_between("elas.beta", beta, 1e-6, 1e6);
  require_between("elas.gamma", gamma, 1e-6, 1e6);
  require_between("elas.sigma_px", sigma_px, 0.01, 100.0);
  require_between("elas.prior_radius", prior_radius, 0.0, 100.0);
  require_between("elas.match_texture", match_texture, 0, 2048);
  require_between("elas.texture_radius_px", texture_radius_px, 0, 100);
  require_parameter(match_margin >= 0.0 && match_margin < 1.0, "elas.match_margin", match_margin, "at least 0, below 1");
  require_between("elas.consistency_threshold_px", consistency_threshold_px, 0, kLargestDisparity);
  require_between("elas.speckle_similarity_px", speckle_similarity_px, 0.0, 1e6);
  require_between("elas.speckle_size_px", speckle_size_px, 0, 1000000000);
  require_between("elas.gap_width_px", gap_width_px, 0, 1000000);
}

std::string to_string(Matcher matcher) {
  for (const auto& [value, name] : kMatcherNames) {
    if (value == matcher) return name;
  }
  throw std::invalid_argument(fmt::format("matcher = {}, must be a value of brink::Matcher", static_cast<int>(matcher)));
}

Matcher matcher_from_string(const std::string& text) {
  for (const auto& [value, name] : kMatcherNames) {
    if (text == name) return value;
  }
  throw std::invalid_argument(fmt::format("matcher = {}, must be elas, bm, sgbm or sgbm-wls", text));
}

void DisparityParams::validate() const {
  if (matcher == Matcher::elas) elas.validate();
  if (matcher == Matcher::bm) bm.validate();
  if (matcher == Matcher::sgbm || matcher == Matcher::sgbm_wls) sgbm.validate();
}

std::unique_ptr<StereoMatcher> make_stereo_matcher(const DisparityParams& params) {
  switch (params.matcher) {
    case Matcher::elas:
      return make_elas_matcher(params.elas);
    case Matcher::bm:
      return make_bm_matcher(params.bm);
    case Matcher::sgbm:
      return make_sgbm_matcher(params.sgbm);
    case Matcher::sgbm_wls:
      return make_sgbm_wls_matcher(params.sgbm);
  }
  throw std::invalid_argument(fmt::format("matcher = {}, must be a value of brink::Matcher", static_cast<int>(params.matcher)));
}

cv::Mat1f compute_disparity(const cv::Mat1b& left, const cv::Mat1b& right, const DisparityParams& params) {
  return make_stereo_matcher(params)->compute(left, right);
}

}  // namespace brink
