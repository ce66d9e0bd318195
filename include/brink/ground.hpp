#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "brink/camera.hpp"

namespace brink {

/// A plane in disparity space (section III.C.2, with roll): d(u, v) = a u + b v + c, px.
struct GroundPlane {
  double a = 0.0;
  double b = 0.0;
  double c = 0.0;
  /// Disparity of the ground at a pixel, px; <= 0 at and above the horizon.
  [[nodiscard]] double disparity(double u, double v) const { return a * u + b * v + c; }
};

/// The same plane in metres: where the camera stands over the ground. Everything in the left camera frame.
struct GroundPose {
  double height_m = 0.0;                               ///< of the camera over the ground, along the ground's normal
  double pitch_deg = 0.0;                              ///< positive = looking down
  double roll_deg = 0.0;                               ///< positive = head tilted to the right
  Eigen::Vector3d down = Eigen::Vector3d::UnitY();     ///< ground normal, pointing into the ground
  Eigen::Vector3d forward = Eigen::Vector3d::UnitZ();  ///< optical axis laid onto the ground
  Eigen::Vector3d right = Eigen::Vector3d::UnitX();    ///< completes (right, down, forward)

  /// Height of a point over the ground, m, up positive.
  [[nodiscard]] double elevation(const Eigen::Vector3d& point) const;
  /// Distance in the ground plane from the foot of the camera's perpendicular, m.
  [[nodiscard]] double distance(const Eigen::Vector3d& point) const;
  /// Angle in the ground plane from `forward`, degrees, positive right.
  [[nodiscard]] double bearing_deg(const Eigen::Vector3d& point) const;
  /// Where the ray through a pixel meets the ground; empty at and above the horizon.
  [[nodiscard]] std::optional<Eigen::Vector3d> intersect(double u, double v, const StereoCamera& camera) const;
};

/// Plane to pose. @throws std::invalid_argument when the plane is not finite or a = b = c = 0.
GroundPose compute_ground_pose(const GroundPlane& plane, const StereoCamera& camera);
/// Pose to plane, from height, pitch and roll. @throws std::invalid_argument unless height_m > 0.
GroundPlane make_ground_plane(double height_m, double pitch_deg, double roll_deg, const StereoCamera& camera);
/// The same from height_m and down; the other members are not read. @throws std::invalid_argument unless height_m > 0.
GroundPlane make_ground_plane(const GroundPose& pose, const StereoCamera& camera);

/// The motion of a camera that stays over the same place of the ground and keeps its heading, while its height, pitch and roll
/// change from one pose to the other: what two grounds alone tell of current_from_previous.
Eigen::Isometry3d compute_ground_motion(const GroundPose& previous, const GroundPose& current);

/// What is known of the ground: told for every frame, because silence must never be a failure in disguise.
enum class GroundState : std::uint8_t { seen, uncertain, not_visible };
std::string to_string(GroundState state);

struct GroundParams {
  double min_height_m = 0.1;            ///< of the camera over the ground
  double max_height_m = 4.0;            ///< of the camera over the ground
  double min_pitch_deg = -10.0;         ///< looking up
  double max_pitch_deg = 80.0;          ///< looking down
  double max_roll_deg = 45.0;           ///< to either side
  double gravity_tolerance_deg = 20.0;  ///< slope of the ground and error of gravity, where gravity is known
  double max_range_m = 8.0;             ///< ground farther away than this takes no part
  double tolerance_ratio = 0.02;        ///< roughness: half width of the band counted as ground, share of the camera height
  double tolerance_px = 0.75;           ///< noise of disparities: that band is never narrower than this
  int ransac_iterations = 200;          ///< line hypotheses per roll angle
  int seed = 1;                         ///< of the random line hypotheses
  double seen_confidence = 0.5;         ///< confidence from which the ground counts as seen
  double uncertain_confidence = 0.25;   ///< confidence from which it counts as uncertain; not visible below
  bool track = true;               ///< the ground is what the bearer stands on (GroundTracker); false = the plane of each frame
  bool follow = true;              ///< follow the surface where it bends away from the plane: ramps, crests, crossfall
  double follow_slope_deg = 10.0;  ///< steepest surface that is followed
  double follow_cell_m = 0.2;      ///< the surface is followed in square cells of this size
  double follow_reach_m = 0.8;     ///< the slope must hold towards all of it that is this near
  double follow_extent_m = 1.0;    ///< smaller bends are none: shallow holes
  double follow_step_m = 0.06;     ///< nor is what begins with a higher step and is hardly higher beyond: kerbs
  static GroundParams paper();  ///< without what brink adds: track, follow false; heights 0.3 to 2.5 m, pitch to 60, roll to 25
  void validate() const;        ///< @throws std::invalid_argument "ground.name = value, must be ..."
};

/// Result of estimate_ground, with its evidence.
struct GroundEstimate {
  GroundState state = GroundState::not_visible;
  std::string reason;                ///< why the state is not `seen`; empty when it is
  double confidence = 0.0;           ///< 0..1, docs/algorithm.md
  std::optional<GroundPlane> plane;  ///< empty when and only when state is not_visible
  GroundPose pose;                   ///< of plane; without meaning when plane is empty
  double inlier_ratio = 0.0;         ///< share of the valid pixels below the horizon and in range that lie on the ground
  double residual_px = 0.0;          ///< robust standard deviation of the disparities on the ground
  bool is_carried = false;           ///< not measured in this frame, but carried on from earlier ones (GroundTracker)
};

/// Section III.C.2: the ground as the dominant line of the v-disparity histogram, the histogram being sheared to allow for
/// roll, refined to a plane by iteratively reweighted least squares (algorithms.md C.2).
/// @param disparity px, kInvalidDisparity where there is none.
/// @param gravity direction of gravity in the left camera frame, if known: narrows the search.
/// @param previous the ground of the last frame moved into this one, if known: one more hypothesis, which has to win like all
///        others, so that a wrong one cannot stick.
/// @return state not_visible when no plausible plane explains the lower picture; also for an empty or tiny picture.
/// @throws std::invalid_argument when camera or parameters are not valid, or gravity is not a finite non-zero vector.
GroundEstimate estimate_ground(const cv::Mat1f& disparity, const StereoCamera& camera, const GroundParams& params = {},
                               const std::optional<Eigen::Vector3d>& gravity = std::nullopt,
                               const std::optional<GroundPlane>& previous = std::nullopt);

/// Height of every valid pixel over the ground, m, along the ground's normal, up positive; NaN where the disparity is invalid
/// or 0.
cv::Mat1f compute_elevation(const cv::Mat1f& disparity, const GroundPlane& ground, const StereoCamera& camera);

/// Our own, after section III.C.2: the surface of the ground, its plane and, seen from above, how far the ground lies over or
/// under it.
struct GroundSurface {
  GroundPlane plane;
  GroundPose pose;               ///< of the plane
  double disparity_sd_px = 0.1;  ///< standard deviation of the disparities about it
  double roughness_px = 0.03;    ///< how far they scatter about planes of a few pixels
  double cell_m = 0.0;           ///< side of the cells of relief_m; without meaning when that is empty
  /// Height of the ground over the plane in square cells, m: rows go from the camera's foot along pose.forward, columns along
  /// pose.right, the foot in their middle. Outside, the nearest cell counts. Empty = the plane everywhere.
  cv::Mat1f relief_m;
  double lowest_m = 0.0;   ///< of relief_m
  double highest_m = 0.0;  ///< of relief_m

