#include <algorithm>
#include <array>
#include <stdexcept>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "evaluation/frame_overlaps.hpp"

namespace brink {
namespace {

bool is_half(int part_px, int whole_px) { return 2 * part_px >= whole_px; }

/// Offsets no farther than the radius from the middle.
cv::Mat1b make_disc(int radius_px) {
  cv::Mat1b disc(2 * radius_px + 1, 2 * radius_px + 1, uchar{0});
  for (int v = -radius_px; v <= radius_px; ++v) {
    for (int u = -radius_px; u <= radius_px; ++u) {
      if (u * u + v * v <= radius_px * radius_px) disc(v + radius_px, u + radius_px) = 1;
    }
  }
  return disc;
}

std::vector<int> list_ids(const cv::Mat1b& negative) {
  std::array<bool, 256> is_there{};
  for (const uchar id : negative) is_there.at(id) = true;
  std::vector<int> ids;
  for (int id = 1; id < kNotLabelled; ++id) {
    if (is_there.at(static_cast<std::size_t>(id))) ids.push_back(id);
  }
  return ids;
}

void require_size(const cv::Mat1b& region, std::size_t index, const cv::Size& size) {
  if (region.size() == size) return;
  throw std::invalid_argument(fmt::format("region {} has {}x{} px, must be {}x{} like the truth", index, region.cols,
                                          region.rows, size.width, size.height));
}

}  // namespace

cv::Mat1b widen(const cv::Mat1b& mask, int radius_px) {
  const cv::Rect tight = cv::boundingRect(mask);
  const cv::Rect box =
      cv::Rect(tight.tl() - cv::Point(radius_px, radius_px), tight.size() + cv::Size(2 * radius_px, 2 * radius_px)) &
      cv::Rect(cv::Point(0, 0), mask.size());
  cv::Mat1b dilated(mask.size(), uchar{0});
  cv::Mat1b inside = dilated(box);
  cv::dilate(mask(box), inside, make_disc(radius_px));
  return dilated;
}

FrameOverlaps::FrameOverlaps(const cv::Mat1b& negative, const std::vector<cv::Mat1b>& regions, int dilation_px) {
  if (dilation_px < 0) throw std::invalid_argument(fmt::format("dilation_px = {}, must be 0 or more", dilation_px));
  for (std::size_t i = 0; i < regions.size(); ++i) require_size(regions[i], i, negative.size());
  if (regions.empty()) return;  // nothing to judge: spares most frames the work

  regions_.resize(regions.size());
  for (std::size_t i = 0; i < regions.size(); ++i) {
    regions_[i].px = cv::countNonZero(regions[i]);
    regions_[i].box = cv::boundingRect(regions[i]);
    regions_[i].mask = regions[i](regions_[i].box);
  }
  if (negative.empty()) return;
  not_labelled_ = negative == kNotLabelled;
  for (const int id : list_ids(negative)) {
    const cv::Mat1b mask(negative == id);
    instances_.push_back({id, cv::countNonZero(mask), widen(mask, dilation_px)});
    for (Region& region : regions_) {
      if (region.px == 0) continue;
      region.common.push_back(cv::countNonZero(region.mask & mask(region.box)));
      region.common_dilated.push_back(cv::countNonZero(region.mask & instances_.back().dilated(region.box)));
    }
  }
}

cv::Mat1b FrameOverlaps::unite(const std::vector<bool>& counts, bool counted) const {
  cv::Mat1b area(not_labelled_.size(), uchar{0});
  for (std::size_t k = 0; k < instances_.size(); ++k) {
    if (counts[k] == counted) area |= instances_[k].dilated;
  }
  return area;
}

bool FrameOverlaps::is_hit(const Region& region, std::size_t instance, bool is_half_in_union) const {
  const int instance_px = instances_[instance].px;
  const int common = region.common[instance];
  if (is_half(region.common_dilated[instance], region.px)) return true;
  if (4 * common >= region.px + instance_px - common) return true;  // IoU >= 0.25, with the mask as it is
  return is_half_in_union && is_half(common, instance_px);          // one region over several instances
}

FrameMatch FrameOverlaps::match(const std::vector<int>& counted) const {
  FrameMatch match;
  if (regions_.empty()) return match;
  match.hits.resize(regions_.size());
  match.is_false.assign(regions_.size(), false);
  std::vector<bool> counts;
  for (const Instance& instance : instances_) counts.push_back(std::ranges::find(counted, instance.id) != counted.end());
  const cv::Mat1b counted_area = unite(counts, true);
  cv::Mat1b ignored_area = unite(counts, false);
  ignored_area |= not_labelled_;

  std::vector<int> times_hit(instances_.size(), 0);
  for (std::size_t i = 0; i < regions_.size(); ++i) {
    const Region& region = regions_[i];
    if (region.px == 0) continue;  // tells no place in the picture: can be neither right nor wrong
    const bool is_half_in_union = is_half(cv::countNonZero(region.mask & counted_area(region.box)), region.px);
    const bool is_half_ignored = is_half(cv::countNonZero(region.mask & ignored_area(region.box)), region.px);
    for (std::size_t k = 0; k < instances_.size(); ++k) {
      if (!counts[k] || !is_hit(region, k, is_half_in_union)) continue;
      match.hits[i].push_back(instances_[k].id);
      if (++times_hit[k] > 1) ++match.fragments;
    }
    match.is_false[i] = match.hits[i].empty() && !is_half_in_union && !is_half_ignored;
  }
  return match;
}

FrameMatch match_frame(const cv::Mat1b& negative, const std::vector<cv::Mat1b>& regions, const std::vector<int>& counted,
                       int dilation_px) {
  return FrameOverlaps(negative, regions, dilation_px).match(counted);
}

cv::Mat1b fill_contour(const std::vector<cv::Point>& contour, const cv::Size& size) {
  cv::Mat1b mask(size, uchar{0});
  if (contour.empty() || mask.empty()) return mask;
  cv::drawContours(mask, std::vector<std::vector<cv::Point>>{contour}, -1, cv::Scalar(255), cv::FILLED);
  return mask;
}

}  // namespace brink
