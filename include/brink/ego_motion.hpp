#pragma once

#include <memory>
#include <optional>
#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "brink/frame.hpp"

namespace brink {

/// Defaults are what measured best (docs/algorithm.md). Pixels are those of the full picture unless said otherwise.
struct EgoMotionParams {
  int half_resolution_from_px = 400000;  ///< pictures of at least this many pixels are searched for features at half size
  int feature_radius_px = 3;             ///< no stronger feature within this distance, px of the searched picture
  int min_response = 30;                 ///< least |filter response| of a feature
  int feature_bucket_px = 40;            ///< of each square of this size ...
  int features_per_bucket = 12;          ///< ... so many of the strongest features are kept
  double search_deg = 5.0;               ///< half window around the predicted place
  double wide_search_deg = 16.0;         ///< half window where nothing is predicted, or that prediction was wrong
  double max_disparity_px = 255.0;       ///< greatest disparity of a feature
  double row_tolerance_px = 1.5;         ///< difference of rows between left and right
  int max_match_cost = 1200;             ///< greatest difference of two descriptors, 0 .. 8160
  double match_ratio = 0.85;             ///< the best match must cost less than this times the second best
  double neighbour_radius_px = 60.0;     ///< matches within this distance are compared
  double neighbour_tolerance_px = 4.0;   ///< they agree when flow and disparity differ by less than this ...
  double neighbour_tolerance = 0.1;      ///< ... plus this share of their distance: flow changes over slanted ground
  int neighbour_support = 2;             ///< agreeing neighbours that a match needs
  double bucket_px = 50.0;               ///< of each square of this size ...
  int matches_per_bucket = 3;            ///< ... so many of the best matches are kept
  double match_noise_px = 0.4;           ///< standard deviation of a feature's place
  int ransac_iterations = 300;           ///< samples of three matches at most
  int seed = 1;                          ///< of these samples
  double inlier_sigmas = 4.0;            ///< error of an inlier, expected standard deviations
  int min_inliers = 12;                  ///< fewer give no motion
  double min_inlier_ratio = 0.35;        ///< inliers among the matches, less give no motion
  int keyframes = 4;                     ///< older frames that motions are measured against
  int keyframe_points = 400;             ///< most points of one
  double keyframe_overlap = 0.8;         ///< a new one is made when a smaller share of the newest one's points is seen
  double slope_radius_px = 40.0;         ///< a surface's slope is fitted to points this near
  double disparity_offset_sd_px = 0.02;  ///< constant error of disparities that rectification may leave, estimated; 0 = none
  double max_error_scale = 6.0;          ///< errors larger than expected by this factor give no motion: eyes out of step
  double max_translation_sd_m = 0.2;     ///< a motion known worse than this is none, standard deviation in any direction
  double max_rotation_sd_deg = 2.0;      ///< likewise
  double gyroscope_tolerance_deg = 3.0;  ///< a motion whose rotation differs more from the gyroscope's is none
  double turn_jerk_deg = 3000.0;         ///< velocity filter: change of angular acceleration, degrees/s^3
  double jerk_m = 60.0;                  ///< velocity filter: change of acceleration, m/s^3

  void validate() const;  ///< @throws std::invalid_argument "ego_motion.name = value, must be ..."
};

/// How the camera moved from one frame to the next, with its evidence.
struct EgoMotion {
  Eigen::Isometry3d current_from_previous = Eigen::Isometry3d::Identity();  ///< measured, left camera frames, m
  Eigen::Matrix<double, 6, 6> covariance =
      Eigen::Matrix<double, 6, 6>::Zero();  ///< of (w rad, t m): the true motion turns by exp(w) R and moves by translation + t
};

/// How fast the scene moves in the camera's frame, smoothed by a Kalman filter that assumes constant acceleration.
struct EgoVelocity {
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();     ///< rad/s
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  ///< m/s
};

/// What one frame told of the motion.
struct EgoMotionEstimate {
  std::optional<EgoMotion> motion;      ///< empty when it cannot be told: never yesterday's motion
  std::string reason;                   ///< why motion is empty; empty otherwise
  std::optional<EgoVelocity> velocity;  ///< empty when motion is, or time does not advance
  int matches = 0;  ///< points of earlier frames that were found in both pictures, or left picture and disparity, of this one
  int inliers = 0;  ///< of those, that agree with the motion
};

/// Section III.C.4, stereo odometry: features, circular matching over previous/current x left/right, RANSAC and Gauss-Newton
/// on the reprojection error in both pictures (equation 1), velocity Kalman filter. Remembers the last frames. Where a frame
/// has a disparity image instead of a right picture, it tells where the right picture would show a point.
class EgoMotionEstimator {
 public:
  /// @throws std::invalid_argument when the parameters are not valid.
  explicit EgoMotionEstimator(const EgoMotionParams& params = {});
  ~EgoMotionEstimator();
  EgoMotionEstimator(EgoMotionEstimator&&) noexcept;
  EgoMotionEstimator& operator=(EgoMotionEstimator&&) noexcept;

  /// The motion from the frame of the last call into this one; empty with the reason "first frame" the first time, and without
  /// a left picture, after which the next frame is the first again.
  /// @throws std::invalid_argument when the frame is not one that make_frame would return.
  [[nodiscard]] EgoMotionEstimate estimate(const Frame& frame);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace brink
