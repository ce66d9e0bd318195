#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "brink/calibration.hpp"
#include "brink/detector.hpp"
#include "brink/frame.hpp"
#include "brink/imu.hpp"

namespace brink {

class PictureSource;

/// A frame, or why there is none.
struct FrameReading {
  FrameStatus status = FrameStatus::ok;
  std::string reason;  ///< why status is not ok: one line that names the file
  Frame frame;         ///< pictures are empty when status is not ok; index and time are always told
};

/// Number and time of a frame.
struct FrameStamp {
  int index = 0;      ///< number in its sequence: that in its files' names when they are named by number
  double time = 0.0;  ///< s
};

/// Where the two pictures of a frame are looked for.
struct FrameFiles {
  int index = 0;
  double time = 0.0;  ///< s
  std::string left;   ///< path; "" = none is known
  std::string right;  ///< or the disparity or depth image in its place
};

/// What the numbers of an image in place of the right picture are. No file tells it.
enum class DepthKind : std::uint8_t {
  disparity,  ///< of the left picture: px; times 256 in files of 16 bit
  depth,      ///< along the optical axis: m; mm in files of 16 bit
};
std::string to_string(DepthKind kind);

/// Stereo pairs on disk, rectified when they are read. Holds names only: pictures are read one frame at a time.
class Sequence {
 public:
  /// Rectified pictures, each in a file of its own.
  /// @throws std::invalid_argument when the camera is not valid.
  Sequence(const StereoCamera& camera, const std::vector<FrameFiles>& files, std::vector<ImuSample> imu = {});
  /// Pictures from any source, which is asked for the positions of the stamps.
  Sequence(const StereoCamera& camera, std::vector<FrameStamp> stamps, std::unique_ptr<PictureSource> source,
           std::vector<ImuSample> imu = {}, std::vector<std::string> remarks = {});
  Sequence(Sequence&&) noexcept;
  Sequence& operator=(Sequence&&) noexcept;
  ~Sequence();

  [[nodiscard]] int size() const { return static_cast<int>(stamps_.size()); }
  [[nodiscard]] const StereoCamera& camera() const { return camera_; }
  [[nodiscard]] const std::vector<FrameStamp>& stamps() const { return stamps_; }
  /// Ascending in time, in the left camera frame; empty without an IMU.
  [[nodiscard]] const std::vector<ImuSample>& imu() const { return imu_; }
  /// Lines for people: what the input and its calibration were recognised as, and what is odd about it.
  [[nodiscard]] const std::vector<std::string>& remarks() const { return remarks_; }

  /// Reads one frame. A fault of its pictures is told in the result and leaves the other frames alone: no_picture when one
  /// is missing, bad_frame when it is there and cannot be used. Any order gives the same frames; a video is quick in ascending
  /// order only. One thread at a time.
  /// @param position 0 .. size() - 1. @throws std::out_of_range otherwise.
  [[nodiscard]] FrameReading read(int position) const;

 private:
  StereoCamera camera_;
  std::vector<FrameStamp> stamps_;
  std::unique_ptr<PictureSource> source_;
  std::vector<ImuSample> imu_;
  std::vector<std::string> remarks_;
};

/// Reads imu.csv: t,gx,gy,gz,ax,ay,az a line, in the left camera frame; a first line that begins with t is a heading.
/// @throws std::runtime_error "file: line n ..." when a line is not that or times do not increase.
std::vector<ImuSample> read_imu(const std::string& path);

/// Direction of gravity in the left camera frame: against the mean specific force of up to 3 s before a time, each
/// reading turned into the last one's frame by the gyroscope.
/// @param samples ascending in time. @return unit vector; empty with too few readings, or when their mean is not near 9.81
/// m/s^2.
std::optional<Eigen::Vector3d> estimate_gravity(const std::vector<ImuSample>& samples, double time);

/// How the left camera turned from one time to another, from the gyroscope: the rotation part of current_from_previous, which
/// takes directions in the camera's axes at `from` to its axes at `to`. Rates are interpolated between readings.
/// @param samples ascending in time. @return empty unless readings cover the whole time without a gap of 0.1 s or more.
std::optional<Eigen::Matrix3d> integrate_gyroscope(const std::vector<ImuSample>& samples, double from, double to);

/// Where the times of frames come from that do not tell them: one of these at most; with none, the number of a frame is its
/// time.
struct TimeSource {
  std::optional<double> fps = std::nullopt;  ///< frames per second: frame n is at n / fps
  std::string file = {};                     ///< path of a file of seconds, one line a frame; "" = none
  bool names = false;                        ///< the numbers in the pictures' names: ns, us or ms, or seconds with decimals

