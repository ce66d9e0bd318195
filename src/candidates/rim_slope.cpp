#include "candidates/rim_slope.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace brink {
namespace {

constexpr int kMarginPx = 20;       // how far around the region level ground is looked for, at least
constexpr int kFirstMarginPx = 16;  // most often it is as near as this
constexpr double kSteepQuantile = 0.75;

cv::Rect widened(const cv::Rect& box, int by) { return {box.x - by, box.y - by, box.width + 2 * by, box.height + 2 * by}; }

/// The pixels at the border of a region's deep part.
std::vector<cv::Point> find_deep_border(const Region& region, const cv::Mat1b& deep) {
  const cv::Rect box = region.box & cv::Rect(cv::Point(0, 0), deep.size());
  const cv::Mat1b deep_here(deep(box) & region.mask(box - region.box.tl()));
  cv::Mat1b border;
  cv::erode(deep_here, border, cv::Mat());
  cv::bitwise_xor(deep_here, border, border);
  std::vector<cv::Point> pixels;
  cv::findNonZero(border, pixels);
  for (cv::Point& p : pixels) p += box.tl();
  return pixels;
}

/// The set pixel of a part of a mask nearest to each of its pixels.
class NearestInPart {
 public:
  /// @param unset 0 = set; there must be one in the part.
  NearestInPart(const cv::Mat1b& unset, const cv::Rect& part) : part_(part) {
    cv::distanceTransform(unset(part), distance_, labels_, cv::DIST_L2, cv::DIST_MASK_5, cv::DIST_LABEL_PIXEL);
    const int set = part.area() - cv::countNonZero(unset(part));
    places_.resize(static_cast<std::size_t>(set) + 1);
    for (int v = part.y; v < part.br().y; ++v) {
      const uchar* const row = unset[v] + part.x;
      const int* const labels = labels_[v - part.y];
      for (int u = 0; u < part.width; ++u) {
        if (row[u] == 0) places_[static_cast<std::size_t>(labels[u])] = {part.x + u, v};
      }
    }
  }
  [[nodiscard]] int distance(const cv::Point& p) const { return static_cast<int>(std::ceil(distance_(p - part_.tl()))); }
  [[nodiscard]] cv::Point place(const cv::Point& p) const { return places_[static_cast<std::size_t>(labels_(p - part_.tl()))]; }

 private:
  cv::Rect part_;
  cv::Mat1f distance_;
  cv::Mat1i labels_;
  std::vector<cv::Point> places_;  ///< of the labels
};

/// The set pixel of a mask nearest to each of some pixels; empty when none is set. First in a part of the mask; what it leaves
/// open, as a pixel outside of it may be as near, in one that reaches as far as is needed.
std::vector<cv::Point> find_nearest(const std::vector<cv::Point>& pixels, const cv::Mat1b& unset, cv::Rect part) {
  const cv::Rect all(cv::Point(0, 0), unset.size());
  std::vector<cv::Point> nearest(pixels.size());
  std::vector<std::size_t> open(pixels.size());
  std::iota(open.begin(), open.end(), std::size_t{0});
  while (!open.empty()) {
    if (cv::countNonZero(unset(part)) == part.area()) {
      if (part == all) return {};
      part = widened(part, std::max(part.width, part.height)) & all;
      continue;
    }
    const NearestInPart found(unset, part);
    cv::Rect needed;
    std::erase_if(open, [&](std::size_t i) {
      const int distance = found.distance(pixels[i]);
      const cv::Rect reach = cv::Rect(pixels[i].x - distance, pixels[i].y - distance, 2 * distance + 1, 2 * distance + 1) & all;
      const bool is_told = (reach & part) == reach;
      if (is_told) {
        nearest[i] = found.place(pixels[i]);
      } else {
        needed |= reach;
      }
      return is_told;
    });
    part = needed;
  }
  return nearest;
}

/// For each of some pixels of a region the nearest level pixel; empty without any.
std::vector<cv::Point> find_nearest_level(std::vector<cv::Point> pixels, const Region& region, const cv::Mat1b& level) {
  const cv::Rect picture(cv::Point(0, 0), level.size());
  const cv::Rect around = widened(region.box, kMarginPx + std::max(region.box.width, region.box.height) / 2) & picture;
  cv::Mat1b unset(level(around) == 0);
  // Level specks inside the region are noise; its surroundings begin beyond the outer contour.
  const std::vector<std::vector<cv::Point>> outline{trace_contour(region.mask, region.box)};
  cv::drawContours(unset, outline, -1, cv::Scalar(255), cv::FILLED, cv::LINE_8, cv::noArray(), 0, -around.tl());
  for (cv::Point& p : pixels) p -= around.tl();
  std::vector<cv::Point> nearest = find_nearest(pixels, unset, (widened(region.box, kFirstMarginPx) & around) - around.tl());
  for (cv::Point& p : nearest) p += around.tl();
  return nearest;
}

double slope_deg(const Eigen::Vector3d& high, const Eigen::Vector3d& low, const GroundPose& pose) {
  const double drop = pose.elevation(high) - pose.elevation(low);
  const Eigen::Vector3d step = low - high;
  const double gone = (step - pose.down.dot(step) * pose.down).norm();
  return std::max(0.0, std::atan2(drop, gone) * 180.0 / std::numbers::pi);
}

}  // namespace

double compute_rim_slope_deg(const Region& region, const cv::Mat1b& deep, const cv::Mat1b& level, const cv::Mat1f& disparity,
                             const StereoCamera& camera, const GroundPose& pose) {
  const std::vector<cv::Point> border = find_deep_border(region, deep);
  const std::vector<cv::Point> nearest = find_nearest_level(border, region, level);
  if (nearest.empty()) return 0.0;
  const auto triangulate = [&](const cv::Point& p) { return camera.triangulate(p.x, p.y, disparity(p)); };
  std::vector<double> slopes;
  slopes.reserve(border.size());
  for (std::size_t i = 0; i < border.size(); ++i) {
    slopes.push_back(slope_deg(triangulate(nearest[i]), triangulate(border[i]), pose));
  }
  const auto steep = slopes.begin() + static_cast<std::ptrdiff_t>(kSteepQuantile * static_cast<double>(slopes.size() - 1));
  std::ranges::nth_element(slopes, steep);
  return *steep;
}

}  // namespace brink
