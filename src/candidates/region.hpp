#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace brink {

/// One 8-connected region of a mask, cut out with a margin of one pixel so that it can be dilated once.
struct Region {
  cv::Rect box;       ///< where `mask` lies in the picture; its outermost pixels may lie outside the picture
  cv::Mat1b mask;     ///< 255 = region
  cv::Mat1b dilated;  ///< mask dilated once with a 3x3 kernel, 0 outside the picture
  int area_px = 0;
};

/// The 8-connected regions of a mask (non-zero = set) with at least min_area_px pixels, in the order of their first pixel row
/// by row.
std::vector<Region> find_regions(const cv::Mat1b& mask, int min_area_px);

/// Outer contour of a cut-out mask, every pixel of it, in picture coordinates. Of several parts the longest.
std::vector<cv::Point> trace_contour(const cv::Mat1b& mask, const cv::Rect& box);

/// The pixels of the 1-px ring around a region that first grew through the pixels of a mask, by at most gap_px; in picture
/// coordinates, row by row.
/// @param passable 255 = may be grown through; size of the picture.
std::vector<cv::Point> ring_pixels(const Region& region, const cv::Mat1b& passable, int gap_px);

}  // namespace brink
