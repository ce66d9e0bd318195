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
constexpr std::uint16_t kNoCost = 0xFFFF;  // more than the largest cost of four descriptors

/// The rows of descriptors above and below a candidate.
struct Rows {
  const Descriptor* upper = nullptr;
  const Descriptor* lower = nullptr;
};

Rows rows_around(const DescriptorImage& image, int v) { return {image.row(v - kArm), image.row(v + kArm)}; }

#if HWY_TARGET == HWY_SCALAR

std::size_t padded(std::size_t count) { return count; }

/// Costs of the candidate at column u of one view against the columns from `first` on of the other.
void compute_costs(const Rows& rows, int u, const Rows& other, int first, std::size_t count, std::uint16_t* costs) {
  for (std::size_t i = 0; i < count; ++i) {
    const int x = first + static_cast<int>(i);
    costs[i] = static_cast<std::uint16_t>(
        compute_cost(rows.upper[u - kArm], other.upper[x - kArm]) + compute_cost(rows.upper[u + kArm], other.upper[x + kArm]) +
        compute_cost(rows.lower[u - kArm], other.lower[x - kArm]) + compute_cost(rows.lower[u + kArm], other.lower[x + kArm]));
  }
}

std::uint16_t find_least(const std::uint16_t* costs, std::size_t count) { return *std::min_element(costs, costs + count); }

std::size_t find_first(const std::uint16_t* costs, std::size_t count, std::uint16_t value) {
  return static_cast<std::size_t>(std::find(costs, costs + count, value) - costs);
}

std::size_t find_last(const std::uint16_t* costs, std::size_t count, std::uint16_t value) {
  while (costs[count - 1] != value) --count;
  return count - 1;
}

#else

/// So many numbers of a size are written and read, px.
std::size_t padded(std::size_t count) { return hwy::RoundUpTo(count, hn::Lanes(Shorts())); }

/// Costs of the candidate at column u of one view against the columns from `first` on of the other. What is beyond `count`
/// gets kNoCost.
void compute_costs(const Rows& rows, int u, const Rows& other, int first, std::size_t count, std::uint16_t* costs) {
  const Bytes bytes;
  const std::size_t step = descriptors_per_vector();
  const auto broadcast = [&](const Descriptor& descriptor) {
    const hn::FixedTag<std::uint8_t, 16> one;
    HWY_ALIGN std::array<std::uint8_t, HWY_MAX_BYTES> copies;
    for (std::size_t i = 0; i < step; ++i) hn::Store(hn::LoadU(one, descriptor.data()), one, copies.data() + 16 * i);
    return hn::Load(bytes, copies.data());
  };
  const auto upper_left = broadcast(rows.upper[u - kArm]);
  const auto upper_right = broadcast(rows.upper[u + kArm]);
  const auto lower_left = broadcast(rows.lower[u - kArm]);
  const auto lower_right = broadcast(rows.lower[u + kArm]);
  const std::uint8_t* upper = other.upper[first].data();
  const std::uint8_t* lower = other.lower[first].data();
  constexpr int kArmBytes = 16 * kArm;
  for (std::size_t i = 0; i < count; i += 8 * step) {
    EightSums sums;
    for (std::size_t j = 0; j < 8; ++j, upper += 16 * step, lower += 16 * step) {
      sums[j] = hn::Add(hn::Add(sum_differences(upper_left, hn::LoadU(bytes, upper - kArmBytes)),
                                sum_differences(upper_right, hn::LoadU(bytes, upper + kArmBytes))),
                        hn::Add(sum_differences(lower_left, hn::LoadU(bytes, lower - kArmBytes)),
                                sum_differences(lower_right, hn::LoadU(bytes, lower + kArmBytes))));
    }
    store_in_order(pack_sums(sums), costs + i);
  }
  std::fill(costs + count, costs + padded(count), kNoCost);
}

std::uint16_t find_least(const std::uint16_t* costs, std::size_t count) {
  const Shorts shorts;
  auto least = hn::Set(shorts, kNoCost);
  for (std::size_t i = 0; i < count; i += hn::Lanes(shorts)) least = hn::Min(least, hn::LoadU(shorts, costs + i));
  return hn::GetLane(hn::MinOfLanes(shorts, least));
}

