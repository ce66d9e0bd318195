#pragma once

#include <optional>
#include <vector>

#include "brink/ground.hpp"

namespace brink {

/// The least-squares plane of a rim as the ground that a camera at the origin stands on, with the optical axis along z.
/// @return empty when the points are fewer than 3, lie on a line or are not finite.
std::optional<GroundPose> fit_rim_plane(const std::vector<Eigen::Vector3d>& opening);

}  // namespace brink
