#pragma once

#include <opencv2/core.hpp>

#include "brink/camera.hpp"
#include "brink/ground.hpp"
#include "candidates/region.hpp"

namespace brink {

/// How steeply the surface falls at the rim of a region below the ground: from every pixel at the border of the region's deep
/// part to the nearest valid pixel outside the region, height lost over distance gone. A ramp or a bend of the road is as
/// gentle there as anywhere; a drop is not.
/// @param deep 255 = deep enough to be below ground; size of the picture. @param level 255 = surface outside every such region.
/// @return the angle that a quarter of the border reaches, degrees, 0..90; 0 when no level pixel lies near.
double compute_rim_slope_deg(const Region& region, const cv::Mat1b& deep, const cv::Mat1b& level, const cv::Mat1f& disparity,
                             const StereoCamera& camera, const GroundPose& pose);

}  // namespace brink
