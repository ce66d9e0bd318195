#pragma once

#include <cstdint>
#include <random>

namespace brink::sim {

/// Draws that are equal on every machine: the standard's distributions differ from library to library, its generator does not.
class Random {
 public:
  explicit Random(std::uint32_t seed) : generator_(seed) {}

  /// In [low, high).
  double uniform(double low, double high) { return low + (high - low) * static_cast<double>(generator_()) / 4294967296.0; }
  /// In [low, high], both included.
  int integer(int low, int high) { return low + static_cast<int>(uniform(0.0, static_cast<double>(high - low + 1))); }
  bool chance(double probability) { return uniform(0.0, 1.0) < probability; }
  /// 1 or -1.
  double sign() { return chance(0.5) ? 1.0 : -1.0; }

 private:
  std::mt19937 generator_;
};

}  // namespace brink::sim
