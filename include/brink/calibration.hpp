#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <opencv2/core.hpp>

#include "brink/camera.hpp"

namespace brink {

struct Rectification;

/// Which cameras of a KITTI calibration are meant: 0 and 1 are the grey pair, 2 and 3 the colour pair.
enum class CameraPair : std::uint8_t {
  any,    ///< colour if the file has it, else grey
  grey,   ///< P0 and P1
  color,  ///< P2 and P3
};

/// What was done to the pictures before.
enum class PictureState : std::uint8_t {
  raw,        ///< as the cameras took them
  rectified,  ///< by the calibration that goes with them
};

/// The file of a calibration, or the two where each camera has its own.
struct CalibrationFiles {
  std::string path;
  /// The right camera's, for kinds with a file per camera. Empty = looked for by the name of the left one (left and right, cam0
  /// and cam1), where that kind needs it.
  std::string right_path = {};
  /// Must be told for files that describe the lenses and the rectified pair as well; may be told for others, and is checked.
  std::optional<PictureState> pictures = std::nullopt;
};

/// The baseline that the camera of a file about one camera is given, m: depth pictures need none, brink's disparities do.
inline constexpr double kNominalBaseline = 0.1;

/// What a calibration told, and what it was recognised as.
struct StereoCalibration {
  StereoCamera camera;  ///< of the rectified pictures
  std::string source;   ///< the kind, as in "KITTI, P2 and P3"
  cv::Size size;        ///< of one eye's pictures, px; of picture_size when the file does not tell it, else empty
  /// What rectifies the pictures; null when they are rectified already.
  std::shared_ptr<const Rectification> rectification = nullptr;
  /// The file is about one camera: there is no right one, and the baseline is kNominalBaseline.
  bool single = false;
};

/// Reads the calibration of a pair. The kind is recognised by what the file holds, not by its name; docs/formats.md lists the
/// kinds. Lengths are metres.
/// @param picture_size of one eye's pictures, px: checked against the file's, and needed by kinds with several sizes in a file.
/// @param pair for KITTI; others hold one pair only.
/// @throws std::runtime_error "file: field = value, expected ..." when a file is missing, of an unknown kind, lacks a field, or
///         is not about two cameras side by side, the left one first, and pictures of this size.
/// @throws std::invalid_argument when files.pictures is missing where it is needed, or says what the file does not allow.
StereoCalibration read_calibration(const CalibrationFiles& files, cv::Size picture_size = {},
                                   CameraPair pair = CameraPair::any);

/// The same for given disparities or depths, for which the left camera is enough: takes files about a single camera as well.
/// @throws as read_calibration does, and std::runtime_error for a single camera with a lens that is not corrected.
StereoCalibration read_depth_calibration(const CalibrationFiles& files, cv::Size picture_size = {},
                                         CameraPair pair = CameraPair::any);

/// What was understood, in one line: kind, size, focal length, baseline, field of view, and whether pictures are rectified.
std::string describe(const StereoCalibration& calibration);

}  // namespace brink
