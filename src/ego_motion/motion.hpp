#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "brink/camera.hpp"
#include "brink/ego_motion.hpp"

namespace brink {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// A point and where both cameras see it now.
struct Observation {
  Eigen::Vector3d point;  ///< previous left camera frame, m
  Eigen::Vector4d pixel;  ///< column and row in the current left picture, then in the right one, px
  /// Derivative of the pixel, as the point predicts it, by a constant error of all disparities.
  Eigen::Vector4d by_offset = Eigen::Vector4d::Zero();
  Eigen::Matrix4d sqrt_information;  ///< the residual times this has unit covariance, if the noise is as expected
};

/// Column and row in the left picture, then in the right one, px. @param point left camera frame, z > 0.
Eigen::Vector4d project_stereo(const StereoCamera& camera, const Eigen::Vector3d& point);
/// Its derivative by the point.
Eigen::Matrix<double, 4, 3> project_stereo_jacobian(const StereoCamera& camera, const Eigen::Vector3d& point);

/// Expected noise of an observation: that of the current pixels, and that of the point's own disparity as it shows in them.
/// @param pixel_covariance of Observation::pixel, px^2. @param disparity_variance of the point, px^2.
/// @param by_disparity derivative of Observation::pixel by the point's disparity.
/// @return what Observation::sqrt_information holds.
Eigen::Matrix4d compute_sqrt_information(const Eigen::Matrix4d& pixel_covariance, double disparity_variance,
                                         const Eigen::Vector4d& by_disparity);

/// Weighted length of the reprojection error (equation 1); infinite behind the camera.
double compute_error(const Observation& observation, const StereoCamera& camera,
                     const Eigen::Isometry3d& current_from_previous);

/// A motion and how well it is known.
struct MotionFit {
  Eigen::Isometry3d current_from_previous = Eigen::Isometry3d::Identity();
  /// Of (w, t): the true motion is p -> exp(w) R p + translation + t. As expected from the observations' noise.
  Matrix6d covariance = Matrix6d::Zero();
  double offset = 0.0;           ///< to be added to all disparities, px
  double offset_variance = 0.0;  ///< px^2
};

/// Gauss-Newton on equation 1: the motion that minimises the reprojection errors in both pictures, each weighted by its
/// expected noise and by Tukey's function.
/// @param offset_variance how well it is known beforehand that disparities have no constant error, px^2; 0 = they have none.
/// @param cutoff errors from this on (in expected standard deviations) count nothing; infinity = plain least squares.
/// @return empty when it does not converge or the observations do not determine all six unknowns.
std::optional<MotionFit> fit_motion(const std::vector<Observation>& observations, const StereoCamera& camera,
                                    const Eigen::Isometry3d& initial, double cutoff, double offset_variance = 0.0);

/// Indices of observations with an error below the limit.
std::vector<int> find_inliers(const std::vector<Observation>& observations, const StereoCamera& camera,
                              const Eigen::Isometry3d& current_from_previous, double limit);

/// The motion that most observations agree with. @return empty with fewer than three observations, or when no sample gives a
/// motion.
std::optional<Eigen::Isometry3d> find_motion(const std::vector<Observation>& observations, const StereoCamera& camera,
                                             const Eigen::Isometry3d& initial, const EgoMotionParams& params);

}  // namespace brink
