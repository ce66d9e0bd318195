#pragma once

#include <string>

#include <opencv2/core.hpp>

#include "brink/ego_motion.hpp"

namespace brink {

/// Why the two pictures of a rectified pair seem to be exchanged: most of what both show lies farther right in the right one,
/// and nothing in front of two cameras side by side does. Our own test (docs/algorithm.md).
/// @return empty when they do not seem so, or show too little to tell.
std::string find_exchanged_eyes(const cv::Mat1b& left, const cv::Mat1b& right, const EgoMotionParams& params);

}  // namespace brink
