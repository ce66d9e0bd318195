#pragma once

#include <memory>

#include "brink/disparity.hpp"

namespace brink {

/// OpenCV's block matching. @throws std::invalid_argument when the parameters are not valid.
std::unique_ptr<StereoMatcher> make_bm_matcher(const BmParams& params);

/// OpenCV's semi-global block matching along 3 directions. @throws std::invalid_argument when the parameters are not valid.
std::unique_ptr<StereoMatcher> make_sgbm_matcher(const SgbmParams& params);

/// The same, smoothed by a weighted-least-squares filter. @throws std::invalid_argument when the parameters are not valid.
std::unique_ptr<StereoMatcher> make_sgbm_wls_matcher(const SgbmParams& params);

}  // namespace brink
