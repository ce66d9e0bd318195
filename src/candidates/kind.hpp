#pragma once

#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "brink/camera.hpp"
#include "brink/candidates.hpp"
#include "brink/ground.hpp"
#include "candidates/region.hpp"

namespace brink {

/// How much of a region's outer border is ground, as far as it is in the picture: 1 = ground all around.
/// @param none 255 = no disparity. @param elevation over the ground, m, NaN = none. Both of the picture's size.
/// @param gap_px without disparity that are crossed, at most; what is behind a wider gap is not known to be ground.
/// @param lowest_m, highest_m heights of what is ground.
/// @return share of the pixels beside the border, 0 to 1; empty when these are fewer than 20.
std::optional<double> compute_ground_share(const Region& region, const cv::Mat1b& none, const cv::Mat1f& elevation, int gap_px,
                                           double lowest_m, double highest_m);

/// The longer side of the smallest rectangle around an opening, seen from above, m; 0 without points.
double compute_opening_length_m(const std::vector<Eigen::Vector3d>& rim, const GroundPose& pose);

/// What a candidate is, by its shape (docs/algorithm.md); it depends on nothing but the arguments.
/// @param candidate made of that region, with its rim and depth. @param none as above. @param disparity px. @param elevation as
/// above.
ObstacleKind tell_kind(const Candidate& candidate, const Region& region, const cv::Mat1b& none, const cv::Mat1f& disparity,
                       const cv::Mat1f& elevation, const StereoCamera& camera, const GroundPose& pose,
                       const CandidateParams& params);

}  // namespace brink
