#include "io/video_file.hpp"

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <stdexcept>

namespace brink {
namespace fs = std::filesystem;
namespace {

// FFmpeg takes a text file for a film of its letters.
bool is_text(const cv::VideoCapture& capture) {
  return static_cast<int>(capture.get(cv::CAP_PROP_FOURCC)) == cv::VideoWriter::fourcc('a', 'n', 's', 'i');
}

// 0 when the file tells none, or one that it cannot hold: every frame takes a byte at least.
int announced_frames(const cv::VideoCapture& capture, std::uintmax_t bytes) {
  const double count = capture.get(cv::CAP_PROP_FRAME_COUNT);
  constexpr double kMost = 1e7;
  const bool believable = count >= 1.0 && count <= kMost && count <= static_cast<double>(bytes);
  return believable ? static_cast<int>(std::lround(count)) : 0;
}

}  // namespace

VideoFile::VideoFile(const std::string& path) : path_(path) {
  std::error_code error;
  if (!fs::exists(path, error)) throw std::runtime_error(path + ": no such file");
  if (!fs::is_regular_file(path, error)) throw std::runtime_error(path + ": is no regular file, expected a video");
  open();
  size_ = {static_cast<int>(capture_.get(cv::CAP_PROP_FRAME_WIDTH)), static_cast<int>(capture_.get(cv::CAP_PROP_FRAME_HEIGHT))};
  const double fps = capture_.get(cv::CAP_PROP_FPS);
  fps_ = std::isfinite(fps) && fps > 0.0 ? fps : 0.0;
  frames_ = announced_frames(capture_, fs::file_size(path, error));
  if (frames_ == 0) {
    while (capture_.grab()) ++frames_;
    open();
  }
  if (frames_ == 0) throw std::runtime_error(path + ": holds no frame that can be decoded");
  decoded_ = frames_;
}

void VideoFile::open() {
  next_ = 0;
  if (!capture_.open(path_, cv::CAP_FFMPEG) || is_text(capture_)) {
    throw std::runtime_error(path_ + ": cannot be read as a video: it is none, or its beginning or end is missing");
  }
  capture_.set(cv::CAP_PROP_ORIENTATION_AUTO, 0.0);  // calibrations know nothing of a turn noted in the file
}

cv::Mat3b VideoFile::read(int position) {
  if (position >= decoded_) return {};
  if (position < next_) open();
  for (; next_ < position; ++next_) {
    if (!capture_.grab()) {
      decoded_ = next_;
      return {};
    }
  }
  cv::Mat3b picture;
  if (!capture_.read(picture)) {
    decoded_ = next_;
    return {};
  }
  ++next_;
  return picture.clone();  // the capture may use its memory again
}

}  // namespace brink
