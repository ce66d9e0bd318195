#include <filesystem>
#include <memory>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "brink/calibration.hpp"
#include "brink/pictures.hpp"
#include "io/picture_source.hpp"
#include "io/sequence_files.hpp"
#include "io/video_file.hpp"

namespace brink {
namespace fs = std::filesystem;
namespace {

/// @param calibrated size of one half, px; empty when the calibration does not tell it.
void check_size(const std::string& name, cv::Size both, cv::Size calibrated) {
  if (both.width % 2 != 0) {
    throw std::runtime_error(
        fmt::format("{}: {}x{} px, expected an even width: two pictures side by side", name, both.width, both.height));
  }
  const cv::Size half(both.width / 2, both.height);
  if (!calibrated.empty() && half != calibrated) {
    throw std::runtime_error(fmt::format("{}: its halves have {}x{} px, expected those of the calibration, {}x{}", name,
                                         half.width, half.height, calibrated.width, calibrated.height));
  }
}

PicturePair halves_of(const cv::Mat& picture, const std::string& name) {
  const int half = picture.cols / 2;
  return {picture.colRange(0, half).clone(), picture.colRange(half, picture.cols).clone(), name};
}

class SideBySidePictures : public PictureSource {
 public:
  SideBySidePictures(std::vector<std::string> files, cv::Size calibrated) : files_(std::move(files)), calibrated_(calibrated) {}

  PicturePair read(int position) override {
    const std::string& file = files_.at(static_cast<std::size_t>(position));
    std::error_code ignored;
    if (!fs::exists(file, ignored)) throw NoPicture(file + ": no such file");
    const cv::Mat picture = read_picture(file);
    check_size(file, picture.size(), calibrated_);
    return halves_of(picture, file);
  }

 private:
  std::vector<std::string> files_;
  cv::Size calibrated_;
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

Sequence open_video(const std::string& path, const StereoCalibration& calibration, std::optional<double> given_fps) {
  VideoFile video(path);
  check_size(path, video.size(), calibration.size);
  const double fps = given_fps.value_or(video.fps());
  if (fps == 0.0) throw std::runtime_error(path + ": tells no frame rate, expected it to be given (fps)");
  std::vector<FrameStamp> stamps;
  stamps.reserve(static_cast<std::size_t>(video.frames()));
  for (int index = 0; index < video.frames(); ++index) stamps.push_back({index, index / fps});
  std::string remark = fmt::format("{}: side-by-side video, {} frames of 2 x {}x{} px, {:.4g} a second; calibration: {}", path,
                                   video.frames(), video.size().width / 2, video.size().height, fps, calibration.source);
  return {calibration.camera, std::move(stamps), std::make_unique<SideBySideVideo>(path, std::move(video)), {}, {remark}};
}

Sequence open_folder(const fs::path& folder, const StereoCalibration& calibration, std::optional<double> fps) {
  const NumberedFiles pictures = list_pictures(folder);
  if (pictures.empty()) throw std::runtime_error(folder.string() + ": holds no PNG or JPEG pictures");
  std::vector<int> numbers;
  for (const auto& picture : pictures) numbers.push_back(picture.first);
  check_gaps(folder, numbers);
  const FrameClock clock(folder, numbers.back(), fps);
  std::vector<FrameStamp> stamps;
  std::vector<std::string> files;
  for (int number = numbers.front(); number <= numbers.back(); ++number) {
    stamps.push_back({number, clock.at(number)});
    files.push_back(picture_or_expected(pictures, folder, number));
  }
  std::string remark =
      fmt::format("{}: side-by-side pictures, {} frames; calibration: {}", folder.string(), stamps.size(), calibration.source);
  return {calibration.camera,
          std::move(stamps),
          std::make_unique<SideBySidePictures>(std::move(files), calibration.size),
          {},
          {remark}};
}

}  // namespace

Sequence open_side_by_side(const std::string& input, const CalibrationFiles& calibration, std::optional<double> fps) {
  if (fps) check_fps(*fps);
  const StereoCalibration known = read_calibration(calibration);
  std::error_code error;
  return fs::is_directory(input, error) ? open_folder(input, known, fps) : open_video(input, known, fps);
}

}  // namespace brink
