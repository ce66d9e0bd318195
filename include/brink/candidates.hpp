#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "brink/frame.hpp"
#include "brink/ground.hpp"

namespace brink {

/// The paper's two ways in which a negative obstacle shows.
enum class CandidateType : std::uint8_t {
  below_ground,  ///< Type 1: disparities that lie below the ground next to them
  no_disparity,  ///< Type 2: black and uniform, nothing can be matched
};
std::string to_string(CandidateType type);

/// Our own: what a negative obstacle is, as far as its shape tells.
enum class ObstacleKind : std::uint8_t {
  unknown,      ///< not enough of it is seen, or it is none of these
  stairs_down,  ///< its floor falls away from the rim, one step after the other
  edge,         ///< a long rim behind which the ground does not go on: platforms, kerbs
  hole,         ///< ground around it on all sides
};
std::string to_string(ObstacleKind kind);

struct CandidateParams {
  double ground_tolerance_m = 0.10;   ///< T_g: a pixel nearer to the ground than this is a ground pixel
  double min_depth_m = 0.15;          ///< T_e1: Type 1 lies at least this far below the ground
  double measured_depth_ratio = 0.9;  ///< ... and may measure this share of it, where that is more than ground_tolerance_m
  double rim_depth_ratio = 0.4;       ///< Type 1 is drawn out to where the surface is this share of min_depth_m down; 1 = not
  double min_slope_deg = 10.0;        ///< Type 1: a quarter of its rim must be steeper than a slope that people walk; 0 = any
  double max_share_beyond = 0.5;  ///< Type 1: at most this share of it may lie beyond its far rim, as mirrors show it; 1 = all
  double max_roughness = 2.2;     ///< Type 1: its disparities may scatter this many times as much as the ground's; 0 = any
  double min_agreement = 0.1;     ///< Type 1: correlation that three quarters of its windows reach, at least; 0 = no test
  double min_ground_misfit = 0.08;    ///< Type 1: the ground must explain the pictures worse by this share; 0 = no test
  double max_share_standing = 0.5;    ///< Type 2: at most this share of its border may stand above the ground; 1 = no test
  int touching_gap_px = 12;           ///< pixels without disparity between a region and what it touches, at most
  double min_sigmas = 6.0;            ///< Type 1 lies this many standard deviations of a single pixel below the ground; 0 = any
  int below_ground_min_area_px = 60;  ///< T_a1: area must be greater
  double below_ground_min_msr = 0.306;  ///< ... and so must this solid angle: the paper's 150 px at its focal length, 700 px
  int no_disparity_min_area_px = 150;   ///< T_a2: area must be greater
  int min_touching_px = 5;              ///< pixels of the other kind in the 1-px ring that count as touching
  double black_share = 0.33;    ///< Type 2: mean colour at most this share of the ground's brightness around it (0 = not),
  double black_level = 20.0;    ///< ... or at most this; mean colour is the maximum of B, G, R (or mean grey)
  bool black_by_median = true;  ///< ... or the brightness that half of its pixels do not exceed is
  int border_px = 10;           ///< Type 2 is looked for only where both cameras see the ground, this far from their edges
  double merge_gap_m = 0.3;     ///< parts of one drop this near to each other, behind a handrail, are one candidate; 0 = never
  double max_range_m = 8.0;     ///< candidates are looked for up to this distance in the ground plane
  bool tell_kind = true;        ///< tell what a candidate is by its shape; false = all are unknown
  int min_listed_area_px = 30;  ///< smaller regions are specks: not even listed as rejected

