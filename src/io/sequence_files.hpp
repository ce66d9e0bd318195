#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "brink/calibration.hpp"
#include "brink/pictures.hpp"
#include "brink/sequence.hpp"

namespace brink {

/// Paths by frame number.
using NumberedFiles = std::map<int, std::string>;

/// The PNG and JPEG pictures of a folder by the number that each is named by; hidden and other files are left out.
/// @param is_wanted tells by the name which files are pictures.
/// @throws std::runtime_error "path: ..." when a picture's name is no number, two have the same, or the folder cannot be read.
NumberedFiles list_pictures(const std::filesystem::path& folder, bool (*is_wanted)(const std::string&) = is_picture_name);
std::vector<int> numbers_of(const NumberedFiles& pictures);

/// The path of a frame's picture; a missing one has the name that it would have.
std::string picture_or_expected(const NumberedFiles& pictures, const std::filesystem::path& folder, int number);

/// Refuses a jump: more than 1000 missing numbers in a row are no gap but another numbering.
/// @param numbers ascending. @throws std::runtime_error "folder: ..."
void check_gaps(const std::filesystem::path& folder, const std::vector<int>& numbers);

/// Seconds, one a line. @throws std::runtime_error "path: ..." when it is missing, a line is no number, or times do not
/// increase.
std::vector<double> read_time_list(const std::string& path);

/// times.txt: seconds, one line per frame number from 0. @return empty when there is no such file.
/// @throws std::runtime_error as read_time_list, and when there is none for last_number.
std::vector<double> read_times(const std::filesystem::path& path, int last_number);

/// "fps = 15", "times = names" or "times = FILE", for messages. @param source that is one of them.
std::string to_string(const TimeSource& source);

/// When the frames of a folder were taken: times.txt or a file given in its place, else number / fps, else the number itself.
class FrameClock {
 public:
  /// @throws as read_times and TimeSource::validate do, and std::invalid_argument when there is times.txt and another source as
  ///         well, or the source is names: those are the frames' numbers.
  FrameClock(const std::filesystem::path& folder, int last_number, const TimeSource& source);
  /// s. @param number 0 .. last_number.
  [[nodiscard]] double at(int number) const;

 private:
  std::vector<double> times_;
  double fps_;
};

/// A folder of pictures named by number.
struct NumberedFolder {
  std::filesystem::path folder;  ///< empty = there is none
  NumberedFiles files;
};
/// The frames of a sequence from the smallest number to the greatest over both folders, with where their pictures are or would
/// be. @throws std::runtime_error and std::invalid_argument as check_gaps and FrameClock do.
std::vector<FrameFiles> pair_by_number(const NumberedFolder& left, const NumberedFolder& right,
                                       const std::filesystem::path& sequence, const TimeSource& times);

/// A line for people when one eye has more pictures than the other: how many each has and where partners are missing.
/// @param left, right ascending numbers of the frames for which that eye has a picture. @param right_name what the right ones
/// are. @return empty for equal counts.
std::optional<std::string> unequal_counts(const std::string& folder, const std::vector<int>& left,
                                          const std::vector<int>& right, const std::string& right_name = "right");

/// imu.csv of a sequence; empty without one. @throws std::runtime_error as read_imu does.
std::vector<ImuSample> read_imu_of(const std::filesystem::path& sequence);

/// The calibration of a sequence in the KITTI layout: `given`, or with no path in it calib.txt, calib.yaml or calib.conf in the
/// folder, whichever is there first.
CalibrationFiles find_calibration(const std::filesystem::path& folder, CalibrationFiles given = {});

/// The folders of both eyes' pictures, with the cameras of calib.txt that took them.
struct Eyes {
  std::filesystem::path left;
  std::filesystem::path right;
  CameraPair cameras = CameraPair::color;
};
/// Colour wins where there are both. @return empty when the sequence holds neither image_2 and image_3 nor image_0 and image_1.
std::optional<Eyes> find_eyes(const std::filesystem::path& sequence);

}  // namespace brink
