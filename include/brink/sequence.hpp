#pragma once

#include <optional>
#include <string>
#include <vector>

#include "brink/detector.hpp"
#include "brink/frame.hpp"
#include "brink/imu.hpp"

namespace brink {

/// A frame, or why there is none.
struct FrameReading {
  FrameStatus status = FrameStatus::ok;
  std::string reason;  ///< why status is not ok: one line that names the file
  Frame frame;         ///< pictures are empty when status is not ok; index and time are always told
};

/// Where the two pictures of a frame are looked for.
struct FrameFiles {
  int index = 0;      ///< number of the frame: that in its files' names
  double time = 0.0;  ///< s
  std::string left;
  std::string right;
};

/// Rectified stereo pairs on disk. Holds names only: pictures are read one frame at a time.
class Sequence {
 public:
  /// @throws std::invalid_argument when the camera is not valid.
  Sequence(const StereoCamera& camera, std::vector<FrameFiles> files, std::vector<ImuSample> imu = {});

  [[nodiscard]] int size() const { return static_cast<int>(files_.size()); }
  [[nodiscard]] const StereoCamera& camera() const { return camera_; }
  [[nodiscard]] const std::vector<FrameFiles>& files() const { return files_; }

  /// Reads one frame. A fault of its pictures is told in the result and leaves the other frames alone: no_picture when a file
  /// is missing, bad_frame when it is there and cannot be used.
  /// @param position 0 .. size() - 1. @throws std::out_of_range otherwise.
  [[nodiscard]] FrameReading read(int position) const;

 private:
  StereoCamera camera_;
  std::vector<FrameFiles> files_;
  std::vector<ImuSample> imu_;
};

/// Reads imu.csv: t,gx,gy,gz,ax,ay,az a line, in the left camera frame; a first line that begins with t is a heading.
/// @throws std::runtime_error "file: line n ..." when a line is not that or times do not increase.
std::vector<ImuSample> read_imu(const std::string& path);

/// Direction of gravity in the left camera frame: against the mean specific force of the second before a time, each
/// reading turned into the last one's frame by the gyroscope.
/// @param samples ascending in time. @return unit vector; empty with too few readings, or when their mean is not near 9.81
/// m/s^2.
std::optional<Eigen::Vector3d> estimate_gravity(const std::vector<ImuSample>& samples, double time);

/// How the left camera turned from one time to another, from the gyroscope: the rotation part of current_from_previous, which
/// takes directions in the camera's axes at `from` to its axes at `to`. Rates are interpolated between readings.
/// @param samples ascending in time. @return empty unless readings cover the whole time without a gap of 0.1 s or more.
std::optional<Eigen::Matrix3d> integrate_gyroscope(const std::vector<ImuSample>& samples, double from, double to);

/// Opens a folder in the KITTI odometry layout (docs/formats.md): calib.txt, image_2 and image_3 or else image_0 and image_1
/// with pictures named by number, times.txt, and imu.csv, which gives each frame its gravity and its turn since the frame
/// before. Frames run from the smallest number to the greatest, over both eyes; a number without a picture is a frame of its
/// own with status no_picture. Without times.txt the time of a frame is its number.
/// @throws std::runtime_error "file: ..." when there are no pictures, names are no numbers, or calib.txt, times.txt or
/// imu.csv is at fault.
Sequence open_sequence(const std::string& folder);

/// One pair as a sequence of one frame; the pictures are not opened yet.
/// @throws std::runtime_error "file: ..." when the calibration is at fault.
Sequence open_pair(const std::string& left, const std::string& right, const std::string& calibration);

}  // namespace brink
