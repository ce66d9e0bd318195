#include "ego_motion/exchanged_eyes.hpp"

#include <fmt/format.h>

#include "ego_motion/features.hpp"
#include "ego_motion/matching.hpp"

namespace brink {
namespace {

// Measured (docs/algorithm.md): at most 9 % of the features of any pair here, at least 91 % of the same ones exchanged.
constexpr double kShare = 0.75;
constexpr int kFewest = 50;       // features: fewer tell nothing
constexpr float kFarAway = 1.0F;  // px: what is nearly at infinity has no side

/// On the same row, to either side.
SearchWindow beside(cv::Point2f place, const EgoMotionParams& params) {
  const auto reach = static_cast<float>(params.max_disparity_px);
  const auto tolerance = static_cast<float>(params.row_tolerance_px);
  return {{place.x - reach, place.y - tolerance}, {place.x + reach, place.y + tolerance}};
}

}  // namespace

std::string find_exchanged_eyes(const cv::Mat1b& left, const cv::Mat1b& right, const EgoMotionParams& params) {
  if (left.empty() || right.empty()) return {};
  const FeatureIndex left_features(find_features(left, params), left.size());
  const FeatureIndex right_features(find_features(right, params), right.size());
  int both = 0;
  int farther_right = 0;
  for (int i = 0; i < left_features.size(); ++i) {
    const cv::Point2f place = left_features[i].position;
    const auto match = right_features.find(left_features[i], beside(place, params), params);
    if (!match) continue;
    const Feature& other = right_features[*match];
    if (left_features.find(other, beside(other.position, params), params) != i) continue;
    const float disparity = place.x - other.position.x;
    if (disparity <= kFarAway && disparity >= -kFarAway) continue;
    ++both;
    farther_right += disparity < 0.0F ? 1 : 0;
  }
  if (both < kFewest || farther_right < kShare * both) return {};
  return fmt::format("left and right seem to be exchanged: {} of {} features lie farther right in the right picture",
                     farther_right, both);
}

}  // namespace brink
