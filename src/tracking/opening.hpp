#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "brink/camera.hpp"

namespace brink {

/// The corners of the hull of an opening as it is seen from above: laid onto the camera's x-z plane, which is such a view but
/// for an affine map. In order around it; fewer than three points are no opening.
std::vector<Eigen::Vector3d> compute_hull(const std::vector<Eigen::Vector3d>& rim);

/// Whether half of one opening lies within the other, seen from above. @param a, b hulls.
bool overlap(const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b);

/// Points along the edges of a closed polygon, at most spacing_m apart.
std::vector<Eigen::Vector3d> sample_edges(const std::vector<Eigen::Vector3d>& polygon, double spacing_m);

/// Whether a point is seen in a picture.
bool is_in_view(const Eigen::Vector3d& point, const StereoCamera& camera, const cv::Size& size);

/// A hull as the camera sees it: the corners of a convex polygon within the picture, px; empty when nothing of it is in view.
std::vector<cv::Point> project_opening(const std::vector<Eigen::Vector3d>& hull, const StereoCamera& camera,
                                       const cv::Size& size);

}  // namespace brink
