#include "candidates/region.hpp"

#include <algorithm>

#include <opencv2/imgproc.hpp>

namespace brink {
namespace {

/// @param labels of the part of the picture that begins at `origin`, and so for `tight`.
Region cut_out(const cv::Mat1i& labels, int label, const cv::Rect& tight, int area_px, cv::Point origin, cv::Size picture) {
  Region region;
  region.box = cv::Rect(tight.x - 1, tight.y - 1, tight.width + 2, tight.height + 2) + origin;
  region.area_px = area_px;
  const cv::Mat1b inside(labels(tight) == label);
  cv::copyMakeBorder(inside, region.mask, 1, 1, 1, 1, cv::BORDER_CONSTANT | cv::BORDER_ISOLATED, cv::Scalar(0));
  cv::Mat1b dilated;
  cv::dilate(region.mask, dilated, cv::Mat(), cv::Point(-1, -1), 1, cv::BORDER_CONSTANT | cv::BORDER_ISOLATED, cv::Scalar(0));
  const cv::Rect in_picture = region.box & cv::Rect(cv::Point(0, 0), picture);
  const cv::Rect in_cut = in_picture - region.box.tl();
  region.dilated = cv::Mat1b::zeros(dilated.size());
  dilated(in_cut).copyTo(region.dilated(in_cut));
  return region;
}

/// Column of the first pixel in the first row of a region.
int first_column(const Region& region) {
  const uchar* row = region.mask[1];
  return region.box.x + static_cast<int>(std::find(row, row + region.mask.cols, 255) - row);
}

}  // namespace

std::vector<Region> find_regions(const cv::Mat1b& mask, int min_area_px) {
  if (mask.empty()) return {};
  const cv::Rect part = cv::boundingRect(mask);
  if (part.empty()) return {};
  cv::Mat1i labels;
  cv::Mat1i stats;
  cv::Mat1d centroids;
  const int count = cv::connectedComponentsWithStats(mask(part), labels, stats, centroids, 8, CV_32S);
  std::vector<Region> regions;
  for (int label = 1; label < count; ++label) {
    const int area = stats(label, cv::CC_STAT_AREA);
    if (area < min_area_px) continue;
    const cv::Rect tight(stats(label, cv::CC_STAT_LEFT), stats(label, cv::CC_STAT_TOP), stats(label, cv::CC_STAT_WIDTH),
                         stats(label, cv::CC_STAT_HEIGHT));
    regions.push_back(cut_out(labels, label, tight, area, part.tl(), mask.size()));
  }
  // OpenCV numbers regions by blocks of pixels; ours is an order that a person can foretell.
  std::ranges::sort(regions, [](const Region& x, const Region& y) {
    return x.box.y != y.box.y ? x.box.y < y.box.y : first_column(x) < first_column(y);
  });
  return regions;
}

std::vector<cv::Point> trace_contour(const cv::Mat1b& mask, const cv::Rect& box) {
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(mask, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE, box.tl());
  if (contours.empty()) return {};
  return *std::ranges::max_element(contours, {}, &std::vector<cv::Point>::size);
}

std::vector<cv::Point> ring_pixels(const Region& region, const cv::Mat1b& passable, int gap_px) {
  const cv::Rect in_picture = region.box & cv::Rect(cv::Point(0, 0), passable.size());
  const cv::Rect around =
      cv::Rect(region.box.tl() - cv::Point(gap_px, gap_px), region.box.size() + cv::Size(2 * gap_px, 2 * gap_px)) &
      cv::Rect(cv::Point(0, 0), passable.size());
  cv::Mat1b grown(around.size(), uchar{0});
  region.mask(in_picture - region.box.tl()).copyTo(grown(in_picture - around.tl()));
  const cv::Mat1b start = grown.clone();
  cv::Mat1b wider;
  for (int i = 0; i < gap_px; ++i) {
    cv::dilate(grown, wider, cv::Mat());
    grown = (wider & passable(around)) | start;
  }
  cv::dilate(grown, wider, cv::Mat());
  std::vector<cv::Point> pixels;
  for (int v = 0; v < around.height; ++v) {
    for (int u = 0; u < around.width; ++u) {
      if (wider(v, u) != 0 && grown(v, u) == 0) pixels.emplace_back(around.x + u, around.y + v);
    }
  }
  return pixels;
}

}  // namespace brink
