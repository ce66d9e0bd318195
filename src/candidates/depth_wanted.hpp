#pragma once

#include <algorithm>

#include "brink/candidates.hpp"

namespace brink {

/// How far below the ground Type 1 must measure, m. What lies within T_g of the ground is ground, unless less was asked for.
inline double measured_depth_wanted(const CandidateParams& params) {
  return std::max(params.min_depth_m * params.measured_depth_ratio, std::min(params.min_depth_m, params.ground_tolerance_m));
}

/// How far it must lie to stand out of the noise, times its disparity: m px. On one ray an elevation is h (1 - d_ground / d),
/// so its standard deviation is h / d times that of d.
inline double noise_depth_wanted(const GroundSurface& ground, const CandidateParams& params) {
  return params.min_sigmas * ground.disparity_sd_px * ground.pose.height_m;
}

}  // namespace brink
