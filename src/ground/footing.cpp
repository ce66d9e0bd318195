#include "ground/footing.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace brink {
namespace {

constexpr double kCell = 0.1;         // m
constexpr double kReach = 2.5;        // m around the bearer within which surfaces are remembered
constexpr double kForget = 4.0;       // m away from him they are forgotten
constexpr double kFoot = 0.25;        // m: half a step, and how far a head is ahead of the feet
constexpr int kMinCells = 4;          // under the feet
constexpr int kMaxFrames = 8;         // that the mean of a cell runs over
constexpr double kSameSurface = 0.1;  // m: heights that differ by more are of different surfaces, of which the newer counts
constexpr std::size_t kEvery = 3;     // of the coarse samples

int cell_index(double metres) {
  constexpr double kMaxCell = 1e8;  // given poses may be anywhere
  return static_cast<int>(std::clamp(std::floor(metres / kCell), -kMaxCell, kMaxCell));
}

}  // namespace

void Footing::start(const GroundPose& ground) {
  started_ = true;
  frame_ = 0;
  cells_.clear();
  start_from_camera_ = Eigen::Isometry3d::Identity();
  start_from_camera_.linear() << ground.right.transpose(), ground.down.transpose(), ground.forward.transpose();
}

void Footing::move(const Eigen::Isometry3d& current_from_previous) {
  start_from_camera_ = start_from_camera_ * current_from_previous.inverse();
}

void Footing::add(const GroundSamples& samples) {
  ++frame_;
  const Eigen::Vector3d camera = start_from_camera_.translation();
  struct Sum {
    double height = 0.0;
    int count = 0;
  };
  std::map<std::pair<int, int>, Sum> seen;
  const std::vector<DisparitySample>& coarse = samples.coarse.samples();
  for (std::size_t i = 0; i < coarse.size(); i += kEvery) {
    const DisparitySample& s = coarse[i];
    const Eigen::Vector3d point = start_from_camera_ * samples.camera.triangulate(s.u + samples.camera.cx, s.v, s.d);
    if (std::hypot(point.x() - camera.x(), point.z() - camera.z()) > kReach) continue;
    Sum& sum = seen[{cell_index(point.x()), cell_index(point.z())}];
    sum.height += point.y();
    ++sum.count;
  }
  for (const auto& [place, sum] : seen) {
    const double height = sum.height / sum.count;
    Cell& cell = cells_[place];
    if (cell.frames == 0 || std::abs(cell.height - height) > kSameSurface) cell = {height, 0, frame_};
    cell.frames = std::min(cell.frames + 1, kMaxFrames);
    cell.height += (height - cell.height) / cell.frames;
    cell.last_frame = frame_;
  }
  std::erase_if(cells_, [&](const auto& entry) {
    const auto& [place, cell] = entry;
    return std::hypot((place.first + 0.5) * kCell - camera.x(), (place.second + 0.5) * kCell - camera.z()) > kForget;
  });
}

std::optional<double> Footing::height_m() const {
  const Eigen::Vector3d camera = start_from_camera_.translation();
  const int reach = cell_index(kFoot) + 1;
  const int column = cell_index(camera.x());
  const int row = cell_index(camera.z());
  std::vector<double> heights;
  for (int dx = -reach; dx <= reach; ++dx) {
    for (int dz = -reach; dz <= reach; ++dz) {
      const auto cell = cells_.find({column + dx, row + dz});
      if (cell == cells_.end()) continue;
      if (std::hypot((cell->first.first + 0.5) * kCell - camera.x(), (cell->first.second + 0.5) * kCell - camera.z()) > kFoot)
        continue;
      heights.push_back(cell->second.height - camera.y());
    }
  }
  if (heights.size() < kMinCells) return std::nullopt;
  const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
  std::ranges::nth_element(heights, middle);
  return *middle;
}

}  // namespace brink
