#pragma once

#include <vector>

#include "brink/ego_motion.hpp"
#include "ego_motion/matching.hpp"

namespace brink {

/// Removes matches that move otherwise than everything around them. All are judged by the full set: the order plays no part.
std::vector<CircularMatch> remove_outliers(const std::vector<CircularMatch>& matches, const EgoMotionParams& params);

}  // namespace brink
