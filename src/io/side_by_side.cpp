#include <filesystem>
#include <memory>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "brink/calibration.hpp"
#include "brink/pictures.hpp"
#include "io/picture_patterns.hpp"
#include "io/picture_source.hpp"
#include "io/sequence_files.hpp"
#include "io/video_file.hpp"

namespace brink {
namespace fs = std::filesystem;
namespace {

/// Size of one eye's picture.
cv::Size half_of(const std::string& name, cv::Size both) {
  if (both.width % 2 != 0) {
    throw std::runtime_error(
        fmt::format("{}: {}x{} px, expected an even width: two pictures side by side", name, both.width, both.height));
  }
  return {both.width / 2, both.height};
}

PicturePair halves_of(const cv::Mat& picture, const std::string& name) {
  const int half = half_of(name, picture.size()).width;
  return {picture.colRange(0, half).clone(), picture.colRange(half, picture.cols).clone(), name};
}

class SideBySidePictures : public PictureSource {
 public:
  explicit SideBySidePictures(std::vector<FrameFiles> files) : files_(std::move(files)) {}

  PicturePair read(int position) override {
    const std::string& file = files_.at(static_cast<std::size_t>(position)).left;
    std::error_code ignored;
    if (!fs::exists(file, ignored)) throw NoPicture(file + ": no such file");
    return halves_of(read_picture(file), file);
  }

 private:
  std::vector<FrameFiles> files_;
};

class SideBySideVideo : public PictureSource {
 public:
  SideBySideVideo(std::string path, VideoFile video) : path_(std::move(path)), video_(std::move(video)) {}

  PicturePair read(int position) override {
    const cv::Mat3b picture = video_.read(position);
    if (picture.empty()) {
      throw NoPicture(fmt::format("{}: {} of its {} frames can be decoded: it is truncated or damaged", path_, video_.decoded(),
                                  video_.frames()));
    }
    return halves_of(picture, fmt::format("{}, frame {}", path_, position));
  }

 private:
  std::string path_;
  VideoFile video_;
};

/// @param what the input is, for people.
Sequence calibrated(const StereoCalibration& calibration, std::vector<FrameStamp> stamps, std::unique_ptr<PictureSource> source,
                    const std::string& what) {
  return {calibration.camera,
          std::move(stamps),
          std::make_unique<CalibratedSource>(std::move(source), calibration),
          {},
          {fmt::format("{}; calibration: {}", what, describe(calibration))}};
}

Sequence open_video(const std::string& path, const CalibrationFiles& calibration, const TimeSource& times) {
  if (times.names) throw std::invalid_argument("times = names, must not be given: " + path + " is a video");
  VideoFile video(path);
  const cv::Size half = half_of(path, video.size());
  const StereoCalibration known = read_calibration(calibration, half);
  const std::vector<double> listed = times.file.empty() ? std::vector<double>() : read_time_list(times.file);
  if (!times.file.empty() && std::ssize(listed) != video.frames()) {
    throw std::runtime_error(
        fmt::format("{}: has {} times, expected one for each of {} frames", times.file, listed.size(), video.frames()));
  }
  const double fps = times.fps.value_or(video.fps());
  if (fps == 0.0) throw std::runtime_error(path + ": tells no frame rate, expected it to be given (fps)");
  std::vector<FrameStamp> stamps;
  stamps.reserve(static_cast<std::size_t>(video.frames()));
  for (int index = 0; index < video.frames(); ++index) {
    stamps.push_back({index, listed.empty() ? index / fps : listed[static_cast<std::size_t>(index)]});
  }
  const std::string what = fmt::format("{}: side-by-side video, {} frames of 2 x {}x{} px, {:.4g} a second", path,
                                       video.frames(), half.width, half.height, fps);
  return calibrated(known, std::move(stamps), std::make_unique<SideBySideVideo>(path, std::move(video)), what);
}

Sequence open_folder(const fs::path& folder, const CalibrationFiles& calibration, const TimeSource& times) {
  const NumberedFiles pictures = list_pictures(folder);
  if (pictures.empty()) throw std::runtime_error(folder.string() + ": holds no PNG or JPEG pictures");
  std::vector<int> numbers;
  for (const auto& picture : pictures) numbers.push_back(picture.first);
  check_gaps(folder, numbers);
  const FrameClock clock(folder, numbers.back(), times);
  std::vector<FrameStamp> stamps;
  std::vector<FrameFiles> files;
  for (int number = numbers.front(); number <= numbers.back(); ++number) {
    stamps.push_back({number, clock.at(number)});
    files.push_back({number, clock.at(number), picture_or_expected(pictures, folder, number), ""});
  }
  const cv::Size both = first_picture_size(files);
  const StereoCalibration known = read_calibration(calibration, {both.width / 2, both.height});
  const std::string what = fmt::format("{}: side-by-side pictures, {} frames", folder.string(), stamps.size());
  return calibrated(known, std::move(stamps), std::make_unique<SideBySidePictures>(std::move(files)), what);
}

Sequence open_pattern(const std::string& pattern, const CalibrationFiles& calibration, const TimeSource& times) {
  PatternFrames found = match_patterns(pattern, "", times);
  const cv::Size both = first_picture_size(found.frames);
  const StereoCalibration known = read_calibration(calibration, {both.width / 2, both.height});
  std::vector<FrameStamp> stamps;
  for (const FrameFiles& frame : found.frames) stamps.push_back({frame.index, frame.time});
  return calibrated(known, std::move(stamps), std::make_unique<SideBySidePictures>(std::move(found.frames)),
                    found.remarks.front() + ", side by side");
}

}  // namespace

Sequence open_side_by_side(const std::string& input, const CalibrationFiles& calibration, const TimeSource& times) {
  times.validate();
  std::error_code error;
  if (is_pattern(input)) return open_pattern(input, calibration, times);
  return fs::is_directory(input, error) ? open_folder(input, calibration, times) : open_video(input, calibration, times);
}

}  // namespace brink
