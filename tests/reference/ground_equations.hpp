#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "ground/normal_equations_simd.hpp"

namespace brink::reference {

/// add_up_normal_equations, sample by sample.
inline NormalEquations naive_normal_equations(const std::vector<DisparitySample>& samples, double cx, const GroundPlane& plane,
                                              const SampleBand& band) {
  NormalEquations equations{};
  for (const DisparitySample& s : samples) {
    const double expected = plane.disparity(s.u + cx, s.v);
    const double error = s.d - expected;
    const double half_width = band.widen * std::max(band.tolerance_px, band.tolerance_ratio * s.d);
    if (expected <= 0.0 || std::abs(error) >= half_width) continue;
    const double residual = error / half_width;
    const double root = 1.0 - residual * residual;
    const double w = root * root;
    const double wu = w * s.u;
    const double wv = w * s.v;
    const double wd = w * s.d;
    const NormalEquations terms = {wu * s.u, wu * s.v, wu, wv * s.v, wv, w, wd * s.u, wd * s.v, wd};
    for (std::size_t term = 0; term < terms.size(); ++term) equations[term] += terms[term];
  }
  return equations;
}

}  // namespace brink::reference
