#pragma once

#include <vector>

#include "ego_motion/matching.hpp"

namespace brink {

/// Keeps the matches of least cost in each square of the current left picture, so that one textured corner of the picture does
/// not outvote all the rest. @return row by row of squares; ties go to the earlier match.
/// @param bucket_px side of a square, px. @param per_bucket greatest number kept in each.
std::vector<CircularMatch> thin_out(const std::vector<CircularMatch>& matches, double bucket_px, int per_bucket);

}  // namespace brink
