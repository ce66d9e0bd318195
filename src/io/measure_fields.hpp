#pragma once

#include <array>

#include "brink/candidates.hpp"

namespace brink {

struct MeasureField {
  const char* name;
  double Measures::*value;
};

/// What a candidate's `measures` are called in JSON, in their order.
inline constexpr std::array kMeasureFields{
    MeasureField{"solid_angle_msr", &Measures::solid_angle_msr},
    MeasureField{"sigmas", &Measures::sigmas},
    MeasureField{"ground_misfit", &Measures::ground_misfit},
    MeasureField{"roughness", &Measures::roughness},
    MeasureField{"agreement", &Measures::agreement},
    MeasureField{"slope_deg", &Measures::slope_deg},
    MeasureField{"share_beyond", &Measures::share_beyond},
    MeasureField{"ground_share", &Measures::ground_share},
    MeasureField{"standing_share", &Measures::standing_share},
};

}  // namespace brink
