#pragma once

#include <cstdint>
#include <string>

#include <opencv2/core.hpp>

#include "brink/camera.hpp"

namespace brink {

/// Which cameras of a KITTI calibration are meant: 0 and 1 are the grey pair, 2 and 3 the colour pair.
enum class CameraPair : std::uint8_t {
  any,    ///< colour if the file has it, else grey
  grey,   ///< P0 and P1
  color,  ///< P2 and P3
};

/// What a calibration file told, and what it was recognised as.
struct StereoCalibration {
  StereoCamera camera;
  std::string source;  ///< "KITTI, P2 and P3", "OpenCV, P1 and P2" or "OpenCV, Q"
  cv::Size size;       ///< of the pictures, px; empty when the file does not tell it
};

/// Reads the calibration of a rectified pair: KITTI calib.txt, or the YAML of OpenCV's stereoRectify (P1 and P2, or Q, and
/// image_width and image_height if they are there). The file is recognised by what it holds, not by its name. Lengths are
/// metres.
/// @param pair for KITTI; an OpenCV file holds one pair only.
/// @throws std::runtime_error "file: field = value, expected ..." when the file is missing, of an unknown kind, lacks a field
/// or
///         holds something else than the numbers of two equal, square-pixel cameras side by side, the left one first. Also for
///         calibrations of pictures that are not rectified (M1, D1, ...).
StereoCalibration read_calibration(const std::string& path, CameraPair pair = CameraPair::any);

}  // namespace brink
