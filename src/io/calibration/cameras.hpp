#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "brink/calibration.hpp"
#include "io/rectification.hpp"

namespace brink {

/// What is asked of the reader of a kind.
struct CalibrationRequest {
  CalibrationFiles files;  ///< right_path: with the partner that was found
  cv::Size picture_size;
  CameraPair pair = CameraPair::any;
  bool single_will_do = false;
};

/// Projection matrix of a rectified camera: f 0 cx tx, 0 f cy ty, 0 0 1 tz, row by row.
struct Projection {
  std::string name;  ///< for messages
  std::vector<double> p;
};

// What every kind ends in: the checks of all of them, told in one voice. `path` is the file that is named when a check fails;
// `source` what it was recognised as; `size` that of the file, empty when it tells none.

/// Rectified cameras. @param shifted their principal columns may differ: the right pictures are moved.
StereoCalibration from_projections(const CalibrationRequest& request, const std::string& source, const Projection& left,
                                   const Projection& right, cv::Size size, bool shifted);

/// Rectified cameras of which focal length, principal point and baseline are told.
/// @param right_offset principal column of the right camera less that of the left one, px.
StereoCalibration from_rectified(const CalibrationRequest& request, const std::string& source, const StereoCamera& camera,
                                 cv::Size size, double right_offset);

/// Cameras with lenses, to be rectified unless they are already.
StereoCalibration from_lenses(const CalibrationRequest& request, const std::string& source, const LensCamera& left,
                              const LensCamera& right, const Eigen::Isometry3d& right_from_left);

/// One camera, with the nominal baseline. @throws also when request does not allow it.
StereoCalibration from_single(const CalibrationRequest& request, const std::string& source, const LensCamera& camera);

/// A lens by the names and numbers of a file; checks all of them.
/// @param intrinsics focal lengths along x and y, principal column and row, px.
/// @param field for messages: that of the model's name. @param model by the names that EuRoC, Kalibr, ROS and OpenCV use.
LensCamera make_lens(const std::string& path, const std::vector<double>& intrinsics, const std::string& field,
                     const std::string& model, std::vector<double> coefficients, cv::Size size);

/// Width and height of a file. @throws unless they are whole numbers from 1 to 10000.
cv::Size make_size(const std::string& path, const std::string& field, const std::vector<double>& sides);

/// A 4x4 matrix, row by row, as a motion. @throws unless it is a rotation and a shift.
Eigen::Isometry3d make_isometry(const std::string& path, const std::string& field, const std::vector<double>& matrix);

/// A 3x3 matrix, row by row, as a rotation.
Eigen::Matrix3d make_rotation(const std::string& path, const std::string& field, const std::vector<double>& matrix);

}  // namespace brink
