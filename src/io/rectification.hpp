#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "brink/camera.hpp"

namespace brink {

enum class LensModel : std::uint8_t {
  radial_tangential,  ///< OpenCV's k1 k2 p1 p2 [k3 [k4 k5 k6 [s1 s2 s3 s4 [tx ty]]]]: rational from 8 on, thin prism from 12 on
  fisheye,            ///< OpenCV's fisheye, "equidistant" elsewhere: k1 k2 k3 k4 of the angle
};

/// A pinhole camera with a lens, as it was calibrated.
struct LensCamera {
  double focal_x = 0.0;  ///< px
  double focal_y = 0.0;  ///< px
  double cx = 0.0;       ///< px
  double cy = 0.0;       ///< px
  LensModel model = LensModel::radial_tangential;
  std::vector<double> distortion;  ///< radial_tangential: 0 (no distortion), 4, 5, 8, 12 or 14 of them; fisheye: 4
  cv::Size size;                   ///< px

  /// Straight lines stay straight: no coefficient counts.
  [[nodiscard]] bool is_pinhole() const;
  /// For people, as in "radial-tangential".
  [[nodiscard]] std::string lens() const;
};

/// From which place of a picture each pixel of the rectified one comes.
struct RectificationMaps {
  cv::Mat places;     ///< CV_16SC2; empty = the picture stays as it is
  cv::Mat fractions;  ///< CV_16UC1
  [[nodiscard]] cv::Mat apply(const cv::Mat& picture) const;
};

/// What makes rectified pairs of those of two cameras.
struct Rectification {
  cv::Size size;        ///< of the pictures, before and after
  StereoCamera camera;  ///< of the rectified pictures; not validated
  /// Axes of the left camera to those of the rectified one.
  Eigen::Matrix3d rectified_from_left = Eigen::Matrix3d::Identity();
  RectificationMaps left;
  RectificationMaps right;
};

/// Whether the pictures are rectified as they are: equal cameras without distortion and turned alike, the right one at a place
/// (b, 0, 0).
/// @param right_from_left position of points in the right camera from that in the left one, m.
bool is_rectified(const LensCamera& left, const LensCamera& right, const Eigen::Isometry3d& right_from_left);

/// Bouguet's rectification: both cameras are turned by half of their difference, then onto their baseline; principal points
/// are made equal. The view is chosen so that no pixel lacks a source: by cv::stereoRectify, and with a fisheye lens the widest
/// such view, up to 110 degrees across. Beyond that the pixels of a perspective picture go to its borders: there one sees a
/// third of the angle that one sees in the middle.
/// @param left, right of equal size. @param right_from_left as in is_rectified; the right camera must be on the right.
/// @throws std::runtime_error with the fault when there is no such view.
Rectification make_rectification(const LensCamera& left, const LensCamera& right, const Eigen::Isometry3d& right_from_left);

/// For pairs that are rectified but for the principal columns: moves the right pictures.
/// @param camera the left one's. @param right_offset principal column of the right camera less that of the left one, px.
Rectification make_shift(const StereoCamera& camera, cv::Size size, double right_offset);

}  // namespace brink
