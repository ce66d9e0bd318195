#pragma once

#include <string>

#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

namespace brink {

/// The frames of a video file, by FFmpeg through OpenCV.
class VideoFile {
 public:
  /// @throws std::runtime_error "path: ..." when it is missing or no video.
  explicit VideoFile(const std::string& path);

  /// As the file announces it; where it does not, as many as can be decoded, which takes one pass over the file.
  [[nodiscard]] int frames() const { return frames_; }
  [[nodiscard]] double fps() const { return fps_; }  ///< 0 = the file does not tell
  [[nodiscard]] cv::Size size() const { return size_; }

  /// One frame, BGR; empty when the file announces it and it cannot be decoded. Ascending positions are quick; after another
  /// one the file is decoded anew up to the frame, so that the result is always the same.
  cv::Mat3b read(int position);
  /// Frames that came before the first one that could not be decoded; frames() as long as none is known.
  [[nodiscard]] int decoded() const { return decoded_; }

 private:
  void open();

  std::string path_;
  cv::VideoCapture capture_;
  int next_ = 0;  // position of the frame that the capture decodes next
  int frames_ = 0;
  int decoded_ = 0;
  double fps_ = 0.0;
  cv::Size size_;
};

}  // namespace brink