  /// Without what brink adds: below_ground_min_area_px 150, below_ground_min_msr 0, black_share 0, black_by_median false,
  /// measured_depth_ratio 1, rim_depth_ratio 1, min_slope_deg 0, min_sigmas 0, max_share_beyond 1, max_roughness 0,
  /// min_agreement 0, min_ground_misfit 0, max_share_standing 1, touching_gap_px 0, border_px 0, merge_gap_m 0, tell_kind
  /// false.
  static CandidateParams paper();
  void validate() const;  ///< @throws std::invalid_argument "candidates.name = value, must be ..."
};

/// The rule that a region failed, with its value and its limit. All in the unit that the rule's parameter has.
struct Rejection {
  std::string rule;  ///< "area", "touches_valid", "touches_ground", "slope", "beyond_rim", "rough", "disagree", "like_ground",
                     ///< "black", "standing", "contour"
  double value = 0.0;
  double limit = 0.0;
};

/// What the rules measured of a region, for and against it.
struct Measures {
  double solid_angle_msr = 0.0;  ///< that it takes of the view: its pixels over the squared focal length, 1e-3 sr
  double sigmas = 0.0;           ///< Type 1: half of its deep part lies at least so many standard deviations below the ground
  double ground_misfit = 0.0;    ///< Type 1: by what share the ground explains the pictures worse, 0..1
  double roughness = 0.0;        ///< Type 1: scatter of its disparities in that of the ground
  double agreement = 0.0;        ///< Type 1: of both pictures about it, -1..1
  double slope_deg = 0.0;        ///< Type 1: at its rim
  double share_beyond = 0.0;     ///< Type 1: what of it lies beyond its far rim
  double ground_share = 0.0;     ///< of its border with a disparity: at the height of the ground
  double standing_share = 0.0;   ///< of its border with a disparity: above the ground
};

/// A region that may be a negative obstacle. Points in the left camera frame, m.
struct Candidate {
  CandidateType type = CandidateType::below_ground;
  ObstacleKind kind = ObstacleKind::unknown;              ///< of accepted ones, with tell_kind; else unknown
  std::vector<CandidateType> types;                       ///< of the parts it was merged from, each once; empty = one part
  int area_px = 0;                                        ///< pixels of the region (Type 2: before dilation)
  std::vector<cv::Point> contour;                         ///< outer contour (Type 2: of the dilated region), closed, px
  std::vector<Eigen::Vector3d> contour_3d;                ///< those contour points that have a disparity
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();     ///< mean of contour_3d
  Eigen::Vector3d nearest = Eigen::Vector3d::Zero();      ///< point of contour_3d nearest to the camera (the paper's output)
  Eigen::Vector3d rim_nearest = Eigen::Vector3d::Zero();  ///< nearest point of the edge on the ground's side
  std::vector<Eigen::Vector3d> rim;                       ///< the rim, where the rays of the outline meet the ground
  double distance_m = 0.0;                                ///< of rim_nearest, in the ground plane
  double bearing_deg = 0.0;                               ///< of rim_nearest, positive right
  std::optional<double> depth_m;                          ///< below the ground, > 0; empty for Type 2: its bottom is not seen
  double width_m = 0.0;                ///< extent of the opening across the line of sight, in the ground plane
  Measures measures;                   ///< those whose rule is in use; of a merged one the larger part's
  cv::Scalar mean_color;               ///< B, G, R of the left picture (grey pictures: three times grey; none: 0)
  std::optional<Rejection> rejection;  ///< empty = candidate; the first rule that failed otherwise
};

/// Section III.C.3, Type 1: 8-connected regions of valid pixels that lie min_depth_m below the ground, or measured_depth_ratio
/// of it, and min_sigmas of the noise on the ground; drawn out to their rim. Rims lie on `ground`.
/// @param elevation over the ground, m, NaN = none. @param disparity px. Both of frame.size().
/// @return accepted and rejected regions, in the order of their first pixel row by row; empty when there is none.
/// @throws std::invalid_argument when sizes differ or parameters are not valid.
std::vector<Candidate> select_below_ground(const Frame& frame, const cv::Mat1f& disparity, const cv::Mat1f& elevation,
                                           const GroundSurface& ground, const CandidateParams& params = {});

/// Section III.C.3, Type 2: 8-connected regions of invalid pixels below the ground's horizon and within range, where both
/// cameras see the ground, black. Arguments, order and errors as for select_below_ground; none without a left picture, as
/// black cannot be told.
std::vector<Candidate> select_no_disparity(const Frame& frame, const cv::Mat1f& disparity, const cv::Mat1f& elevation,
                                           const GroundSurface& ground, const CandidateParams& params = {});

/// Our own (docs/algorithm.md): one hole, one obstacle. Parts of one drop, split by a handrail or by what of it is black,
/// become one candidate: between them, over less than merge_gap_m, there is no ground to be seen. The larger part's type is
/// told; the contour is one outline around all parts, bridged by a line.
/// @param candidates accepted ones of both types. @param elevation as for select_below_ground.
/// @return in the order of the first part of each. @throws std::invalid_argument when parameters are not valid.
std::vector<Candidate> merge_parts(std::vector<Candidate> candidates, const cv::Mat1f& elevation, const GroundPose& pose,
                                   const StereoCamera& camera, const CandidateParams& params = {});

/// Extent of an opening across the line of sight to its middle, in the ground plane, m; 0 without points.
double compute_width(const std::vector<Eigen::Vector3d>& rim, const GroundPose& pose);

}  // namespace brink
