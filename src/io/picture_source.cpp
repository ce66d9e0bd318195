#include "io/picture_source.hpp"

#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "brink/pictures.hpp"

namespace brink {
namespace {

void require_picture(const std::string& path, const std::string& partner) {
  if (path.empty()) throw NoPicture(partner + ": has no partner in the other eye");
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) throw NoPicture(path + ": no such file");
}

}  // namespace

PictureFiles::PictureFiles(std::vector<FrameFiles> files) : files_(std::move(files)) {}

PicturePair PictureFiles::read(int position) {
  const FrameFiles& files = files_.at(static_cast<std::size_t>(position));
  require_picture(files.left, files.right);
  require_picture(files.right, files.left);
  return {read_picture(files.left), read_picture(files.right), fmt::format("{} and {}", files.left, files.right)};
}

RectifiedSource::RectifiedSource(std::unique_ptr<PictureSource> source, Rectification rectification)
    : source_(std::move(source)), rectification_(std::move(rectification)) {}

PicturePair RectifiedSource::read(int position) {
  PicturePair pair = source_->read(position);
  for (const cv::Mat& picture : {pair.left, pair.right}) {
    if (picture.size() != rectification_.size) {
      throw std::runtime_error(fmt::format("{}: {}x{} px, expected those of the calibration, {}x{}", pair.name, picture.cols,
                                           picture.rows, rectification_.size.width, rectification_.size.height));
    }
  }
  pair.left = rectification_.left.apply(pair.left);
  pair.right = rectification_.right.apply(pair.right);
  return pair;
}

}  // namespace brink
