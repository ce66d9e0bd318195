#pragma once

#include <array>
#include <vector>

#include "brink/ground.hpp"
#include "ground/v_disparity.hpp"

namespace brink {

/// The band around a plane in which samples count.
struct SampleBand {
  double tolerance_ratio;  ///< half its width, share of the disparity,
  double tolerance_px;     ///< never less than this,
  double widen;            ///< times this
};

/// Sums over the samples of w u u, w u v, w u, w v v, w v, w, w d u, w d v, w d.
using NormalEquations = std::array<double, 9>;

/// Of a plane, u counted from the principal point; w = Tukey's weight of a sample's distance from the plane. Each sum is taken
/// in the order of the samples, so that it is equal to the plain twin in tests/reference/ground_equations.hpp for every target.
/// @param plane u from the left edge of the picture.
NormalEquations add_up_normal_equations(const std::vector<DisparitySample>& samples, double cx, const GroundPlane& plane,
                                        const SampleBand& band);

}  // namespace brink
