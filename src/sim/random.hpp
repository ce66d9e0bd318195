#pragma once

#include <cmath>
#include <numbers>
#include <random>

namespace brink::sim {

/// Seeded random numbers that are the same with every standard library: the distributions of <random> are not.
class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}

  /// Evenly in [0, 1).
  double uniform() { return static_cast<double>(engine_()) / 4294967296.0; }
  /// Evenly in [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Standard normal, by Box and Muller (1958).
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }

 private:
  std::mt19937 engine_;  // its sequence is fixed by the standard
};

}  // namespace brink::sim
