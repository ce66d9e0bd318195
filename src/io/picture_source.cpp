#include "io/picture_source.hpp"

#include <filesystem>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "brink/files.hpp"
#include "brink/pictures.hpp"
#include "io/picture_header.hpp"
#include "io/rectification.hpp"

namespace brink {

void require_picture(const std::string& path, const std::string& partner) {
  if (path.empty()) throw NoPicture(partner + ": has no partner in the other eye");
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) throw NoPicture(path + ": no such file");
}

PictureFiles::PictureFiles(std::vector<FrameFiles> files) : files_(std::move(files)) {}

PicturePair PictureFiles::read(int position) {
  const FrameFiles& files = files_.at(static_cast<std::size_t>(position));
  require_picture(files.left, files.right);
  require_picture(files.right, files.left);
  return {read_picture(files.left), read_picture(files.right), fmt::format("{} and {}", files.left, files.right)};
}

CalibratedSource::CalibratedSource(std::unique_ptr<PictureSource> source, StereoCalibration calibration)
    : source_(std::move(source)), calibration_(std::move(calibration)) {}

PicturePair CalibratedSource::read(int position) {
  PicturePair pair = source_->read(position);
  const cv::Size size = pair.left.size();
  if (size != pair.right.size()) {
    throw std::runtime_error(fmt::format("{}: pictures differ in size: left {}x{}, right {}x{} px", pair.name, size.width,
                                         size.height, pair.right.cols, pair.right.rows));
  }
  const cv::Size& expected = calibration_.size;
  if (!expected.empty() && size != expected) {
    throw std::runtime_error(fmt::format("{}: {}x{} px, expected those of the calibration and the other pictures, {}x{}",
                                         pair.name, size.width, size.height, expected.width, expected.height));
  }
  if (!calibration_.rectification) return pair;
  pair.left = calibration_.rectification->left.apply(pair.left);
  pair.right = calibration_.rectification->right.apply(pair.right);
  return pair;
}

cv::Size first_picture_size(const std::vector<FrameFiles>& files) {
  for (const FrameFiles& frame : files) {
    for (const std::string& path : {frame.left, frame.right}) {
      std::error_code ignored;
      if (path.empty() || !std::filesystem::is_regular_file(path, ignored)) continue;
      try {
        const PictureHeader header = examine_picture(read_file(path));
        return {header.width, header.height};
      } catch (const std::runtime_error&) {
        continue;  // told when the frame is read
      }
    }
  }
  return {};
}

}  // namespace brink
