#pragma once

#include <memory>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "brink/camera.hpp"
#include "brink/ground.hpp"

namespace brink {

/// What is known of the camera's motion from the last frame into this one, without looking at the ground.
struct MotionHint {
  std::optional<Eigen::Isometry3d> current_from_previous;         ///< left camera frames, m; empty when it is not known
  std::optional<Eigen::Matrix3d> current_from_previous_rotation;  ///< from a gyroscope; used where the motion is not known
};

/// Our own (docs/algorithm.md, "The ground is what you stand on"): the surface under the bearer's feet, from frame to frame.
///
/// One frame alone shows planes, but not which of them the bearer stands on: right before an edge the lower floor fills more of
/// the image than the upper one. Three things decide it, none of which depends on how many pixels a plane has:
/// the last ground moved by the camera's motion; the *standing height*, which stays the same within gait and crouching; and the
/// *footing*, the heights of surfaces seen earlier at the place where the feet are now.
class GroundTracker {
 public:
  /// @throws std::invalid_argument when the parameters are not valid.
  explicit GroundTracker(const GroundParams& params = {});
  ~GroundTracker();
  GroundTracker(GroundTracker&&) noexcept;
  GroundTracker& operator=(GroundTracker&&) noexcept;

  /// First half, which needs no motion and so can run beside its estimation: the planes that this frame shows.
  /// @param disparity px, kInvalidDisparity where there is none; must live until update().
  /// @param gravity direction of gravity in the left camera frame, if known: no plane that is tilted more than
  ///        GroundParams::gravity_tolerance_deg against it is considered.
  /// @throws std::invalid_argument when the camera is not valid, or gravity is not a finite non-zero vector.
  void search(const cv::Mat1f& disparity, const StereoCamera& camera,
              const std::optional<Eigen::Vector3d>& gravity = std::nullopt);

  /// Second half: which of them is the ground.
  /// @param motion from the last frame for which this was called.
  /// @param time s. @return state `seen` when this frame shows the ground; `uncertain` when it is carried on from earlier
  /// frames
  ///         by the camera's motion, or when it could not be determined which of two surfaces is the ground (both heights are
  ///         in the reason); `not_visible`, without a plane, when there is no plausible plane and none to carry on.
  GroundEstimate update(const MotionHint& motion, double time);

  /// Camera height over the ground that its bearer stands on, m; empty before it is known.
  [[nodiscard]] std::optional<double> standing_height_m() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The ground of a frame without a past, for stills: as GroundTracker finds it in its first frame.
/// Arguments and errors as for estimate_ground.
GroundEstimate find_ground(const cv::Mat1f& disparity, const StereoCamera& camera, const GroundParams& params = {},
                           const std::optional<Eigen::Vector3d>& gravity = std::nullopt);

}  // namespace brink