  /// Height of the ground over the plane below or above a point, m.
  [[nodiscard]] double relief(const Eigen::Vector3d& point) const;
  /// Where the ray through a pixel first meets the surface; empty at and above the plane's horizon.
  [[nodiscard]] std::optional<Eigen::Vector3d> intersect(double u, double v, const StereoCamera& camera) const;
};

/// A plane as a surface, with how sure the disparities on it are. The noise is told by the roughness, in which bends of the
/// ground take no part; as far as GroundEstimate::residual_px is more than that, up to twice, the surface is less sure.
/// @param ground with a plane. @param disparity px, kInvalidDisparity where there is none.
/// @throws std::invalid_argument when ground has no plane.
GroundSurface make_flat_surface(const GroundEstimate& ground, const cv::Mat1f& disparity, const StereoCamera& camera);

/// Our own (docs/algorithm.md): the ground's own surface instead of its plane. From where it lies on the plane it is followed,
/// seen from above, over slopes that people walk. A drop is steeper than these, also where it is seen along its own ray only,
/// and stays what it is. Where nothing was followed, the nearest followed place tells the height of the ground.
/// @param disparity px, kInvalidDisparity where there is none. @param flat from make_flat_surface.
/// @throws std::invalid_argument when parameters are not valid.
GroundSurface follow_ground(const cv::Mat1f& disparity, const GroundSurface& flat, const StereoCamera& camera,
                            const GroundParams& params = {});

/// Height of every valid pixel over the surface, m, up positive; NaN where the disparity is invalid or 0.
cv::Mat1f compute_elevation(const cv::Mat1f& disparity, const GroundSurface& ground, const StereoCamera& camera);

}  // namespace brink
