#include "candidates/evidence.hpp"

#include <algorithm>
#include <cmath>

namespace brink {
namespace {

// Printed by scripts/fit-probability.
constexpr double kConstant = -10.77;
constexpr double kArea = 1.181;    // of the logarithm
constexpr double kSigmas = 1.190;  // of the logarithm
constexpr double kMisfit = 3.818;
constexpr double kRoughness = -2.364;  // of the logarithm

constexpr double kNoDisparity = 1.0;
constexpr double kLeast = -4.0;
constexpr double kMost = 6.0;

double log_of(double value) {
  constexpr double kSmallest = 0.01;
  return std::log(std::max(value, kSmallest));
}

}  // namespace

double compute_evidence(const Candidate& candidate) {
  if (candidate.type == CandidateType::no_disparity) return kNoDisparity;
  const Measures& measures = candidate.measures;
  const double log_odds = kConstant + kArea * log_of(candidate.area_px) + kSigmas * log_of(measures.sigmas) +
                          kMisfit * measures.ground_misfit + kRoughness * log_of(measures.roughness);
  return std::clamp(log_odds, kLeast, kMost);
}

}  // namespace brink
