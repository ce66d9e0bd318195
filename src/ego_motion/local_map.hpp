#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "brink/camera.hpp"
#include "brink/ego_motion.hpp"
#include "ego_motion/matching.hpp"
#include "ego_motion/motion.hpp"
#include "ego_motion/refinement.hpp"
#include "ego_motion/right_eye.hpp"

namespace brink {

/// A patch of a keyframe's left picture and the depth of the surface there.
struct MapPoint {
  Patch patch;
  double disparity = 0.0;                           ///< in the keyframe, px
  double variance = 0.0;                            ///< of disparity, px^2
  double row_offset = 0.0;                          ///< row in the right picture less that in the left one, px
  double row_variance = 0.0;                        ///< of row_offset, px^2
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();  ///< of the disparity over the patch, px per px in u and v
};

/// An older frame that still overlaps with what is seen now: motions measured against it do not add up their errors.
struct Keyframe {
  Eigen::Isometry3d frame_from_keyframe = Eigen::Isometry3d::Identity();  ///< frame: the last one seen
  std::vector<MapPoint> points;
  int inliers = 0;  ///< points that agreed with the last motion
};

/// A map point found in the current pair.
struct Sighting {
  std::size_t keyframe = 0;
  std::size_t point = 0;
  Observation observation;
  Eigen::Matrix4d pixel_covariance;  ///< of observation.pixel, px^2
  Eigen::Vector4d by_disparity;      ///< derivative of observation.pixel by the point's disparity
};

/// Keyframe at a frame: its stereo matches, aligned to a fraction of a pixel.
/// @param offset constant error of all columns in the right picture, px; the same below.
Keyframe make_keyframe(const SmoothPair& pictures, const StereoFeatures& features, double offset,
                       const EgoMotionParams& params);

/// Points of all keyframes as they are found in the current pair. @param motion as well as it is known, to about a pixel.
std::vector<Sighting> find_sightings(const std::vector<Keyframe>& keyframes, const SmoothPair& current,
                                     const StereoCamera& camera, const Eigen::Isometry3d& current_from_previous, double offset);

/// The keyframes after the motion: their poses are those to the current frame, the disparities of points that agree with the
/// motion are improved by where they were seen, inliers are counted.
/// @param limit error of an inlier, expected standard deviations.
std::vector<Keyframe> move_on(std::vector<Keyframe> keyframes, const std::vector<Sighting>& sightings,
                              const StereoCamera& camera, const MotionFit& fit, double limit);

}  // namespace brink
