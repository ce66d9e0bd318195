#pragma once

#include <opencv2/core.hpp>

#include "brink/frame.hpp"

namespace brink {

/// How well the two pictures agree about a region: the correlation of windows of 7x7 px around its pixels in the left picture
/// with those at their disparity in the right one. Where both see one surface nearly all windows agree; mirror images and
/// guesses agree here and there.
/// @param deep 255 = pixel of the region. @param disparity px, valid there. Both of the frame's size.
/// @return the correlation that a quarter of the windows do not reach, -1 to 1; 1 without a right picture, or with fewer than
/// 20 windows that have contrast.
double compute_agreement(const Frame& frame, const cv::Mat1b& deep, const cv::Mat1f& disparity);

}  // namespace brink
