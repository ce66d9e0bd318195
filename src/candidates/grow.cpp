#include "candidates/grow.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "scan.hpp"

namespace brink {

// The first ring by dilation; from there on each step looks only around what the last one added.
cv::Mat1b grow(const cv::Mat1b& start, const cv::Mat1b& passable, int steps) {
  constexpr auto kRing = static_cast<uchar>(Growth::ring);
  constexpr auto kGrown = static_cast<uchar>(Growth::grown);
  const cv::Rect all(cv::Point(0, 0), start.size());
  cv::Mat1b around_start;
  cv::dilate(start, around_start, cv::Mat());
  cv::bitwise_xor(around_start, start, around_start);
  cv::Mat1b growth = start.clone();
  std::vector<cv::Point> edge;
  for (int v = 0; v < all.height; ++v) {
    const uchar* const row = around_start[v];
    const uchar* const end = row + all.width;
    for (const uchar* place = find_set(row, end); place != end; place = find_set(place + 1, end)) {
      edge.emplace_back(static_cast<int>(place - row), v);
      growth(edge.back()) = kRing;
    }
  }
  std::vector<cv::Point> next;
  for (int step = 0; step < steps && !edge.empty(); ++step) {
    next.clear();
    for (const cv::Point& p : edge) {
      if (passable(p) == 0) continue;
      growth(p) = kGrown;
      const cv::Rect around = cv::Rect(p.x - 1, p.y - 1, 3, 3) & all;
      for (int v = around.y; v < around.br().y; ++v) {
        for (int u = around.x; u < around.br().x; ++u) {
          if (growth(v, u) != 0) continue;
          growth(v, u) = kRing;
          next.emplace_back(u, v);
        }
      }
    }
    std::swap(edge, next);
  }
  return growth;
}

}  // namespace brink
