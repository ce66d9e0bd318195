#pragma once

#include <opencv2/core.hpp>

namespace brink {

/// What matching errs by is alike over a few pixels, and the plane through a window takes a part of it along. Measured on
/// twelve simulated walks over level ground, by day and at dusk: 3.1 to 3.6 times the roughness is GroundEstimate::residual_px.
inline constexpr double kNoiseOverRoughness = 3.3;

/// How rough the inside of a region is: the root mean square distance of the disparities in a window of 7x7 px from the plane
/// through them, the median over the region. A surface shows the noise of matching there; mirror images in wet or polished
/// things, half seen through what lies on the ground, jump.
/// @param deep 255 = pixel of the region. @param disparity px, valid there. Both of one size.
/// @return px; 0 when no window holds 20 of the region's pixels.
double compute_roughness_px(const cv::Mat1b& deep, const cv::Mat1f& disparity);

}  // namespace brink
