#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include <opencv2/core.hpp>

#include "brink/ego_motion.hpp"

namespace brink {

/// Extrema of a 5x5 blob filter and of a 5x5 corner filter. Only equal classes are ever matched.
enum class FeatureClass : std::uint8_t { blob_minimum, blob_maximum, corner_minimum, corner_maximum };
inline constexpr std::size_t kFeatureClasses = 4;

/// 16 samples of each gradient around the feature, 128 = none.
using FeatureDescriptor = std::array<std::uint8_t, 32>;

/// A place that can be found again in another picture.
struct Feature {
  cv::Point2f position;  ///< px of the full picture
  FeatureClass kind = FeatureClass::blob_minimum;
  int strength = 0;  ///< |filter response|
  FeatureDescriptor descriptor{};
};

/// Block non-maximum suppression (Neubeck, Van Gool, ICPR 2006) on both filters, then the strongest of each bucket.
/// @return row by row of buckets, strongest first; empty for pictures that are too small or have no texture.
std::vector<Feature> find_features(const cv::Mat1b& picture, const EgoMotionParams& params);

/// Sum of absolute differences, 0 .. 32 * 255.
inline int compute_cost(const FeatureDescriptor& a, const FeatureDescriptor& b) {
  int cost = 0;
  for (std::size_t i = 0; i < a.size(); ++i) cost += std::abs(int{a[i]} - int{b[i]});
  return cost;
}

}  // namespace brink
