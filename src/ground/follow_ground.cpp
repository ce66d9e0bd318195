#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "brink/ground.hpp"

namespace brink {
namespace {

constexpr double kHighest = 1.0;  // m above or below the plane: farther from it no surface is looked at
constexpr int kLeastPoints = 4;   // in a cell
constexpr double kNoisePx = 0.3;  // of a cell's median disparity: its pixels err together
constexpr double kNearlyAll = 0.8;
constexpr double kEnclosed = 0.7;    // share of the cells around
constexpr double kAgreement = 0.04;  // m: this near to the plane a surface is on it
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

/// The ground seen from above in square cells: x along GroundPose::right, y along GroundPose::forward, m.
struct Grid {
  double cell_m = 0.0;
  double left_m = 0.0;  ///< x of the first column's edge; rows begin at y = 0
  cv::Size size;

  /// Column and row of a point; cells' middles are whole numbers.
  [[nodiscard]] cv::Point2d place(const Eigen::Vector3d& point, const GroundPose& pose) const {
    return {(pose.right.dot(point) - left_m) / cell_m - 0.5, pose.forward.dot(point) / cell_m - 0.5};
  }
  [[nodiscard]] bool contains(const cv::Point& cell) const { return cv::Rect(cv::Point(0, 0), size).contains(cell); }
};

/// What the points of each cell tell.
struct Cells {
  cv::Mat1f height;  ///< median elevation, m; NaN = too few points
  cv::Mat1f spread;  ///< from the lowest to the highest fifth of the elevations, m
  cv::Mat1f noise;   ///< standard deviation that the disparities' noise gives it, m
};

Grid make_grid(const GroundParams& params) {
  Grid grid;
  grid.cell_m = params.follow_cell_m;
  const int across = static_cast<int>(std::ceil(params.max_range_m / grid.cell_m));
  grid.size = {2 * across, across};
  grid.left_m = -across * grid.cell_m;
  return grid;
}

Cells collect(const cv::Mat1f& elevation, const cv::Mat1f& disparity, const Grid& grid, const GroundPose& pose,
              const StereoCamera& camera, int step) {
  std::vector<std::vector<float>> heights(static_cast<std::size_t>(grid.size.area()));
  const auto index = [&grid](int row, int column) {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(grid.size.width) + static_cast<std::size_t>(column);
  };
  Cells cells{cv::Mat1f(grid.size, kUnknown), cv::Mat1f(grid.size, 0.0F), cv::Mat1f(grid.size, 0.0F)};
  for (int v = step / 2; v < elevation.rows; v += step) {
    for (int u = step / 2; u < elevation.cols; u += step) {
      if (!(std::abs(elevation(v, u)) < kHighest)) continue;
      const double d = disparity(v, u);
      const cv::Point2d place = grid.place(camera.triangulate(u, v, d), pose);
      const cv::Point cell(cvRound(place.x), cvRound(place.y));
      if (!grid.contains(cell)) continue;
      heights[index(cell.y, cell.x)].push_back(elevation(v, u));
      cells.noise(cell) = static_cast<float>(kNoisePx * pose.height_m / d);
    }
  }
  for (int row = 0; row < grid.size.height; ++row) {
    for (int column = 0; column < grid.size.width; ++column) {
      std::vector<float>& all = heights[index(row, column)];
      if (all.size() < kLeastPoints) continue;
      std::ranges::sort(all);
      cells.height(row, column) = all[all.size() / 2];
      cells.spread(row, column) = all[all.size() * 4 / 5] - all[all.size() / 5];
    }
  }
  return cells;
}

double allowed_slope(const GroundParams& params) { return std::tan(params.follow_slope_deg * std::numbers::pi / 180.0); }

/// Whether a cell holds one surface: no edge runs through it.
bool is_even(const cv::Point& cell, const Cells& cells, const Grid& grid, const GroundParams& params) {
  return cells.spread(cell) <= allowed_slope(params) * grid.cell_m + 2.0 * cells.noise(cell);
}

/// Whether a cell goes on gently from nearly all followed ones in reach: past a steep step the nearest ones are too high.
bool goes_on(const cv::Point& cell, const Cells& cells, const cv::Mat1b& followed, const Grid& grid,
             const GroundParams& params) {
  const int reach = static_cast<int>(std::round(params.follow_reach_m / grid.cell_m));
  int agreeing = 0;
  int all = 0;
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      const cv::Point other = cell + cv::Point(dx, dy);
      if (!grid.contains(other) || followed(other) == 0) continue;
      const double gone = grid.cell_m * std::hypot(dx, dy);
      const double step = std::abs(cells.height(cell) - cells.height(other));
      ++all;
      agreeing += step <= allowed_slope(params) * gone + cells.noise(cell) ? 1 : 0;
    }
  }
  return agreeing >= kNearlyAll * all;
}

/// Cells of the ground: those on the plane, and what goes on gently from them.
cv::Mat1b follow(const Cells& cells, const Grid& grid, const GroundParams& params) {
  cv::Mat1b followed(grid.size, uchar{0});
  std::queue<cv::Point> edge;
  for (int row = 0; row < grid.size.height; ++row) {
    for (int column = 0; column < grid.size.width; ++column) {
      const cv::Point cell(column, row);
      if (!(std::abs(cells.height(cell)) <= kAgreement) || !is_even(cell, cells, grid, params)) continue;
      followed(cell) = 255;
      edge.push(cell);
    }
  }
  while (!edge.empty()) {
    const cv::Point from = edge.front();
    edge.pop();
    for (const cv::Point& step : {cv::Point(0, 1), cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, -1)}) {
      const cv::Point cell = from + step;
      if (!grid.contains(cell) || followed(cell) != 0 || std::isnan(cells.height(cell))) continue;
      if (!is_even(cell, cells, grid, params) || !goes_on(cell, cells, followed, grid, params)) continue;
      followed(cell) = 255;
      edge.push(cell);
    }
  }
  return followed;
}

