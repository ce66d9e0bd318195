#pragma once

#include <vector>

#include <opencv2/imgproc.hpp>

#include "candidates/region.hpp"

namespace brink::reference {

/// grow: the whole picture dilated once for each step; the ring by one more.
struct NaiveGrowth {
  cv::Mat1b grown;
  cv::Mat1b ring;
};

inline NaiveGrowth naive_grow(const cv::Mat1b& start, const cv::Mat1b& passable, int steps) {
  NaiveGrowth growth{start.clone(), {}};
  for (int i = 0; i < steps; ++i) {
    cv::Mat1b wider;
    cv::dilate(growth.grown, wider, cv::Mat());
    growth.grown = (wider & passable) | start;
  }
  cv::dilate(growth.grown, growth.ring, cv::Mat());
  growth.ring &= ~growth.grown;
  return growth;
}

/// ring_pixels, on the whole picture.
inline std::vector<cv::Point> naive_ring_pixels(const Region& region, const cv::Mat1b& passable, int gap_px) {
  const cv::Rect in_picture = region.box & cv::Rect(cv::Point(0, 0), passable.size());
  cv::Mat1b start(passable.size(), uchar{0});
  region.mask(in_picture - region.box.tl()).copyTo(start(in_picture));
  std::vector<cv::Point> pixels;
  cv::findNonZero(naive_grow(start, passable, gap_px).ring, pixels);
  return pixels;
}

}  // namespace brink::reference
