#include "brink/frame.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

namespace brink {
namespace {

void check_size(const cv::Mat& picture, const std::string& name) {
  if (picture.empty()) throw std::invalid_argument(fmt::format("{} is empty", name));
  if (picture.cols < kMinImageWidth || picture.rows < kMinImageHeight) {
    throw std::invalid_argument(fmt::format("{} is {}x{} px, must be at least {}x{}", name, picture.cols, picture.rows,
                                            kMinImageWidth, kMinImageHeight));
  }
}

void check_picture(const cv::Mat& picture, const std::string& name) {
  const bool is_known = picture.depth() == CV_8U && (picture.channels() == 1 || picture.channels() == 3);
  if (!picture.empty() && !is_known) {
    throw std::invalid_argument(fmt::format("{} has {} channels of {}, must be 1 (grey) or 3 (colour) of 8-bit", name,
                                            picture.channels(), cv::depthToString(picture.depth())));
  }
  check_size(picture, name);
}

void check_sizes(const cv::Mat& left, const cv::Mat& other, const char* what, const char* name) {
  if (left.size() == other.size()) return;
  throw std::invalid_argument(
      fmt::format("{} differ in size: left {}x{}, {} {}x{} px", what, left.cols, left.rows, name, other.cols, other.rows));
}

/// Whether a pixel of a disparity image tells one. More than the width of the picture no stereo camera can see.
bool is_disparity(float value, int width) { return value >= 0.0F && value <= static_cast<float>(width); }

void check_disparities(const cv::Mat1f& disparity) {
  for (const float value : disparity) {
    if (value == kInvalidDisparity || is_disparity(value, disparity.cols)) continue;
    throw std::invalid_argument(
        fmt::format("disparity = {}, must be {} (none) or 0 to {} px", value, kInvalidDisparity, disparity.cols));
  }
}

cv::Mat1b to_grey(const cv::Mat& picture) {
  if (picture.channels() == 1) return picture;
  cv::Mat1b grey;
  cv::cvtColor(picture, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

Frame make_left_frame(const cv::Mat& left, const StereoCamera& camera, int index, double time) {
  camera.validate();
  Frame frame;
  frame.index = index;
  frame.time = time;
  frame.left = to_grey(left);
  if (left.channels() == 3) frame.left_color = left;
  frame.camera = camera;
  return frame;
}

}  // namespace

void Frame::validate() const {
  if (disparity.empty() || !left.empty()) check_size(left, "left picture");
  if (disparity.empty()) {
    check_size(right, "right picture");
    check_sizes(left, right, "pictures", "right");
  } else {
    check_size(disparity, "disparity image");
    check_disparities(disparity);
    if (!left.empty()) check_sizes(left, disparity, "picture and disparity image", "disparity");
    if (!right.empty()) throw std::invalid_argument("right picture must be empty where a disparity image is given");
  }
  if (!left_color.empty()) check_sizes(left, left_color, "pictures", "colour");
  camera.validate();
}

Frame make_frame(const cv::Mat& left, const cv::Mat& right, const StereoCamera& camera, int index, double time) {
  check_picture(left, "left picture");
  check_picture(right, "right picture");
  check_sizes(left, right, "pictures", "right");
  Frame frame = make_left_frame(left, camera, index, time);
  frame.right = to_grey(right);
  return frame;
}

Frame make_frame_with_disparity(const cv::Mat& left, const cv::Mat1f& disparity, const StereoCamera& camera, int index,
                                double time) {
  if (!left.empty()) check_picture(left, "left picture");
  check_size(disparity, "disparity image");
  if (!left.empty()) check_sizes(left, disparity, "picture and disparity image", "disparity");
  Frame frame = make_left_frame(left, camera, index, time);
  frame.disparity = disparity.clone();
  for (float& value : frame.disparity) {
    if (!is_disparity(value, disparity.cols)) value = kInvalidDisparity;
  }
  return frame;
}

cv::Mat1f disparity_from_depth(const cv::Mat1f& depth_m, const StereoCamera& camera) {
  constexpr float kLeastDepth = 0.01F;  // m
  camera.validate();
  const auto focal_baseline = static_cast<float>(camera.focal * camera.baseline);
  cv::Mat1f disparity(depth_m.size(), kInvalidDisparity);
  for (int v = 0; v < depth_m.rows; ++v) {
    for (int u = 0; u < depth_m.cols; ++u) {
      const float depth = depth_m(v, u);
      if (std::isfinite(depth) && depth >= kLeastDepth) disparity(v, u) = focal_baseline / depth;
    }
  }
  return disparity;
}

}  // namespace brink
