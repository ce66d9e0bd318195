#include "candidates/region.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "candidates/grow.hpp"
#include "joined.hpp"
#include "scan.hpp"

namespace brink {
namespace {

/// Set pixels side by side in a row: the columns [begin, end).
struct Run {
  int row;
  int begin;
  int end;
  std::size_t first;  ///< an earlier run of the same region, at last its first one; the first one tells itself
};

void connect(std::vector<Run>& runs, std::size_t a, std::size_t b) {
  a = find_first(runs, a, &Run::first);
  b = find_first(runs, b, &Run::first);
  runs[std::max(a, b)].first = std::min(a, b);
}

/// All runs of a mask row by row, connected with those that they touch in the row above.
std::vector<Run> find_runs(const cv::Mat1b& mask) {
  std::vector<Run> runs;
  std::size_t above_first = 0;  // the runs of the row above are those from here to row_first
  for (int v = 0; v < mask.rows; ++v) {
    const uchar* const row = mask[v];
    const uchar* const row_end = row + mask.cols;
    const std::size_t row_first = runs.size();
    std::size_t above = above_first;
    for (const uchar* begin = find_set(row, row_end); begin != row_end;) {
      const uchar* const end = find_value(begin, row_end, 0);
      const Run run{v, static_cast<int>(begin - row), static_cast<int>(end - row), runs.size()};
      runs.push_back(run);
      while (above < row_first && runs[above].end < run.begin) ++above;
      for (std::size_t i = above; i < row_first && runs[i].begin <= run.end; ++i) connect(runs, i, run.first);
      begin = find_set(end, row_end);
    }
    above_first = row_first;
  }
  return runs;
}

/// What belongs to one first run.
struct Extent {
  int area_px = 0;
  int left = std::numeric_limits<int>::max();
  int right = 0;  ///< the column after the last one
  int bottom = 0;
  std::size_t region = 0;  ///< its place in the result, from 1 on; 0 = too small
};

/// Sets a run in the region's masks.
void draw(const Run& run, const cv::Size& picture, Region& region) {
  const cv::Point origin = region.box.tl();
  uchar* const row = region.mask[run.row - origin.y];
  std::fill(row + run.begin - origin.x, row + run.end - origin.x, uchar{255});
  const int left = std::max(run.begin - 1, 0) - origin.x;
  const int right = std::min(run.end + 1, picture.width) - origin.x;
  for (int v = std::max(run.row - 1, 0); v <= std::min(run.row + 1, picture.height - 1); ++v) {
    uchar* const wider = region.dilated[v - origin.y];
    std::fill(wider + left, wider + right, uchar{255});
  }
}

}  // namespace

// A region's first run comes before those of later regions, so that their order is that of their first pixels.
std::vector<Region> find_regions(const cv::Mat1b& mask, int min_area_px) {
  std::vector<Run> runs = find_runs(mask);
  std::vector<Extent> extents(runs.size());
  for (Run& run : runs) {
    run.first = runs[run.first].first;  // of an earlier run, which knows by now
    Extent& extent = extents[run.first];
    extent.area_px += run.end - run.begin;
    extent.left = std::min(extent.left, run.begin);
    extent.right = std::max(extent.right, run.end);
    extent.bottom = run.row + 1;
  }
  std::vector<Region> regions;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    Extent& extent = extents[i];
    if (extent.area_px == 0 || extent.area_px < min_area_px) continue;
    Region region;
    region.box = {extent.left - 1, runs[i].row - 1, extent.right - extent.left + 2, extent.bottom - runs[i].row + 2};
    region.mask = cv::Mat1b(region.box.size(), uchar{0});
    region.dilated = cv::Mat1b(region.box.size(), uchar{0});
    region.area_px = extent.area_px;
    regions.push_back(std::move(region));
    extent.region = regions.size();
  }
  for (const Run& run : runs) {
    if (const std::size_t region = extents[run.first].region; region > 0) draw(run, mask.size(), regions[region - 1]);
  }
  return regions;
}

std::vector<cv::Point> trace_contour(const cv::Mat1b& mask, const cv::Rect& box) {
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(mask, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE, box.tl());
  if (contours.empty()) return {};
  return *std::ranges::max_element(contours, {}, &std::vector<cv::Point>::size);
}

std::vector<cv::Point> ring_pixels(const Region& region, const cv::Mat1b& passable, int gap_px) {
  const cv::Rect picture(cv::Point(0, 0), passable.size());
  const cv::Rect in_picture = region.box & picture;
  const cv::Rect around(region.box.tl() - cv::Point(gap_px, gap_px), region.box.br() + cv::Point(gap_px, gap_px));
  const cv::Rect visible = around & picture;
  cv::Mat1b start(visible.size(), uchar{0});
  region.mask(in_picture - region.box.tl()).copyTo(start(in_picture - visible.tl()));
  const cv::Mat1b growth = grow(start, passable(visible), gap_px);
  constexpr auto kRing = static_cast<uchar>(Growth::ring);
  std::vector<cv::Point> pixels;
  for (int v = 0; v < visible.height; ++v) {
    const uchar* const row = growth[v];
    const uchar* const end = row + visible.width;
    for (const uchar* place = find_value(row, end, kRing); place != end; place = find_value(place + 1, end, kRing)) {
      pixels.emplace_back(visible.x + static_cast<int>(place - row), visible.y + v);
    }
  }
  return pixels;
}

}  // namespace brink
