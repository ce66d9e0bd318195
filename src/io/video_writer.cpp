#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "brink/video.hpp"

namespace brink {
namespace {

constexpr std::array<std::string_view, 3> kWritten{".mp4", ".avi", ".mkv"};
constexpr std::array<std::string_view, 7> kOthers{".mov", ".webm", ".m4v", ".mpg", ".mpeg", ".wmv", ".gif"};

// ".mp4" of "walk.MP4"
std::string ending_of(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return ending;
}

template <std::size_t kCount>
bool contains(const std::array<std::string_view, kCount>& endings, const std::string& ending) {
  return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

// The ending tells the encoder's library the container; it stays at the end of the temporary name.
std::string checked_ending(const std::string& path) {
  std::string ending = ending_of(path);
  if (!contains(kWritten, ending)) throw std::invalid_argument(path + ": a video must be named .mp4, .avi or .mkv");
  return ending;
}

cv::VideoWriter open_encoder(const std::string& name, double fps, const cv::Size& size) {
  cv::VideoWriter encoder;
  for (const int codec : {cv::VideoWriter::fourcc('a', 'v', 'c', '1'), cv::VideoWriter::fourcc('m', 'p', '4', 'v')}) {
    if (encoder.open(name, cv::CAP_FFMPEG, codec, fps, size)) break;
  }
  return encoder;
}

}  // namespace

bool is_video_name(const std::string& path) {
  const std::string ending = ending_of(path);
  return contains(kWritten, ending) || contains(kOthers, ending);
}

double compute_video_fps(const std::vector<double>& times) {
  constexpr double kSlowest = 1.0;
  constexpr double kFastest = 60.0;
  std::vector<double> steps;
  for (std::size_t i = 1; i < times.size(); ++i) steps.push_back(times[i] - times[i - 1]);
  if (steps.empty()) return kSlowest;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle > 0.0 ? std::clamp(1.0 / *middle, kSlowest, kFastest) : kSlowest;
}

VideoWriter::VideoWriter(const std::string& path, const cv::Size& size, double fps)
    : path_(path), size_(size), file_(path, checked_ending(path)) {
  const auto fits = [](int length) { return length >= 16 && length <= 8192 && length % 2 == 0; };
  if (!fits(size.width) || !fits(size.height)) {
    throw std::invalid_argument(fmt::format("size = {}x{}, must be even numbers from 16 to 8192", size.width, size.height));
  }
  if (!(fps >= 0.1 && fps <= 240.0)) throw std::invalid_argument(fmt::format("fps = {}, must be from 0.1 to 240", fps));
  if (file_.temporary().empty()) throw std::runtime_error(path + ": cannot be written: a video needs a regular file");
  encoder_ = open_encoder(file_.temporary(), fps, size);
  if (encoder_.isOpened()) return;
  file_.check_room();
  throw std::runtime_error(path + ": cannot be written: OpenCV has no encoder for H.264 or MPEG-4 (FFmpeg)");
}

void VideoWriter::write(const cv::Mat3b& picture) {
  if (picture.size() != size_) {
    throw std::invalid_argument(
        fmt::format("picture of {}x{} px, the video has {}x{}", picture.cols, picture.rows, size_.width, size_.height));
  }
  encoder_.write(picture);
  file_.check_room();  // the encoder itself never tells
  ++frames_;
}

void VideoWriter::commit() {
  if (frames_ == 0) throw std::runtime_error(path_ + ": cannot be written: there is no frame");
  encoder_.release();
  file_.check_room();
  // After an error FFmpeg leaves out all that follows, so that the number of frames, which it writes last, is not there.
  const cv::VideoCapture reader(file_.temporary(), cv::CAP_FFMPEG);
  const double frames = reader.isOpened() ? reader.get(cv::CAP_PROP_FRAME_COUNT) : 0.0;
  if (std::abs(frames - frames_) > 0.5) throw std::runtime_error(path_ + ": cannot be written: the video came out incomplete");
  file_.commit();
}

}  // namespace brink
