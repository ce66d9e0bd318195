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

/// Disparity images are float, in pixels; a pixel without one holds exactly this.
inline constexpr float kInvalidDisparity = -1.0F;

/// One moment of input: a rectified stereo pair, or a disparity image with its left picture or without any, and what else is
/// known of it.
struct Frame {
  int index = 0;         ///< number in its sequence, from 0
  double time = 0.0;     ///< s
  cv::Mat1b left;        ///< grey; empty when there is only a disparity image
  cv::Mat1b right;       ///< grey, size of left; empty when there is a disparity image
  cv::Mat3b left_color;  ///< BGR, size of left; empty when the source is grey
  /// Given: takes the place of matching. Of the left picture and of its size, px, 0 to its width, kInvalidDisparity = none;
  /// empty when there is a right picture.
  cv::Mat1f disparity;
  StereoCamera camera;  ///< of both pictures
  /// Direction of gravity ("down"), unit length, left camera frame; empty when there is no IMU.
  std::optional<Eigen::Vector3d> gravity;
  /// Rotation part of current_from_previous, from a gyroscope; previous = the frame with the index before this one. Empty when
  /// there is none.
  std::optional<Eigen::Matrix3d> current_from_previous_rotation;
  /// Pose of the left camera in any fixed frame, from another system; where two frames in a row have one, it takes the place of
  /// the motion measured in the pictures. Empty when there is none.
  std::optional<Eigen::Isometry3d> world_from_camera;

  /// Of the left picture, or of the disparity image where there is none.
  [[nodiscard]] cv::Size size() const { return left.empty() ? disparity.size() : left.size(); }
  /// @throws std::invalid_argument when pictures, disparity image and camera are not such as the functions below make.
  void validate() const;
};

/// Makes a frame from two 8-bit pictures, each grey (1 channel) or BGR (3 channels).
/// @throws std::invalid_argument when a picture is empty, not 8-bit with 1 or 3 channels, smaller than kMinImageWidth x
///         kMinImageHeight, when the sizes differ, or when the camera is not valid.
Frame make_frame(const cv::Mat& left, const cv::Mat& right, const StereoCamera& camera, int index = 0, double time = 0.0);

/// Makes a frame from a disparity image, with its left picture or without.
/// @param left as for make_frame, or empty: there is none. Without it drops without disparity (Type 2) cannot be told, and the
///        motion of the camera cannot be measured.
/// @param disparity of the left picture, px. What is negative, not finite or more than its width becomes kInvalidDisparity. A
///        depth image becomes one by disparity_from_depth.
/// @throws std::invalid_argument as make_frame, of the disparity image likewise.
Frame make_frame_with_disparity(const cv::Mat& left, const cv::Mat1f& disparity, const StereoCamera& camera, int index = 0,
                                double time = 0.0);

/// Equation 2 of the paper: d = f b / z. A depth sensor has no baseline; its camera carries a nominal one, which depths, and
/// all that follows from them, do not depend on.
/// @param depth_m z of each pixel, along the optical axis, not along its ray, m.
/// @return px; kInvalidDisparity where the depth is not finite or below 1 cm: 0 is the sensors' sign for none, and nothing is
///         seen as near.
/// @throws std::invalid_argument when the camera is not valid.
cv::Mat1f disparity_from_depth(const cv::Mat1f& depth_m, const StereoCamera& camera);

}  // namespace brink
