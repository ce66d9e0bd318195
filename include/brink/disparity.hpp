#pragma once

#include <memory>
#include <string>

#include <opencv2/core.hpp>

#include "brink/frame.hpp"

namespace brink {

/// Parameters of ELAS (Geiger, Roser, Urtasun, ACCV 2010); defaults are what measured best, close to the paper's "robotics"
/// setting. docs/algorithm.md lists every deviation.
struct ElasParams {
  int min_disparity = 0;               ///< px, smallest disparity of support points
  int max_disparity = 255;             ///< px, largest disparity tried (inclusive)
  double support_threshold = 0.85;     ///< best cost of a support point must be below this times the second best
  int support_exclusion_px = 2;        ///< disparities this near to the best do not count as second best
  int support_texture = 10;            ///< least texture (sum of 16 gradient magnitudes) of a support point
  int candidate_step_px = 5;           ///< grid step of support candidates
  int inconsistency_window = 5;        ///< half window of the consistency test, grid cells
  int inconsistency_threshold_px = 5;  ///< two support points agree up to this difference
  int inconsistency_min_support = 8;   ///< least number of agreeing support points (the point itself counts)
  bool add_corners = false;            ///< support points in the image corners, and extrapolation to the borders
  int grid_size_px = 20;               ///< cell size of the disparity candidates taken from nearby support points
  bool match_outside = true;           ///< pixels outside all triangles are matched among those candidates alone
  double beta = 0.02;                  ///< weight of the likelihood
  double gamma = 3.0;                  ///< constant of the prior
  double sigma_px = 1.0;               ///< standard deviation of the prior
  double prior_radius = 2.0;           ///< range around the prior's plane that is searched, in sigmas
  int match_texture = 8;               ///< least mean texture around a pixel for dense matching
  int texture_radius_px = 4;           ///< half window of that mean
  double match_margin = 0.04;          ///< least energy must be below (1 - margin) times that of any disparity further than
                                       ///< 1 px away; 0 = no test
  int consistency_threshold_px = 2;    ///< left-right tolerance, support and dense
  double speckle_similarity_px = 1.0;  ///< neighbours closer than this belong to one segment
  int speckle_size_px = 200;           ///< smaller segments are removed
  int gap_width_px = 5;                ///< longest gap that is interpolated
  bool fill_across_steps = false;      ///< gaps between two surfaces are filled as well, with the farther one's disparity
  bool filter_median = false;          ///< 7-tap separable median
  bool filter_adaptive_mean = true;    ///< edge-preserving mean
  bool subpixel = true;                ///< refine each disparity below one pixel

  static ElasParams robotics();    ///< the defaults
  static ElasParams middlebury();  ///< dense: fills gaps and borders
  static ElasParams paper();       ///< robotics as the reference does it: whole pixels, no margin test

  /// @throws std::invalid_argument "elas.name = value, must be ..."
  void validate() const;
};

/// Parameters of OpenCV's StereoBM.
struct BmParams {
  int max_disparity = 255;           ///< px, inclusive
  int block_size_px = 15;            ///< odd, 5..51
  int texture_threshold = 10;        ///< least texture of a block
  int uniqueness_percent = 15;       ///< best cost must win by this much
  int consistency_threshold_px = 1;  ///< left-right tolerance
  int speckle_size_px = 200;         ///< smaller segments are removed
  int speckle_range_px = 2;          ///< disparity difference inside one segment
  void validate() const;             ///< @throws std::invalid_argument "bm.name = value, must be ..."
};

/// Parameters of OpenCV's StereoSGBM (MODE_SGBM_3WAY), used by `sgbm` and `sgbm-wls`.
struct SgbmParams {
  int max_disparity = 255;           ///< px, inclusive
  int block_size_px = 5;             ///< odd, 1..11
  int uniqueness_percent = 15;       ///< best cost must win by this much
  int consistency_threshold_px = 1;  ///< left-right tolerance
  int speckle_size_px = 200;         ///< smaller segments are removed
  int speckle_range_px = 1;          ///< disparity difference inside one segment
  double wls_lambda = 100.0;         ///< smoothness of the weighted-least-squares filter (`sgbm-wls`)
  double wls_sigma = 1.5;            ///< its sensitivity to image edges
  void validate() const;             ///< @throws std::invalid_argument "sgbm.name = value, must be ..."
};

/// Which program computes the disparities.
enum class Matcher { elas, bm, sgbm, sgbm_wls };

/// "elas", "bm", "sgbm", "sgbm-wls".
std::string to_string(Matcher matcher);
/// @throws std::invalid_argument "matcher = text, must be ..."
Matcher matcher_from_string(const std::string& text);

/// Section III.C.1: everything that turns a rectified pair into a disparity image.
struct DisparityParams {
  Matcher matcher = Matcher::elas;
  ElasParams elas;
  BmParams bm;
  SgbmParams sgbm;
  void validate() const;  ///< of the parts in use @throws std::invalid_argument
};

/// A dense stereo matcher. An object only keeps scratch memory: the result depends on nothing but the two pictures and the
/// parameters, and is the same for any number of threads.
class StereoMatcher {
 public:
  StereoMatcher() = default;
  StereoMatcher(const StereoMatcher&) = delete;
  StereoMatcher& operator=(const StereoMatcher&) = delete;
  virtual ~StereoMatcher() = default;

  /// @param left,right rectified grey pictures of one size.
  /// @return disparities of the left picture, px, or kInvalidDisparity where none can be told: occlusions, borders, surfaces
  ///         without texture. All invalid when the pictures are too small or have too little texture. Empty for empty pictures.
  /// @throws std::invalid_argument when the sizes differ.
  [[nodiscard]] virtual cv::Mat1f compute(const cv::Mat1b& left, const cv::Mat1b& right) = 0;
};

/// @throws std::invalid_argument when the parameters are not valid.
std::unique_ptr<StereoMatcher> make_stereo_matcher(const DisparityParams& params);

/// One call: make_stereo_matcher(params)->compute(left, right).
cv::Mat1f compute_disparity(const cv::Mat1b& left, const cv::Mat1b& right, const DisparityParams& params = {});

}  // namespace brink
