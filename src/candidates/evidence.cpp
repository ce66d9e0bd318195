#include "candidates/evidence.hpp"

#include <algorithm>
#include <cmath>

namespace brink {
namespace {

// Printed by scripts/fit-probability.
constexpr double kConstant = -9.982;
constexpr double kSolidAngle = 1.644;  // of the logarithm
constexpr double kSigmas = 2.903;      // of the logarithm
constexpr double kMisfit = 1.250;
constexpr double kRoughness = -3.746;  // of the logarithm
constexpr double kGroundShare = 2.079;
constexpr double kStandingShare = -7.326;

constexpr double kNoDisparity = 0.54;  // enough to be validated at the fifth sighting, as by the paper
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
  const double log_odds = kConstant + kSolidAngle * log_of(measures.solid_angle_msr) + kSigmas * log_of(measures.sigmas) +
                          kMisfit * measures.ground_misfit + kRoughness * log_of(measures.roughness) +
                          kGroundShare * measures.ground_share + kStandingShare * measures.standing_share;
  return std::clamp(log_odds, kLeast, kMost);
}

double to_probability(double log_odds) { return 1.0 / (1.0 + std::exp(-log_odds)); }

}  // namespace brink