std::size_t find_first(const std::uint16_t* costs, std::size_t count, std::uint16_t value) {
  const Shorts shorts;
  const auto wanted = hn::Set(shorts, value);
  for (std::size_t i = 0; i < count; i += hn::Lanes(shorts)) {
    const std::intptr_t lane = hn::FindFirstTrue(shorts, hn::Eq(hn::LoadU(shorts, costs + i), wanted));
    if (lane >= 0) return i + static_cast<std::size_t>(lane);
  }
  return count;
}

std::size_t find_last(const std::uint16_t* costs, std::size_t count, std::uint16_t value) {
  const Shorts shorts;
  const auto wanted = hn::Set(shorts, value);
  for (std::size_t i = padded(count); i > 0;) {
    i -= hn::Lanes(shorts);
    std::array<std::uint8_t, 8> bits{};
    hn::StoreMaskBits(shorts, hn::Eq(hn::LoadU(shorts, costs + i), wanted), bits.data());
    std::uint32_t lanes = 0;
    for (std::size_t k = 4; k-- > 0;) lanes = lanes << 8U | bits[k];
    if (lanes != 0) return i + static_cast<std::size_t>(std::bit_width(lanes)) - 1;
  }
  return count;
}

#endif  // HWY_TARGET == HWY_SCALAR

/// The disparity of pixel (u, v) of `image`, whose counterpart in `other` lies at u + direction * disparity; kNoSupport if no
/// disparity is clearly the best. Of equally good ones the smallest.
/// @param costs scratch memory, of a vector more than max_disparity + 1.
int match_point(const DescriptorImage& image, const DescriptorImage& other, int u, int v, int direction,
                const ElasParams& params, std::uint16_t* costs) {
  const int room = direction < 0 ? u - kBorder : image.width() - 1 - kBorder - u;
  const int last = std::min(params.max_disparity, room);
  if (last - params.min_disparity < kMinRange) return kNoSupport;
  if (compute_texture(image.row(v)[u]) < params.support_texture) return kNoSupport;

  const int tried = last - params.min_disparity + 1;
  const auto count = static_cast<std::size_t>(tried);
  const int first = direction < 0 ? u - last : u + params.min_disparity;
  compute_costs(rows_around(image, v), u, rows_around(other, v), first, count, costs);
  const std::uint16_t least = find_least(costs, count);
  const std::size_t best = direction < 0 ? find_last(costs, count, least) : find_first(costs, count, least);
  // The foot of the minimum is no rival: next to the best all costs are low where the texture is coarse.
  const auto exclusion = static_cast<std::size_t>(params.support_exclusion_px);
  std::fill(costs + (best - std::min(exclusion, best)), costs + std::min(best + exclusion + 1, count), kNoCost);
  const std::uint16_t rival = find_least(costs, count);
  if (least >= params.support_threshold * (rival == kNoCost ? std::numeric_limits<int>::max() : int{rival})) return kNoSupport;
  return direction < 0 ? last - static_cast<int>(best) : params.min_disparity + static_cast<int>(best);
}

void match_row(const DescriptorImage& left, const DescriptorImage& right, int j, const ElasParams& params, int* row) {
  const int step = params.candidate_step_px;
  const int v = j * step;
  if (v < kBorder || v >= left.height() - kBorder) return;
  std::vector<std::uint16_t> costs(padded(static_cast<std::size_t>(params.max_disparity) + 1));
  for (int u = (kBorder + step - 1) / step * step; u < left.width() - kBorder; u += step) {
    const int d = match_point(left, right, u, v, -1, params, costs.data());
    if (d == kNoSupport) continue;
    const int back = match_point(right, left, u - d, v, +1, params, costs.data());
    if (back != kNoSupport && std::abs(back - d) <= params.consistency_threshold_px) row[u / step] = d;
  }
}

}  // namespace
}  // namespace brink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace brink {

HWY_EXPORT(match_row);

void match_support_row(const DescriptorImage& left, const DescriptorImage& right, int j, const ElasParams& params, int* row) {
  HWY_DYNAMIC_DISPATCH(match_row)(left, right, j, params, row);
}

}  // namespace brink
#endif  // HWY_ONCE
