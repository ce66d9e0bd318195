#pragma once

#include <array>

namespace brink {

/// One line of filter_adaptive_mean: the mean of seven pixels around each. Equal to the plain twin in
/// tests/reference/naive_disparity.hpp for every target.
/// @param around for each of the seven, in their order, where the neighbours of the first pixel begin; the fourth is the line
///        itself. Of pixels outside the picture kInvalidDisparity.
void filter_mean_line(const std::array<const float*, 7>& around, int size, float* result);

}  // namespace brink
