#pragma once

#include <opencv2/core.hpp>

#include "brink/camera.hpp"
#include "brink/ground.hpp"
#include "candidates/region.hpp"

namespace brink {

/// What of a region below the ground is seen to lie beyond its far rim. What is seen through an opening lies within it: walls
/// end the view. A wet patch shows the mirror image of things that stand behind it, a grating any depth at all.
/// Only columns of the picture count in which the ground goes on above the region; a platform's edge has none.
/// @param ground 255 = surface at the height of the ground; size of the picture. @param disparity_sd_px of each disparity.
/// @return share of the region's pixels that lie farther than the far rim of their column, beyond tolerance and noise, of all
///         in such columns; 0 unless these are half of the region.
double compute_share_beyond_rim(const Region& region, const cv::Mat1b& ground, const cv::Mat1f& disparity,
                                const StereoCamera& camera, const GroundPose& pose, double disparity_sd_px);

}  // namespace brink