  [[nodiscard]] bool is_given() const { return fps || names || !file.empty(); }
  void validate() const;  ///< @throws std::invalid_argument when two are given, and unless fps is above 0, at most 100,000
};

/// Opens a folder in one of two layouts (docs/formats.md), told apart by what is in it.
///
/// Pictures of all layouts are checked to have the calibration's size, and rectified where it says how (calibration.hpp).
///
/// KITTI odometry: calib.txt (of any kind; or calib.yaml, calib.conf), image_2 and image_3 or else image_0 and image_1 with
/// pictures named by number, times.txt, and imu.csv, which gives each frame its gravity and its turn since the frame before.
/// Frames run from the smallest number to the greatest, over both eyes; a number without a picture is a frame of its own with
/// status no_picture. Without times.txt the time of a frame is what `times` says: a file has a line for each frame number from
/// 0.
///
/// EuRoC/ASL: mav0/cam0 and mav0/cam1 with data.csv and sensor.yaml, and mav0/imu0 if there is one. Times are counted from the
/// first frame.
/// @param times for a KITTI layout without times.txt; not from names: those are frame numbers.
/// @param calibration of a KITTI layout, in place of its calib.txt; without a path only its `pictures` counts.
/// @throws std::runtime_error "file: ..." when there are no pictures, names are no numbers, or a file other than a picture is
/// at fault; std::invalid_argument when `times` is not valid, or given where the times are known.
Sequence open_sequence(const std::string& folder, const TimeSource& times = {}, const CalibrationFiles& calibration = {});

/// Whether a path is meant as a pattern of many files: it is none itself, and holds *, ? or [ as glob(3) takes them, or the
/// place of a number as printf has it (%d, %06d).
bool is_pattern(const std::string& path);

/// Opens the pictures that two patterns match, one for each eye. Numbers in the names (the last one of a name that differs from
/// file to file) tell which belong together, what the frames' numbers are, and which are missing, as in a KITTI layout; numbers
/// that are 5 apart count every fifth. Names that share no numbers are paired in their order, when both patterns match as many.
/// @param calibration of the pair. @param times a file has a line for each frame, or for each frame number from 0.
/// @throws std::runtime_error "pattern: ..." when one matches nothing, or two cannot be paired, "file: ..." when another file
/// is at fault; std::invalid_argument when a pattern or `times` is not valid.
Sequence open_pairs(const std::string& left, const std::string& right, const CalibrationFiles& calibration,
                    const TimeSource& times = {});

/// Opens a video, a folder of PNG or JPEG pictures named by number, or the pictures that a pattern matches, in which both eyes'
/// pictures stand side by side: the left half is the left eye. Frames that a video announces and that cannot be decoded have
/// the status no_picture.
/// @param calibration for one half.
/// @param times in place of the frame rate that a video tells; for a folder without times.txt; for a pattern.
/// @throws std::runtime_error "file: ..." when a file is at fault; std::invalid_argument when `times` is not valid, given where
/// times.txt tells them, or from names and the input is no pattern.
Sequence open_side_by_side(const std::string& input, const CalibrationFiles& calibration, const TimeSource& times = {});

/// Opens a folder in the KITTI layout in which a folder named as the kind of image, disparity or depth, takes the place of the
/// right pictures (read_disparity, read_depth). The left ones are those of image_2, else of image_0, else there are none.
/// @throws as open_sequence does.
Sequence open_depth_sequence(const std::string& folder, DepthKind kind, const TimeSource& times = {},
                             const CalibrationFiles& calibration = {});

/// Disparity or depth images by their names, with their left pictures, or without any when all of these are "".
/// @throws std::runtime_error "file: ..." when the calibration is at fault, of raw pictures, or, for disparities, without a
///         baseline.
Sequence open_depth_files(const std::vector<FrameFiles>& files, DepthKind kind, const CalibrationFiles& calibration);

/// Likewise those that a pattern matches, with the left pictures that another one matches, or without any when it is "".
/// @throws as open_depth_files and open_pairs do.
Sequence open_depth_patterns(const std::string& left, const std::string& depth, DepthKind kind,
                             const CalibrationFiles& calibration, const TimeSource& times = {});

/// One pair as a sequence of one frame. Of the pictures no more than their size is looked at yet; one that is missing is told
/// when the frame is read.
/// @throws std::runtime_error "file: ..." when the calibration is at fault.
Sequence open_pair(const std::string& left, const std::string& right, const CalibrationFiles& calibration);

}  // namespace brink
