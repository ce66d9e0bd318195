#pragma once

#include <opencv2/core.hpp>

namespace brink {

/// Keeps the left disparities that the right view confirms: the pixel they point at has nearly the same disparity.
/// @param left,right disparities of the two views, equal sizes, px.
/// @param threshold_px largest difference.
/// @return the left disparities, kInvalidDisparity where not confirmed.
cv::Mat1f check_consistency(const cv::Mat1f& left, const cv::Mat1f& right, float threshold_px);

}  // namespace brink
