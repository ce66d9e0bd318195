#include "brink/overlay.hpp"

namespace brink {

void PathTrail::add(const std::optional<Eigen::Isometry3d>& current_from_previous) {
  constexpr std::size_t kLongest = 1000;
  if (!current_from_previous) {
    path_.clear();
    return;
  }
  if (path_.size() == kLongest) path_.erase(path_.begin());
  path_.emplace_back(Eigen::Vector3d::Zero());
  for (Eigen::Vector3d& position : path_) position = *current_from_previous * position;
}

}  // namespace brink
