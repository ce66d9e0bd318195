#pragma once

#include <opencv2/core.hpp>

#include "brink/camera.hpp"
#include "brink/ground.hpp"
#include "candidates/region.hpp"

namespace brink {

/// What is seen of the floor below an opening, in square cells seen from above. Cells in which much of a wall is seen are no
/// floor. Shares are of all cells, those of walls too.
struct Floor {
  double stairs_share = 0.0;  ///< on the largest surface that falls away from the ground as stairs do; 0 = none does
  double level_share = 0.0;   ///< on the largest level surface
};

/// Stairs fall from near the ground by three steps (45 cm) or more, with a mean slope of 20 to 42 degrees: 12 cm each 33 cm to
/// 22 cm each 25 cm. Their treads lie within 10 cm of one plane.
/// @param disparity px, valid where the region is. @param elevation over the ground, m. Both of the picture's size.
/// @return all 0 for a region of which fewer than 8 cells are seen.
Floor measure_floor(const Region& region, const cv::Mat1f& disparity, const cv::Mat1f& elevation, const StereoCamera& camera,
                    const GroundPose& pose);

}  // namespace brink
