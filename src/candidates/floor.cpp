#include "candidates/floor.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <Eigen/LU>

#include "evenly_spread.hpp"

namespace brink {
namespace {

constexpr double kCell = 0.12;         // m: less than half a tread, so that steps do not look like walls
constexpr double kReach = 10.0;        // m from the camera: beyond that disparities tell no steps
constexpr int kTargetPixels = 8000;    // of a region, evenly spread
constexpr int kFewestInCell = 3;       // pixels
constexpr std::size_t kFewestCells = 8;
constexpr double kWallSpread = 0.10;   // m, standard deviation of the depths in one cell
constexpr double kOnSurface = 0.10;    // m off a surface: half a step, and noise
constexpr double kFirstStep = 0.35;    // m: the highest tread that is seen lies no deeper
constexpr double kFlight = 0.45;       // m: three steps of 15 cm
constexpr double kLeastSlope = 20.0;   // degrees
constexpr double kGreatestSlope = 42.0;
constexpr int kHypotheses = 300;
constexpr std::size_t kMostCells = 400;  // that hypotheses are tested on

/// Ahead and to the right of the camera's foot, and how deep below the ground, m.
using Place = Eigen::Vector3d;

struct Cells {
  std::vector<Place> floor;
  std::size_t all = 0;  ///< with those that show walls
};

class Grid {
 public:
  void add(double ahead, double right, double depth) {
    if (!(ahead >= 0.0 && ahead < kReach && std::abs(right) < kReach)) return;
    const int row = static_cast<int>(ahead / kCell);
    const int column = static_cast<int>((right + kReach) / kCell);
    Sums& cell = cells_[static_cast<std::size_t>(row * kColumns + column)];
    ++cell.count;
    cell.sum += Place(ahead, right, depth);
    cell.depth2 += depth * depth;
  }
  [[nodiscard]] Cells collect() const {
    Cells cells;
    for (const Sums& cell : cells_) {
      if (cell.count < kFewestInCell) continue;
      ++cells.all;
      const Place mean = cell.sum / cell.count;
      if (cell.depth2 / cell.count - mean.z() * mean.z() <= kWallSpread * kWallSpread) cells.floor.push_back(mean);
    }
    return cells;
  }

 private:
  struct Sums {
    int count = 0;
    Place sum = Place::Zero();
    double depth2 = 0.0;
  };
  static constexpr int kRows = static_cast<int>(kReach / kCell) + 1;
  static constexpr int kColumns = static_cast<int>(2.0 * kReach / kCell) + 1;
  std::vector<Sums> cells_ = std::vector<Sums>(static_cast<std::size_t>(kRows) * kColumns);
};

/// Whether so many depths fall from near the ground by a flight; the outermost twentieth may be anything.
bool is_flight(std::vector<double>& depths) {
  std::ranges::sort(depths);
  const std::size_t tail = depths.size() / 20;
  const double first = depths[tail];
  return first <= kFirstStep && depths[depths.size() - 1 - tail] - first >= kFlight;
}

/// The most places that lie on one plane which falls away as stairs do.
std::size_t count_on_stairs(const std::vector<Place>& places) {
  const auto slope_of = [](double degrees) { return std::tan(degrees * std::numbers::pi / 180.0); };
  const double least = slope_of(kLeastSlope);
  const double greatest = slope_of(kGreatestSlope);
  std::size_t most = 0;
  std::vector<double> depths;
  std::mt19937 random(1);
  const auto draw = [&] { return places[random() % places.size()]; };
  for (int i = 0; i < kHypotheses; ++i) {
    const Place a = draw();
    const Eigen::Vector3d normal = (draw() - a).cross(draw() - a);
    const double steepness = normal.head<2>().norm() / std::abs(normal.z());  // of a plane through one place twice: no number
    if (!(steepness >= least && steepness <= greatest)) continue;
    depths.clear();
    for (const Place& place : places) {
      if (std::abs(normal.dot(place - a) / normal.z()) <= kOnSurface) depths.push_back(place.z());
    }
    if (depths.size() > most && is_flight(depths)) most = depths.size();
  }
  return most;
}

/// The most places that lie on one level.
std::size_t count_on_level(const std::vector<Place>& places) {
  std::vector<double> depths;
  for (const Place& place : places) depths.push_back(place.z());
  std::ranges::sort(depths);
  std::size_t most = 0;
  std::size_t lowest = 0;
  for (std::size_t i = 0; i < depths.size(); ++i) {
    while (depths[i] - depths[lowest] > 2.0 * kOnSurface) ++lowest;
    most = std::max(most, i - lowest + 1);
  }
  return most;
}

}  // namespace

Floor measure_floor(const Region& region, const cv::Mat1f& disparity, const cv::Mat1f& elevation, const StereoCamera& camera,
                    const GroundPose& pose) {
  Grid grid;
  for (const cv::Point& in_region : spread_evenly(region.mask, kTargetPixels)) {
    const cv::Point p = in_region + region.box.tl();
    const Eigen::Vector3d point = camera.triangulate(p.x, p.y, disparity(p));
    grid.add(pose.forward.dot(point), pose.right.dot(point), -elevation(p));
  }
  const Cells cells = grid.collect();
  if (cells.floor.size() < kFewestCells) return {};
  std::vector<Place> some;  // evenly spread
  const std::size_t step = (cells.floor.size() + kMostCells - 1) / kMostCells;
  for (std::size_t i = 0; i < cells.floor.size(); i += step) some.push_back(cells.floor[i]);
  const double weight = static_cast<double>(step) / static_cast<double>(cells.all);
  return {weight * static_cast<double>(count_on_stairs(some)), weight * static_cast<double>(count_on_level(some))};
}

}  // namespace brink
