#pragma once

#include <string>

#include <Eigen/Geometry>
#include <yaml-cpp/yaml.h>

#include "io/calibration/cameras.hpp"

namespace brink {

// One reader per kind. `looks_like_` tells whether a file is of the kind, `read_` what it says, or what is wrong with it.

bool looks_like_kitti(const std::string& text);
StereoCalibration read_kitti(const CalibrationRequest& request, const std::string& text);

bool looks_like_middlebury(const std::string& text);
StereoCalibration read_middlebury(const CalibrationRequest& request, const std::string& text);

bool looks_like_zed(const std::string& text);
StereoCalibration read_zed(const CalibrationRequest& request, const std::string& text);

bool looks_like_kalibr(const YAML::Node& root);
StereoCalibration read_kalibr(const CalibrationRequest& request, const YAML::Node& root);

bool looks_like_ros(const YAML::Node& root);
/// The right camera's file is request.files.right_path.
StereoCalibration read_ros(const CalibrationRequest& request, const YAML::Node& root);

bool looks_like_euroc(const YAML::Node& root);
/// The right camera's file is request.files.right_path.
StereoCalibration read_euroc(const CalibrationRequest& request, const YAML::Node& root);
/// T_BS of a sensor of EuRoC: position of points in the body from that in the sensor.
Eigen::Isometry3d read_body_from_sensor(const std::string& path, const YAML::Node& root);

bool looks_like_opencv(const YAML::Node& root);
/// Whether it tells how the cameras stand to each other, and not only their lenses: OpenCV's example for stereo cameras writes
/// that into another file.
bool is_whole_opencv(const YAML::Node& root);
/// What lacks in the first file is looked for in request.files.right_path.
StereoCalibration read_opencv(const CalibrationRequest& request, const YAML::Node& root);

}  // namespace brink