/// Share of the cells around a part that lie on the plane.
double share_on_plane(const cv::Mat1b& part, const cv::Mat1b& on_plane) {
  cv::Mat1b ring;
  cv::dilate(part, ring, cv::Mat());
  ring -= part;
  return static_cast<double>(cv::countNonZero(ring & on_plane)) / cv::countNonZero(ring);
}

/// Takes back what is no bend of the ground: what is off the plane over a small extent only, or with the plane all around it.
/// That is a dent, however gentle; a ramp goes on to where the view ends.
void drop_dents(cv::Mat1b& followed, const Cells& cells, const Grid& grid, const GroundParams& params) {
  const cv::Mat1b on_plane((cv::abs(cells.height) <= kAgreement) & followed);
  const cv::Mat1b off(followed & ~on_plane);
  cv::Mat1i labels;
  cv::Mat1i stats;
  cv::Mat1d centroids;
  const int count = cv::connectedComponentsWithStats(off, labels, stats, centroids, 8, CV_32S);
  for (int label = 1; label < count; ++label) {
    const int extent = std::min(stats(label, cv::CC_STAT_WIDTH), stats(label, cv::CC_STAT_HEIGHT));
    const cv::Mat1b part(labels == label);
    if (extent * grid.cell_m < params.follow_extent_m || share_on_plane(part, on_plane) > kEnclosed) followed.setTo(0, part);
  }
}

/// The ground's height over the plane in every cell: where it was not followed, that of the nearest cell where it was.
cv::Mat1f spread(const cv::Mat1b& followed, const Cells& cells) {
  cv::Mat1f surface(followed.size(), 0.0F);
  if (cv::countNonZero(followed) == 0) return surface;
  const cv::Mat1b other(followed == 0);
  cv::Mat1f distance;
  cv::Mat1i labels;
  cv::distanceTransform(other, distance, labels, cv::DIST_L2, cv::DIST_MASK_5, cv::DIST_LABEL_PIXEL);
  std::vector<float> height_of(static_cast<std::size_t>(cv::countNonZero(followed)) + 1, 0.0F);
  for (int row = 0; row < followed.rows; ++row) {
    for (int column = 0; column < followed.cols; ++column) {
      const float height = cells.height(row, column);
      const bool on_plane = std::abs(height) <= kAgreement;
      if (followed(row, column) != 0) height_of[static_cast<std::size_t>(labels(row, column))] = on_plane ? 0.0F : height;
    }
  }
  for (int row = 0; row < followed.rows; ++row) {
    for (int column = 0; column < followed.cols; ++column) {
      surface(row, column) = height_of[static_cast<std::size_t>(labels(row, column))];
    }
  }
  cv::blur(surface, surface, {3, 3}, {-1, -1}, cv::BORDER_REPLICATE);
  return surface;
}

float sample(const cv::Mat1f& surface, const cv::Point2d& place) {
  const double x = std::clamp(place.x, 0.0, surface.cols - 1.001);
  const double y = std::clamp(place.y, 0.0, surface.rows - 1.001);
  const int column = static_cast<int>(x);
  const int row = static_cast<int>(y);
  const auto right = static_cast<float>(x - column);
  const auto down = static_cast<float>(y - row);
  return (1.0F - down) * ((1.0F - right) * surface(row, column) + right * surface(row, column + 1)) +
         down * ((1.0F - right) * surface(row + 1, column) + right * surface(row + 1, column + 1));
}

}  // namespace

cv::Mat1f follow_ground(const cv::Mat1f& elevation, const cv::Mat1f& disparity, const GroundPose& pose,
                        const StereoCamera& camera, const GroundParams& params) {
  if (elevation.size() != disparity.size()) {
    throw std::invalid_argument(fmt::format("sizes differ: elevation {}x{}, disparity {}x{}", elevation.cols, elevation.rows,
                                            disparity.cols, disparity.rows));
  }
  params.validate();
  constexpr double kTargetSamples = 120000.0;
  const int step =
      std::max(1, static_cast<int>(std::lround(std::sqrt(static_cast<double>(elevation.total()) / kTargetSamples))));
  const Grid grid = make_grid(params);
  const Cells cells = collect(elevation, disparity, grid, pose, camera, step);
  cv::Mat1b followed = follow(cells, grid, params);
  drop_dents(followed, cells, grid, params);
  const cv::Mat1f surface = spread(followed, cells);
  cv::Mat1f over_ground(elevation.size(), kUnknown);
  for (int v = 0; v < elevation.rows; ++v) {
    for (int u = 0; u < elevation.cols; ++u) {
      if (std::isnan(elevation(v, u))) continue;
      over_ground(v, u) = elevation(v, u) - sample(surface, grid.place(camera.triangulate(u, v, disparity(v, u)), pose));
    }
  }
  return over_ground;
}

}  // namespace brink
