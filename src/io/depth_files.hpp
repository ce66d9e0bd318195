#pragma once

#include <vector>

#include "brink/sequence.hpp"
#include "io/picture_source.hpp"

namespace brink {

/// Disparity or depth images, with or without their left pictures.
class DepthFiles : public PictureSource {
 public:
  /// @param files right = the disparity or depth image; left empty for all = there are no pictures.
  /// @param size of all of them, px; empty = not known.
  DepthFiles(std::vector<FrameFiles> files, DepthKind kind, const StereoCamera& camera, cv::Size size);
  PicturePair read(int position) override;

 private:
  std::vector<FrameFiles> files_;
  DepthKind kind_;
  StereoCamera camera_;
  cv::Size size_;
  bool has_pictures_;
};

}  // namespace brink
