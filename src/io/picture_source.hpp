#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "brink/calibration.hpp"
#include "brink/sequence.hpp"

namespace brink {

/// Both eyes' pictures of one frame, 8 bit, grey or BGR, or a disparity image in place of the right one.
struct PicturePair {
  cv::Mat left;  ///< empty when there is a disparity image only
  cv::Mat right;
  std::string name;          ///< where they come from, for messages
  cv::Mat1f disparity = {};  ///< as Frame::disparity; empty when there is a right picture
};

/// A picture is not there. Faults of one that is there are other std::runtime_error.
class NoPicture : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// @throws NoPicture when no such file is known or there. @param partner of the other eye, for the message.
void require_picture(const std::string& path, const std::string& partner);

/// Where the pictures of a sequence come from.
class PictureSource {
 public:
  PictureSource() = default;
  PictureSource(const PictureSource&) = delete;
  PictureSource& operator=(const PictureSource&) = delete;
  virtual ~PictureSource() = default;

  /// @param position of the frame in its sequence, from 0; any order.
  /// @throws NoPicture, or std::runtime_error, "file: ...".
  virtual PicturePair read(int position) = 0;
};

/// A file for each eye.
class PictureFiles : public PictureSource {
 public:
  explicit PictureFiles(std::vector<FrameFiles> files);
  PicturePair read(int position) override;

 private:
  std::vector<FrameFiles> files_;
};

/// What another source reads, checked to be of the calibration's size and rectified where that is needed.
class CalibratedSource : public PictureSource {
 public:
  CalibratedSource(std::unique_ptr<PictureSource> source, StereoCalibration calibration);
  PicturePair read(int position) override;

 private:
  std::unique_ptr<PictureSource> source_;
  StereoCalibration calibration_;
};

/// Size of the first picture that can be read, for the choice and check of a calibration; empty when none can.
cv::Size first_picture_size(const std::vector<FrameFiles>& files);

}  // namespace brink
