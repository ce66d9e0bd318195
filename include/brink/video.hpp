#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

#include "brink/files.hpp"

namespace brink {

/// Whether a path is named like a video: .mp4 .avi .mkv, in any case; also .mov .webm .m4v .mpg .mpeg .wmv .gif, which
/// VideoWriter refuses.
bool is_video_name(const std::string& path);

/// Frames per second at which a video of frames with these times runs as they did: from the median step, within 1 to 60.
/// 1 for fewer than two frames, and when times do not increase.
double compute_video_fps(const std::vector<double>& times);

/// A video that is there whole or not at all: written under a temporary name in the same folder, renamed by commit(), removed
/// when there was no commit(). H.264 (avc1), or MPEG-4 part 2 (mp4v) where there is no encoder for that.
class VideoWriter {
 public:
  /// @param path of a file named .mp4, .avi or .mkv. @param size of all pictures, px: both even, 16 to 8192.
  /// @param fps 0.1 to 240.
  /// @throws std::invalid_argument for another ending, size or fps; std::runtime_error "path: cannot be written: ..." also when
  ///         no encoder can be opened.
  VideoWriter(const std::string& path, const cv::Size& size, double fps);

  /// @throws std::invalid_argument when the picture has another size, std::runtime_error "path: cannot be written: ..." as soon
  ///         as the disk is full.
  void write(const cv::Mat3b& picture);
  /// Closes the file, checks that all frames are in it and gives it its name.
  /// @throws std::runtime_error "path: cannot be written: ..." when they are not, or there is none.
  void commit();

 private:
  std::string path_;
  cv::Size size_;
  OutputFile file_;
  cv::VideoWriter encoder_;
  int frames_ = 0;
};

}  // namespace brink
