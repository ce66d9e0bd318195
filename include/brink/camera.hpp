#pragma once

#include <Eigen/Core>

namespace brink {

/// A rectified stereo pair: equal, square-pixel pinhole cameras, displaced along x only.
///
/// Camera frame of the left camera: x right, y down, z forward, metres. Image: u = column, v = row, pixels, (0, 0) is the
/// centre of the top left pixel. Disparity d = u_left - u_right, pixels, >= 0.
struct StereoCamera {
  double focal = 0.0;     ///< focal length, px
  double cx = 0.0;        ///< principal point, column, px
  double cy = 0.0;        ///< principal point, row, px
  double baseline = 0.0;  ///< distance of the right camera from the left one, m

  /// Checks the four numbers.
  /// @throws std::invalid_argument "name = value, must be ..." unless all are finite, focal in [1, 1e6] px, |cx| and |cy| <=
  ///         1e6 px, baseline in [0.001, 10] m (a larger one is nearly always in millimetres).
  void validate() const;

  /// Equation 2 of the paper: z = f b / d, x = (u - cx) z / f, y = (v - cy) z / f.
  /// @param disparity px, > 0; for 0 the point is at infinity (components are infinite or NaN).
  /// @return position in the left camera frame, m.
  [[nodiscard]] Eigen::Vector3d triangulate(double u, double v, double disparity) const;

  /// The inverse of triangulate.
  /// @param point left camera frame, m, z > 0; for z <= 0 the point is not in view and the result has no meaning.
  /// @return (u, v, disparity), px.
  [[nodiscard]] Eigen::Vector3d project(const Eigen::Vector3d& point) const;
};

}  // namespace brink
