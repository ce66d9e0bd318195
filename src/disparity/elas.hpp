#pragma once

#include <memory>

#include "brink/disparity.hpp"

namespace brink {

/// @throws std::invalid_argument when the parameters are not valid.
std::unique_ptr<StereoMatcher> make_elas_matcher(const ElasParams& params);

}  // namespace brink
