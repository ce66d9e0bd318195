#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace brink {

/// Poses of the left camera over time.
struct Trajectory {
  std::vector<double> times;  ///< s, ascending; empty when the file holds none (KITTI format)
  std::vector<Eigen::Isometry3d> world_from_camera;
};

/// Reads KITTI's format (12 numbers a line, row-major 3x4) or TUM's (t tx ty tz qx qy qz qw), told apart by the number of
/// columns. Lines that begin with # and empty ones are left out.
/// @throws std::runtime_error "file: line n ..." when a line is neither, mixes both, or is not a motion (NaN, a rotation matrix
///         that is none beyond 1e-3, a zero quaternion, times that do not increase), and when there is no pose at all.
///         Rotations within these limits are made exact ones.
Trajectory read_trajectory(const std::string& path);

/// The text of a trajectory in KITTI's format. Nine decimals.
std::string to_kitti(const Trajectory& trajectory);
/// The text in TUM's format. @throws std::invalid_argument when it has no times.
std::string to_tum(const Trajectory& trajectory);

/// A mean with the standard deviation around it.
struct MeanAndDeviation {
  double mean = 0.0;
  double deviation = 0.0;
};

/// How far an estimated trajectory is off.
struct TrajectoryErrors {
  int poses = 0;
  double length_m = 0.0;  ///< of the true path
  // The paper's: over all frames, ||R_true - R_est||_F and ||t_true - t_est||, m. Both start at the identity.
  MeanAndDeviation rotation;            ///< of the accumulated pose
  MeanAndDeviation translation_m;       ///< of the accumulated pose
  MeanAndDeviation step_rotation;       ///< of the motion from frame to frame
  MeanAndDeviation step_translation_m;  ///< of the motion from frame to frame
  // KITTI's: mean over all segments of segment_m of what the motion along one is off, by its true length; empty when the path
  // is shorter.
  std::optional<double> segment_translation_percent;
  std::optional<double> segment_rotation_deg_per_m;
  int segments = 0;
  std::optional<double> end_error_percent;  ///< of the last position, of the path's length; empty when nothing moves
  double ate_rmse_m = 0.0;  ///< absolute trajectory error: positions after the best rigid alignment (Umeyama, no scale)
};

/// Compares two trajectories of the same frames.
/// @param segment_m length of KITTI's segments, m > 0; a segment starts at every frame.
/// @throws std::invalid_argument when the numbers of poses differ or are below 2, or segment_m is not positive.
TrajectoryErrors compute_trajectory_errors(const Trajectory& estimate, const Trajectory& truth, double segment_m);

}  // namespace brink
