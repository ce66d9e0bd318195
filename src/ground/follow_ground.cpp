#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <numeric>
#include <queue>
#include <span>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "brink/ground.hpp"
#include "ground/cells_simd.hpp"
#include "select_nth.hpp"

namespace brink {
namespace {

constexpr double kHighest = 1.0;  // m above or below the plane: farther from it no surface is looked at
constexpr int kLeastPoints = 4;   // in a cell
constexpr double kSigmas = 2.0;   // of a cell's median: its pixels err together
constexpr double kNearlyAll = 0.8;
constexpr double kEnclosed = 0.7;       // share of the cells around
constexpr double kFromTheStart = 0.65;  // share of its height that a kerb has where it begins
constexpr double kAgreement = 0.04;     // m: this near to the plane a surface is on it
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

/// The ground seen from above, each point a cell.
struct Grid {
  double cell_m = 0.0;
  cv::Size size;

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
  return grid;
}

/// An elevation in a cell.
struct Height {
  int cell;
  float elevation_m;
};

Cells collect(const cv::Mat1f& disparity, const Grid& grid, const GroundSurface& flat, const StereoCamera& camera, int step) {
  const CellGrid places{grid.cell_m, -grid.size.height * grid.cell_m, grid.size.width, grid.size.height};
  const int first = step / 2;
  const int count = std::max(0, (disparity.cols - first + step - 1) / step);
  std::vector<float> sampled(static_cast<std::size_t>(count));
  std::vector<int> cell_of(static_cast<std::size_t>(count));
  std::vector<float> elevation_m(static_cast<std::size_t>(count));
  std::vector<Height> heights;
  heights.reserve(cell_of.size() * static_cast<std::size_t>(disparity.rows / step + 1));
  cv::Mat1f last_disparity(grid.size, 0.0F);
  std::vector<std::size_t> ends(static_cast<std::size_t>(grid.size.area()) + 1, 0);  // counts of the cells before, at first
  for (int v = first; v < disparity.rows; v += step) {
    const float* const row = disparity[v] + first;
    for (std::size_t i = 0; i < sampled.size(); ++i) sampled[i] = row[i * static_cast<std::size_t>(step)];
    place_in_cells({sampled.data(), v, first, step, count}, camera, flat.pose, places, kHighest, cell_of.data(),
                   elevation_m.data());
    for (std::size_t i = 0; i < cell_of.size(); ++i) {
      if (cell_of[i] < 0) continue;
      const auto cell = static_cast<std::size_t>(cell_of[i]);
      heights.push_back({cell_of[i], elevation_m[i]});
      ++ends[cell + 1];
      last_disparity.ptr<float>()[cell] = sampled[i];
    }
  }
  std::partial_sum(ends.begin(), ends.end(), ends.begin());
  std::vector<float> grouped(heights.size());
  for (const Height& height : heights) grouped[ends[static_cast<std::size_t>(height.cell)]++] = height.elevation_m;

  Cells cells{cv::Mat1f(grid.size, kUnknown), cv::Mat1f(grid.size, 0.0F), cv::Mat1f(grid.size, 0.0F)};
  std::size_t begin = 0;
  for (int row = 0; row < grid.size.height; ++row) {
    for (int column = 0; column < grid.size.width; ++column) {
      const int cell = row * grid.size.width + column;
      const std::size_t end = ends[static_cast<std::size_t>(cell)];
      const std::span<float> all(grouped.data() + begin, end - begin);
      begin = end;
      if (const double d = last_disparity(row, column); d > 0.0) {
        cells.noise(row, column) = static_cast<float>(kSigmas * flat.disparity_sd_px * flat.pose.height_m / d);
      }
      if (all.size() < kLeastPoints) continue;
      float* const middle = all.data() + all.size() / 2;
      float* const low = all.data() + all.size() / 5;
      float* const high = all.data() + all.size() * 4 / 5;
      float* const last = all.data() + all.size();
      select_nth(all.data(), middle, last);
      select_nth(all.data(), low, middle);
      select_nth(middle + 1, high, last);
      cells.height(row, column) = *middle;
      cells.spread(row, column) = *high - *low;
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

/// The line through a part's heights over their distance from the plane's edge: how high it is at that edge, and on average.
/// A ramp begins with a bend, near 0; a kerb has most of its height from the start, also where a matcher smoothed its step.
struct Profile {
  double start_m = 0.0;
  double mean_m = 0.0;
};

Profile compute_profile(const cv::Mat1b& part, const cv::Mat1f& cells_from_plane, const Cells& cells, const Grid& grid) {
  constexpr double kNear = 1.5;  // m from the plane's edge
  double n = 0.0;
  double sum_x = 0.0;
  double sum_y = 0.0;
  double sum_xx = 0.0;
  double sum_xy = 0.0;
  for (int row = 0; row < part.rows; ++row) {
    for (int column = 0; column < part.cols; ++column) {
      const double x = grid.cell_m * cells_from_plane(row, column);
      if (part(row, column) == 0 || x > kNear) continue;
      const double y = cells.height(row, column);
      n += 1.0;
      sum_x += x;
      sum_y += y;
      sum_xx += x * x;
      sum_xy += x * y;
    }
  }
  const double spread = n * sum_xx - sum_x * sum_x;
  if (n == 0.0) return {};
  if (spread < 1e-9 * n * n) return {sum_y / n, sum_y / n};
  return {(sum_y * sum_xx - sum_x * sum_xy) / spread, sum_y / n};
}

/// Takes back what is no bend of the ground: what is off the plane over a small extent only, or with the plane all around it,
/// which is a dent, however gentle (a ramp goes on to where the view ends); and what begins with a step.
void drop_what_is_no_bend(cv::Mat1b& followed, const Cells& cells, const Grid& grid, const GroundParams& params) {
  const cv::Mat1b on_plane((cv::abs(cells.height) <= kAgreement) & followed);
  cv::Mat1f cells_from_plane;
  cv::distanceTransform(~on_plane, cells_from_plane, cv::DIST_L2, cv::DIST_MASK_5);
  for (const cv::Mat1b& side : {cv::Mat1b(cells.height < -kAgreement), cv::Mat1b(cells.height > kAgreement)}) {
    cv::Mat1i labels;
    cv::Mat1i stats;
    cv::Mat1d centroids;
    const int count = cv::connectedComponentsWithStats(side & followed, labels, stats, centroids, 8, CV_32S);
    for (int label = 1; label < count; ++label) {
      const int extent = std::min(stats(label, cv::CC_STAT_WIDTH), stats(label, cv::CC_STAT_HEIGHT));
      const cv::Mat1b part(labels == label);
      const bool dent = extent * grid.cell_m < params.follow_extent_m || share_on_plane(part, on_plane) > kEnclosed;
      const Profile profile = compute_profile(part, cells_from_plane, cells, grid);
      const bool step = std::abs(profile.start_m) > std::max(params.follow_step_m, kFromTheStart * std::abs(profile.mean_m));
      if (dent || step) followed.setTo(0, part);
    }
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

}  // namespace

GroundSurface follow_ground(const cv::Mat1f& disparity, const GroundSurface& flat, const StereoCamera& camera,
                            const GroundParams& params) {
  params.validate();
  constexpr double kTargetSamples = 120000.0;
  const int step =
      std::max(1, static_cast<int>(std::lround(std::sqrt(static_cast<double>(disparity.total()) / kTargetSamples))));
  const Grid grid = make_grid(params);
  const Cells cells = collect(disparity, grid, flat, camera, step);
  cv::Mat1b followed = follow(cells, grid, params);
  drop_what_is_no_bend(followed, cells, grid, params);
  GroundSurface surface = flat;
  surface.cell_m = grid.cell_m;
  surface.relief_m = spread(followed, cells);
  cv::minMaxLoc(surface.relief_m, &surface.lowest_m, &surface.highest_m);
  return surface;
}

}  // namespace brink
