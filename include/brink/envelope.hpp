#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "brink/camera.hpp"
#include "brink/candidates.hpp"
#include "brink/ground.hpp"

// Our own (docs/algorithm.md, "The envelope"): which drops a camera can show to the rules of Type 1 at all. An ideal picture of
// a drop is made, and the rules themselves decide. Light, texture and what stands in the way are not in it.
namespace brink {

/// Where a camera stands, and how sure its disparities are.
struct Viewpoint {
  StereoCamera camera;
  cv::Size size;               ///< of its pictures, px
  GroundSurface ground;        ///< level, with disparity_sd_px and roughness_px of what is seen on it
  double max_disparity = 255;  ///< px, largest one that is matched
};

struct ViewpointParams {
  double height_m = 1.6;         ///< of the camera over the ground
  double pitch_deg = 25.0;       ///< positive = looking down
  double roll_deg = 0.0;         ///< positive = head tilted to the right
  double disparity_sd_px = 0.1;  ///< standard deviation of a single disparity: 0.1 in daylight, 0.3 at dusk, at 640x360 px
};

/// @throws std::invalid_argument "name = value, must be ..." unless the camera is valid, the size at least 32x32 px, height_m
///         above 0 to 100, pitch_deg and roll_deg above -90 to below 90, disparity_sd_px 0.001 to 100.
Viewpoint make_viewpoint(const StereoCamera& camera, const cv::Size& size, const ViewpointParams& params = {});

/// An opening in the ground with upright walls and a level bottom.
struct Drop {
  std::vector<Eigen::Vector2d> rim;  ///< polygon on the ground, m: right and forward of the foot of the camera's perpendicular
  double depth_m = 0.0;              ///< of the bottom
};

/// Opening of a drop straight ahead. A platform's edge is long and wide: kOpenEnded.
struct DropShape {
  double length_m = 1.0;  ///< along the line of sight
  double width_m = 1.0;   ///< across
};
inline constexpr double kOpenEnded = 1000.0;  ///< m: farther than anything is seen

/// @throws std::invalid_argument unless all lengths are above 0, at most kOpenEnded.
Drop make_drop(double distance_m, double depth_m, const DropShape& shape);

/// The disparities of a drop in level ground without any noise. Behind a near rim at D the ray meets the bottom of a drop of
/// depth e at D (1 + e / h), unless the opening ends before: then it meets the wall there.
/// @return px; kInvalidDisparity at and above the horizon, outside the right picture, and above viewpoint.max_disparity.
cv::Mat1f compute_drop_disparity(const Drop& drop, const Viewpoint& viewpoint);

/// Whether the rules see a drop.
struct DropSighting {
  double deepest_m = 0.0;  ///< how far down one sees through the opening; 0 = it is not in the picture
  /// Empty = seen. Else what it fails: "picture" (no pixel shows it), "range" (farther than candidates are looked for, m),
  /// "depth" (nothing that shows is far enough below the ground, or too little to be listed; value and limit in metres),
  /// or the rule of Rejection that its largest region fails.
  std::optional<Rejection> rejection;
};

/// Where nothing stands before a drop and before the ground around it: 255, size of the picture. Empty = everywhere. Elsewhere
/// there is no disparity.
struct Shown {
  cv::Mat1b drop;
  cv::Mat1b ground;
};

/// @throws std::invalid_argument when the rim has fewer than 3 points, depth_m is not above 0, params are not valid, or sizes
///         differ.
DropSighting compute_sighting(const Drop& drop, const Viewpoint& viewpoint, const CandidateParams& params = {},
                              const Shown& shown = {});

/// The smallest depth, of 2 cm to 3 m, from which a drop at a distance is seen, to 5 mm. Empty when none is.
/// @throws std::invalid_argument as make_drop and compute_sighting do.
std::optional<double> estimate_smallest_depth(double distance_m, const DropShape& shape, const Viewpoint& viewpoint,
                                              const CandidateParams& params = {});

/// The smallest drop that is seen at a distance.
struct EnvelopePoint {
  double distance_m = 0.0;
  std::optional<double> smallest_depth_m;  ///< empty when none is seen
};
/// estimate_smallest_depth at each of some distances.
std::vector<EnvelopePoint> compute_envelope(const std::vector<double>& distances_m, const DropShape& shape,
                                            const Viewpoint& viewpoint, const CandidateParams& params = {});

/// The largest distance of the rim, up to params.max_range_m, at which a drop is seen, to 1 cm. Empty when it is seen nowhere.
/// @throws std::invalid_argument as make_drop and compute_sighting do.
std::optional<double> estimate_largest_distance(double depth_m, const DropShape& shape, const Viewpoint& viewpoint,
                                                const CandidateParams& params = {});

}  // namespace brink
