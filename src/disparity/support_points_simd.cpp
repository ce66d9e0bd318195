#include "disparity/support_points_simd.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "disparity/support_points_simd.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "disparity/descriptors_simd.hpp"
#include "simd/sums_of_differences-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace brink::HWY_NAMESPACE {
namespace {

/// Candidates keep this distance from the border: then every sample they use lies inside the picture, px.
constexpr int kBorder = 5;
/// The four descriptors of a candidate lie this far from it in u and v, px.
constexpr int kArm = 2;
/// With fewer disparities to choose from, being best means little.
constexpr int kMinRange = 10;
constexpr std::int16_t kNoCost = 0x7FFF;  // more than the largest cost of four descriptors

/// What a row of candidates is matched by in one view: the descriptors of the rows above and below, and its own texture.
struct Rows {
  const Descriptor* upper = nullptr;
  const Descriptor* lower = nullptr;
  const std::int16_t* texture = nullptr;
  int width = 0;
};

/// A candidate at column u of one view, compared with the disparities from `first` to `last` in the other.
struct Comparison {
  const Rows& rows;
  int u;
  const Rows& other;
  int direction;  ///< the counterpart lies at u + direction * disparity
  int first;
  int last;
  int exclusion;  ///< disparities this near to the best are no rivals, px
};

/// The least cost and the smallest disparity that has it, and the least of its rivals' costs or kNoCost.
struct Best {
  int disparity = 0;
  std::int16_t cost = kNoCost;
  std::int16_t rival = kNoCost;
};

#if HWY_TARGET == HWY_SCALAR

std::size_t memory_needed(int disparities) { return static_cast<std::size_t>(disparities); }

Best find_best(const Comparison& c, std::int16_t* costs) {
  Best best;
  for (int d = c.first; d <= c.last; ++d) {
    const int x = c.u + c.direction * d;
    const int cost = compute_cost(c.rows.upper[c.u - kArm], c.other.upper[x - kArm]) +
                     compute_cost(c.rows.upper[c.u + kArm], c.other.upper[x + kArm]) +
                     compute_cost(c.rows.lower[c.u - kArm], c.other.lower[x - kArm]) +
                     compute_cost(c.rows.lower[c.u + kArm], c.other.lower[x + kArm]);
    costs[d - c.first] = static_cast<std::int16_t>(cost);
    if (cost < best.cost) best = {d, static_cast<std::int16_t>(cost)};
  }
  for (int d = c.first; d <= c.last; ++d) {
    if (std::abs(d - best.disparity) > c.exclusion) best.rival = std::min(best.rival, costs[d - c.first]);
  }
  return best;
}

#else

using Signed = hn::ScalableTag<std::int16_t>;

std::size_t memory_needed(int disparities) { return static_cast<std::size_t>(disparities) + 2 * hn::Lanes(Signed()); }

/// Columns from the start of a line of the cache, or of a vector if that is less. (The arms lie four columns apart, and a line
/// has four: with the left one the right one is loaded as whole lines, too.)
int columns_from_line(const Descriptor* descriptor) {
  return static_cast<int>(reinterpret_cast<std::uintptr_t>(descriptor) / sizeof(Descriptor) % descriptors_per_vector());
}

Best find_best(const Comparison& c, std::int16_t* costs) {
  const Bytes bytes;
  const Signed d16;
  const auto set = [&](int value) { return hn::Set(d16, static_cast<std::int16_t>(value)); };
  const auto none = hn::Set(d16, kNoCost);
  const auto repeat = [&](const Descriptor& descriptor) { return hn::LoadDup128(bytes, descriptor.data()); };
  const auto upper_left = repeat(c.rows.upper[c.u - kArm]);
  const auto upper_right = repeat(c.rows.upper[c.u + kArm]);
  const auto lower_left = repeat(c.rows.lower[c.u - kArm]);
  const auto lower_right = repeat(c.rows.lower[c.u + kArm]);

  // Columns from left to right, some more on both sides than there are disparities.
  int begin = c.direction < 0 ? c.u - c.last : c.u + c.first;
  const int end = c.direction < 0 ? c.u - c.first : c.u + c.last;
  begin -= columns_from_line(c.other.upper + begin - kArm);
  const auto lanes = static_cast<int>(hn::Lanes(d16));
  const auto lane_columns = columns_of_lanes();
  const auto disparities = [&](int x) {
    return c.direction < 0 ? hn::Sub(set(c.u - x), lane_columns) : hn::Add(set(x - c.u), lane_columns);
  };
  const auto too_small = set(c.first - 1);
  const auto too_large = set(c.last + 1);
  constexpr int kArmBytes = 16 * kArm;
  auto least = none;
  std::int16_t* stored = costs;
  for (int x = begin; x <= end; x += lanes, stored += lanes) {
    const std::uint8_t* upper = c.other.upper[x].data();
    const std::uint8_t* lower = c.other.lower[x].data();
    EightSums sums;
    for (std::size_t j = 0; j < 8; ++j, upper += bytes_per_vector(), lower += bytes_per_vector()) {
      sums[j] = hn::Add(hn::Add(sum_differences(upper_left, hn::LoadU(bytes, upper - kArmBytes)),
                                sum_differences(upper_right, hn::LoadU(bytes, upper + kArmBytes))),
                        hn::Add(sum_differences(lower_left, hn::LoadU(bytes, lower - kArmBytes)),
                                sum_differences(lower_right, hn::LoadU(bytes, lower + kArmBytes))));
    }
    const auto d = disparities(x);
    const auto asked = hn::And(hn::Gt(d, too_small), hn::Lt(d, too_large));
    const auto cost = hn::IfThenElse(asked, hn::BitCast(d16, pack_sums(sums)), none);
    hn::StoreU(cost, d16, stored);
    least = hn::Min(least, cost);
  }

  Best best;
  best.cost = least_of_lanes(d16, least);
  least = hn::Set(d16, best.cost);
  auto smallest = none;
  for (int x = begin; x <= end; x += lanes) {
    const auto is_least = hn::Eq(hn::LoadU(d16, costs + (x - begin)), least);
    smallest = hn::Min(smallest, hn::IfThenElse(is_least, disparities(x), none));
  }
  best.disparity = least_of_lanes(d16, smallest);
  smallest = set(best.disparity);
  const auto exclusion = set(c.exclusion);
  auto rival = none;
  for (int x = begin; x <= end; x += lanes) {
    const auto is_rival = hn::Gt(hn::Abs(hn::Sub(disparities(x), smallest)), exclusion);
    rival = hn::Min(rival, hn::IfThenElse(is_rival, hn::LoadU(d16, costs + (x - begin)), none));
  }
  best.rival = least_of_lanes(d16, rival);
  return best;
}

#endif  // HWY_TARGET == HWY_SCALAR

/// The disparity of column u, whose counterpart in `other` lies at u + direction * disparity; kNoSupport if no disparity is
/// clearly the best. Of equally good ones the smallest.
/// @param costs memory_needed() numbers.
int match_point(const Rows& rows, const Rows& other, int u, int direction, const ElasParams& params, std::int16_t* costs) {
  const int room = direction < 0 ? u - kBorder : rows.width - 1 - kBorder - u;
  const int last = std::min(params.max_disparity, room);
  if (last - params.min_disparity < kMinRange) return kNoSupport;
  if (rows.texture[u] < params.support_texture) return kNoSupport;

  // The foot of the minimum is no rival: next to the best all costs are low where the texture is coarse.
  const Best best = find_best({rows, u, other, direction, params.min_disparity, last, params.support_exclusion_px}, costs);
  const int rival = best.rival == kNoCost ? std::numeric_limits<int>::max() : int{best.rival};
  return best.cost < params.support_threshold * rival ? best.disparity : kNoSupport;
}

void match_row(const DescriptorImage& left, const DescriptorImage& right, int j, const ElasParams& params,
               SupportRowMemory& memory, int* row) {
  const int step = params.candidate_step_px;
  const int v = j * step;
  const int width = left.width();
  if (v < kBorder || v >= left.height() - kBorder) return;
  const auto describe_rows = [v, width](const DescriptorImage& image, SupportRowMemory::View& view) {
    view.texture.resize(static_cast<std::size_t>(width));
    compute_texture_row(image.samples(v), width, view.texture.data());
    return Rows{view.upper.gather(image, v - kArm), view.lower.gather(image, v + kArm), view.texture.data(), width};
  };
  const Rows left_rows = describe_rows(left, memory.left);
  const Rows right_rows = describe_rows(right, memory.right);
  memory.costs.resize(memory_needed(params.max_disparity + 1));
  std::int16_t* const costs = memory.costs.data();
  for (int u = (kBorder + step - 1) / step * step; u < width - kBorder; u += step) {
    const int d = match_point(left_rows, right_rows, u, -1, params, costs);
    if (d == kNoSupport) continue;
    const int back = match_point(right_rows, left_rows, u - d, +1, params, costs);
    if (back != kNoSupport && std::abs(back - d) <= params.consistency_threshold_px) row[u / step] = d;
  }
}

/// Of `width` points in a row those that agree with a disparity.
std::size_t count_agreeing(const int* row, int width, int disparity, int threshold) {
  const hn::ScalableTag<std::int32_t> d32;
  const auto here = hn::Set(d32, disparity);
  const auto most = hn::Set(d32, threshold);
  const auto none = hn::Set(d32, kNoSupport);
  std::size_t agreeing = 0;
  for (int x = 0; x < width; x += static_cast<int>(hn::Lanes(d32))) {
    const auto there = hn::LoadU(d32, row + x);
    const auto differ = hn::Gt(hn::Abs(hn::Sub(there, here)), most);
    const auto asked = hn::And(hn::FirstN(d32, static_cast<std::size_t>(width - x)), hn::Ne(there, none));
    agreeing += hn::CountTrue(d32, hn::AndNot(differ, asked));
  }
  return agreeing;
}

void remove_points(const SupportGrid& framed, const ElasParams& params, const cv::Range& rows, SupportGrid& result) {
  const int reach = params.inconsistency_window;
  const int width = 2 * reach + 1;
  const auto enough = static_cast<std::size_t>(params.inconsistency_min_support);
  for (int j = rows.start; j < rows.end; ++j) {
    for (int i = 0; i < result.cols; ++i) {
      const int disparity = framed(j + reach, i + reach);
      if (disparity == kNoSupport) continue;
      const auto count = [&](int y) {
        return count_agreeing(framed[y] + i, width, disparity, params.inconsistency_threshold_px);
      };
      // From the middle outwards: the nearest agree most often.
      std::size_t agreeing = count(j + reach);
      for (int off = 1; off <= reach && agreeing < enough; ++off) agreeing += count(j + reach - off) + count(j + reach + off);
      if (agreeing < enough) result(j, i) = kNoSupport;
    }
  }
}

}  // namespace
}  // namespace brink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace brink {

HWY_EXPORT(match_row);
HWY_EXPORT(remove_points);

void match_support_row(const DescriptorImage& left, const DescriptorImage& right, int j, const ElasParams& params,
                       SupportRowMemory& memory, int* row) {
  HWY_DYNAMIC_DISPATCH(match_row)(left, right, j, params, memory, row);
}

void remove_inconsistent_points(const SupportGrid& framed, const ElasParams& params, const cv::Range& rows,
                                SupportGrid& result) {
  HWY_DYNAMIC_DISPATCH(remove_points)(framed, params, rows, result);
}

}  // namespace brink
#endif  // HWY_ONCE
