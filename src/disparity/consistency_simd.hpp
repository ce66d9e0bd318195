#pragma once

namespace brink {

/// Keeps those disparities of a row of the left view that the right view confirms: check_consistency, which calls this, for one
/// row. Equal to the plain twin in tests/reference/consistency.hpp for every target.
void check_consistency_row(const float* left, const float* right, int width, float threshold_px, float* checked);

}  // namespace brink
