#include "candidates/floor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "evenly_spread.hpp"

namespace brink {
namespace {

constexpr double kCell = 0.12;       // m: less than half a tread
constexpr double kReach = 10.0;      // m from the camera: beyond that disparities tell no steps
constexpr int kTargetPixels = 8000;  // of a region, evenly spread
constexpr int kFewestInCell = 3;     // pixels
constexpr std::size_t kFewestCells = 8;
constexpr int kFewestAround = 3;      // of the 8 cells around one
constexpr double kWallSpread = 0.12;  // m, standard deviation of the depths in a cell: two treads have 0.11 at most

constexpr double kLeastSlope = 20.0;  // degrees
constexpr double kGreatestSlope = 42.0;
constexpr double kOnSurface = 0.10;  // m off a surface: half a step, and noise
// Of the angle between a surface and the ray that sees it. What a matcher smears from a rim down to a bottom lies along rays.
constexpr double kLeastSine = 0.10;
constexpr double kFirstStep = 0.35;  // m: the highest tread that is seen lies no deeper
constexpr double kFlight = 0.45;     // m: three steps of 15 cm
constexpr double kTail = 0.05;       // share of a flight's places that may be anything, at either end
constexpr double kQuarter = 0.4;     // of a flight's height, from either end, in which at least a quarter of its places lie
constexpr int kHypotheses = 300;
constexpr std::size_t kMostCells = 300;  // that hypotheses are tested on

/// Ahead and to the right of the camera's foot, and how deep below the ground, m.
using Place = Eigen::Vector3d;

struct Cells {
  std::size_t all = 0;         ///< with those that show walls
  std::vector<Place> floor;    ///< the others
  std::vector<Place> surface;  ///< those of them with others around: a strip that is one cell wide is a side wall
};

class Grid {
 public:
  void add(double ahead, double right, double depth) {
    if (!(ahead >= 0.0 && ahead < kReach && std::abs(right) < kReach)) return;
    Sums& cell = cells_(static_cast<int>(ahead / kCell) + 1, static_cast<int>((right + kReach) / kCell) + 1);
    ++cell.count;
    cell.sum += Place(ahead, right, depth);
    cell.depth2 += depth * depth;
  }
  [[nodiscard]] Cells collect() const {
    Cells cells;
    for (int row = 1; row + 1 < cells_.rows(); ++row) {
      for (int column = 1; column + 1 < cells_.cols(); ++column) {
        const Sums& cell = cells_(row, column);
        if (cell.count < kFewestInCell) continue;
        ++cells.all;
        if (!cell.is_floor()) continue;
        cells.floor.emplace_back(cell.sum / cell.count);
        if (count_floor_around(row, column) >= kFewestAround) cells.surface.push_back(cells.floor.back());
      }
    }
    return cells;
  }

 private:
  struct Sums {
    int count = 0;
    Place sum = Place::Zero();
    double depth2 = 0.0;
    [[nodiscard]] bool is_floor() const {
      if (count < kFewestInCell) return false;
      const double mean = sum.z() / count;
      return depth2 / count - mean * mean <= kWallSpread * kWallSpread;
    }
  };
  [[nodiscard]] int count_floor_around(int row, int column) const {
    int count = -1;  // itself
    for (int i = row - 1; i <= row + 1; ++i) {
      for (int j = column - 1; j <= column + 1; ++j) count += cells_(i, j).is_floor() ? 1 : 0;
    }
    return count;
  }

  static constexpr int kRows = static_cast<int>(kReach / kCell) + 3;  // with a margin
  static constexpr int kColumns = static_cast<int>(2.0 * kReach / kCell) + 3;
  Eigen::Array<Sums, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> cells_{kRows, kColumns};
};

/// Counts of depths, in bins of a quarter of what lies on one level.
class DepthCounts {
 public:
  void add(double depth) {
    ++bins_[static_cast<std::size_t>(std::clamp(depth / kBin, 0.0, kBins - 1.0))];
    ++all_;
  }
  [[nodiscard]] int all() const { return all_; }
  /// The depth that so many of all do not exceed.
  [[nodiscard]] double quantile(double share) const {
    int count = 0;
    std::size_t bin = 0;
    while (bin + 1 < bins_.size() && (count += bins_[bin]) <= share * all_) ++bin;
    return kBin * static_cast<double>(bin);
  }
  /// The most of them on one level.
  [[nodiscard]] int level() const {
    int most = 0;
    int here = 0;
    for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
      here += bins_[bin] - (bin >= kPerLevel ? bins_[bin - kPerLevel] : 0);
      most = std::max(most, here);
    }
    return most;
  }

 private:
  static constexpr std::size_t kPerLevel = 4;
  static constexpr double kBin = 2.0 * kOnSurface / kPerLevel;
  static constexpr double kBins = 100.0;  // to 5 m; deeper ones are in the last
  std::array<int, static_cast<std::size_t>(kBins)> bins_{};
  int all_ = 0;
};

/// Whether depths fall from near the ground by a flight, and evenly: a wall and a bottom do not.
bool is_flight(const DepthCounts& depths) {
  const double first = depths.quantile(kTail);
  const double fall = depths.quantile(1.0 - kTail) - first;
  return first <= kFirstStep && fall >= kFlight && depths.quantile(0.25) <= first + kQuarter * fall &&
         depths.quantile(0.75) >= first + (1.0 - kQuarter) * fall;
}

/// The most places that lie on one plane which falls away as stairs do.
int count_on_stairs(const std::vector<Place>& places, double height_m) {
  const auto slope_of = [](double degrees) { return std::tan(degrees * std::numbers::pi / 180.0); };
  const double least = slope_of(kLeastSlope);
  const double greatest = slope_of(kGreatestSlope);
  int most = 0;
  std::mt19937 random(1);
  const auto draw = [&] { return places[random() % places.size()]; };
  for (int i = 0; i < kHypotheses; ++i) {
    const Place a = draw();
    const Place b = draw();
    const Place c = draw();
    const Place normal = (b - a).cross(c - a);
    const double steepness = normal.head<2>().norm() / std::abs(normal.z());  // of a plane through one place twice: no number
    if (!(steepness >= least && steepness <= greatest)) continue;
    const Place ray = a - Place(0.0, 0.0, -height_m);
    if (std::abs(normal.dot(ray)) < kLeastSine * normal.norm() * ray.norm()) continue;
    DepthCounts depths;
    for (const Place& place : places) {
      if (std::abs(normal.dot(place - a)) <= kOnSurface * std::abs(normal.z())) depths.add(place.z());
    }
    if (depths.all() > most && is_flight(depths)) most = depths.all();
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
  DepthCounts depths;
  for (const Place& place : cells.floor) depths.add(place.z());
  Floor floor;
  floor.level_share = static_cast<double>(depths.level()) / static_cast<double>(cells.all);
  if (cells.surface.size() < kFewestCells) return floor;
  std::vector<Place> some;  // evenly spread
  const std::size_t step = (cells.surface.size() + kMostCells - 1) / kMostCells;
  for (std::size_t i = 0; i < cells.surface.size(); i += step) some.push_back(cells.surface[i]);
  floor.stairs_share = static_cast<double>(step) * count_on_stairs(some, pose.height_m) / static_cast<double>(cells.all);
  return floor;
}

}  // namespace brink
