#pragma once

#include "brink/evaluation.hpp"

namespace brink {

/// Sums of frame times are not exact, and 0.5 s are 0.5 s. In seconds.
inline constexpr double kTimeTolerance = 1e-9;

inline bool is_present(const VisibleInstance& instance, const EvaluationParams& params) {
  return instance.visible_px >= params.min_visible_px && instance.distance_m.value_or(0.0) <= params.first_range_m;
}

/// An unknown depth counts as deep.
inline bool is_deep(const VisibleInstance& instance, const EvaluationParams& params) {
  return instance.depth_m.value_or(params.min_depth_m) >= params.min_depth_m;
}

}  // namespace brink
