#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "brink/sim/scene.hpp"

namespace brink::sim {

/// A place on a surface, in the coordinates of its body, so that a pattern moves with it and both eyes see the same.
struct SurfacePoint {
  Eigen::Vector3f position;  ///< m
  Eigen::Vector3f normal;    ///< unit length; its largest component chooses the plane of flat patterns (tiles, stones)
  float footprint;           ///< size of what one ray stands for, m; features below that are averaged out
};

/// Reflectance of a material at a place, linear RGB, within 0..0.95.
/// @param seed distinguishes two materials with the same pattern.
Eigen::Vector3f compute_reflectance(const Material& material, const SurfacePoint& point, std::uint32_t seed);

/// Reflectance of a material seen from far away.
Eigen::Vector3f compute_mean_reflectance(const Material& material);

/// Band-limited value noise of zero mean and unit variance, made of oblique cells of the given size: its lattice is tilted
/// against the world's axes, so that no ground or wall cuts it along a plane.
float compute_noise(const Eigen::Vector3f& position, float cell, std::uint32_t seed);

/// 32 well-mixed bits of an integer.
inline std::uint32_t mix_bits(std::uint32_t x) {
  x ^= x >> 16U;
  x *= 0x7feb352dU;
  x ^= x >> 15U;
  x *= 0x846ca68bU;
  return x ^ (x >> 16U);
}

/// The upper 24 bits as a number in [0, 1).
inline float to_unit(std::uint32_t bits) { return static_cast<float>(bits >> 8U) * 0x1p-24F; }

}  // namespace brink::sim
