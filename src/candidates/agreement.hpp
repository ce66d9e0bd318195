#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "brink/frame.hpp"

namespace brink {

/// How well the two pictures agree about a region: the correlation of windows of 7x7 px around its pixels in the left picture
/// with those at their disparity in the right one. Where both see one surface nearly all windows agree; mirror images and
/// guesses agree here and there.
/// @param pixels of the region, evenly spread. @param disparity px, valid there; of the frame's size.
/// @return the correlation that a quarter of the windows do not reach, -1 to 1; 1 without a right picture, or with fewer than
/// 20 windows that have contrast.
double compute_agreement(const Frame& frame, const std::vector<cv::Point>& pixels, const cv::Mat1f& disparity);

}  // namespace brink
