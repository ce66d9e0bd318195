#pragma once

#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "brink/camera.hpp"

namespace brink {

/// The smallest picture that is processed: below that there is no support grid and no ground.
inline constexpr int kMinImageWidth = 32;
inline constexpr int kMinImageHeight = 32;

/// One moment of input: a rectified stereo pair and what else is known of it.
struct Frame {
  int index = 0;         ///< number in its sequence, from 0
  double time = 0.0;     ///< s
  cv::Mat1b left;        ///< grey
  cv::Mat1b right;       ///< grey, size of left
  cv::Mat3b left_color;  ///< BGR, size of left; empty when the source is grey
  StereoCamera camera;   ///< of both pictures
  /// Direction of gravity ("down"), unit length, left camera frame; empty when there is no IMU.
  std::optional<Eigen::Vector3d> gravity;
  /// Rotation part of current_from_previous, from a gyroscope; previous = the frame with the index before this one. Empty when
  /// there is none.
  std::optional<Eigen::Matrix3d> current_from_previous_rotation;
  /// Pose of the left camera in any fixed frame, from another system; where two frames in a row have one, it takes the place of
  /// the motion measured in the pictures. Empty when there is none.
  std::optional<Eigen::Isometry3d> world_from_camera;
};

/// Makes a frame from two 8-bit pictures, each grey (1 channel) or BGR (3 channels).
/// @throws std::invalid_argument when a picture is empty, not 8-bit with 1 or 3 channels, smaller than kMinImageWidth x
///         kMinImageHeight, when the sizes differ, or when the camera is not valid.
Frame make_frame(const cv::Mat& left, const cv::Mat& right, const StereoCamera& camera, int index = 0, double time = 0.0);

}  // namespace brink
