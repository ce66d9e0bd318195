#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "brink/frame.hpp"
#include "brink/ground.hpp"

namespace brink {

/// Two hypotheses about a surface, tested directly on the two pictures: it is where its disparities put it, or it is ground.
/// Wet patches, gratings and little texture lead a matcher below the ground although the ground explains the pictures as well.
/// @param pixels to be judged. @param elevation over the ground, m, which tells the disparity that the ground has on the same
/// ray.
/// @return by what share the ground explains the pictures worse than the disparities do, over the pixels where the two lie
/// apart
///         and the picture has contrast: 0 = just as well, 1 = not at all; 1 when there are too few of these to judge, or no
///         right picture.
double compute_ground_misfit(const Frame& frame, const std::vector<cv::Point>& pixels, const cv::Mat1f& disparity,
                             const cv::Mat1f& elevation, const GroundPose& pose);

}  // namespace brink
