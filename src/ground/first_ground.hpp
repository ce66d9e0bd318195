#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "brink/ground.hpp"
#include "ground/plane_search.hpp"

namespace brink {

/// The ground of a frame without a past.
struct FirstGround {
  std::optional<GroundPlane> plane;
  std::string reason;  ///< why there is none
  std::string doubt;   ///< two surfaces may be the ground, and nothing tells which: both heights; empty when there is no doubt
};

/// Of several planes the ground is the one that continues nearest to the bearer's feet: when the surface nearest to them lies
/// above the plane with the highest score, and is parallel to it, it is that surface, however few pixels it has. A plane that
/// was bent to meet a limit of the parameters is none: the unconstrained plane explains its pixels better, and breaks a limit.
/// @param planes from search_planes with all roll angles. @param gravity unit length, if known.
/// @param standing_height_m of the bearer, if it is known from before: the plane that goes with it is preferred.
FirstGround choose_first_ground(const GroundSamples& samples, const std::vector<PlaneHypothesis>& planes,
                                const Plausibility& plausible, const GroundParams& params,
                                const std::optional<Eigen::Vector3d>& gravity,
                                const std::optional<double>& standing_height_m = std::nullopt);

}  // namespace brink
