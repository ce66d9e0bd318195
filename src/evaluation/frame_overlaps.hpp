#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "brink/evaluation.hpp"

namespace brink {

/// A mask widened by a Euclidean disc, so that it grows equally in all directions. @param mask not 0 = inside.
cv::Mat1b widen(const cv::Mat1b& mask, int radius_px);

/// How the detections and the instances of one frame overlap: counted once, judged for any set of ids that counts.
class FrameOverlaps {
 public:
  /// Arguments and errors as of match_frame.
  FrameOverlaps(const cv::Mat1b& negative, const std::vector<cv::Mat1b>& regions, int dilation_px);

  /// The rules of evaluation.md, "Detection, per frame", with these ids counted.
  [[nodiscard]] FrameMatch match(const std::vector<int>& counted) const;

 private:
  struct Instance {
    int id = 0;
    int px = 0;         // of its mask
    cv::Mat1b dilated;  // its mask, widened
  };
  struct Region {
    cv::Mat1b mask;                   // cut out by box
    cv::Rect box;                     // around its pixels
    int px = 0;                       // inside
    std::vector<int> common;          // px shared with the mask of each instance
    std::vector<int> common_dilated;  // px shared with the dilated mask of each instance
  };
  // The dilated masks of the instances that count, or of those that do not, as one.
  [[nodiscard]] cv::Mat1b unite(const std::vector<bool>& counts, bool counted) const;
  [[nodiscard]] bool is_hit(const Region& region, std::size_t instance, bool is_half_in_union) const;

  std::vector<Instance> instances_;  // ascending ids
  std::vector<Region> regions_;
  cv::Mat1b not_labelled_;
};

}  // namespace brink
