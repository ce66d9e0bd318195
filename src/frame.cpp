#include "brink/frame.hpp"

#include <stdexcept>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

namespace brink {
namespace {

void check_picture(const cv::Mat& picture, const char* eye) {
  if (picture.empty()) throw std::invalid_argument(fmt::format("{} picture is empty", eye));
  if (picture.depth() != CV_8U || (picture.channels() != 1 && picture.channels() != 3)) {
    throw std::invalid_argument(fmt::format("{} picture has {} channels of {}, must be 1 (grey) or 3 (colour) of 8-bit", eye,
                                            picture.channels(), cv::depthToString(picture.depth())));
  }
  if (picture.cols < kMinImageWidth || picture.rows < kMinImageHeight) {
    throw std::invalid_argument(fmt::format("{} picture is {}x{} px, must be at least {}x{}", eye, picture.cols, picture.rows,
                                            kMinImageWidth, kMinImageHeight));
  }
}

cv::Mat1b to_grey(const cv::Mat& picture) {
  if (picture.channels() == 1) return picture;
  cv::Mat1b grey;
  cv::cvtColor(picture, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

}  // namespace

Frame make_frame(const cv::Mat& left, const cv::Mat& right, const StereoCamera& camera, int index, double time) {
  check_picture(left, "left");
  check_picture(right, "right");
  if (left.size() != right.size()) {
    throw std::invalid_argument(
        fmt::format("pictures differ in size: left {}x{}, right {}x{} px", left.cols, left.rows, right.cols, right.rows));
  }
  camera.validate();
  Frame frame;
  frame.index = index;
  frame.time = time;
  frame.left = to_grey(left);
  frame.right = to_grey(right);
  if (left.channels() == 3) frame.left_color = left;
  frame.camera = camera;
  return frame;
}

}  // namespace brink
