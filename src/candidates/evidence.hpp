#pragma once

#include "brink/candidates.hpp"

namespace brink {

/// How much one sighting speaks for a drop: the logarithm of the odds that it is one, from its size, how surely it lies below
/// the ground, and what the pictures say of it. Logistic regression on simulated walks (scripts/fit-probability,
/// docs/algorithm.md); -4 to 6. Of Type 2 there were too few to fit; it has a fixed one.
double compute_evidence(const Candidate& candidate);

/// Log-odds to a probability, 0..1.
double to_probability(double log_odds);

}  // namespace brink
