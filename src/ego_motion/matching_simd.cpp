#include "ego_motion/matching_simd.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>

#include "simd/set_bits.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ego_motion/matching_simd.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "simd/sums_of_differences-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace brink::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 8>;
using Ints = hn::Rebind<std::int32_t, Floats>;

constexpr std::int64_t kNone = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t kLowHalf = 0xFFFFFFFF;

/// The two least keys: costs, each above the number of its feature.
struct BestKeys {
  std::int64_t best = kNone;
  std::int64_t second = kNone;
  void add(std::int64_t key) {
    second = std::min(second, std::max(best, key));
    best = std::min(best, key);
  }
};

#if HWY_TARGET == HWY_SCALAR

BestKeys compare(const std::uint8_t* descriptors, const std::uint8_t* wanted, const std::int32_t* features, std::size_t count,
                 BestKeys keys) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t* const descriptor = descriptors + 32 * static_cast<std::size_t>(features[i]);
    std::int64_t cost = 0;
    for (std::size_t k = 0; k < 32; ++k) cost += std::abs(int{descriptor[k]} - int{wanted[k]});
    keys.add(cost << 32U | features[i]);
  }
  return keys;
}

#else

using Bytes = hn::CappedTag<std::uint8_t, 32>;
using Words = hn::Repartition<std::uint64_t, Bytes>;
using Keys = hn::Repartition<std::int64_t, Bytes>;

/// The costs of as many features as a vector holds words.
class Costs {
 public:
  HWY_INLINE Costs(const std::uint8_t* descriptors, const std::uint8_t* wanted)
      : descriptors_(descriptors), first_(hn::LoadU(Bytes(), wanted)), last_(hn::LoadU(Bytes(), wanted + kLast)) {}

  [[nodiscard]] HWY_INLINE hn::Vec<Words> compute(const std::int32_t* features) const {
    const auto first = compute_two(features);
#if HWY_MAX_BYTES >= 32
    const auto second = compute_two(features + 2);
    return hn::Add(hn::ConcatLowerLower(Words(), second, first), hn::ConcatUpperUpper(Words(), second, first));
#else
    return first;
#endif
  }

 private:
  /// Of two features, alternating; of a vector of 32 bytes each half has a part of them.
  [[nodiscard]] HWY_INLINE hn::Vec<Words> compute_two(const std::int32_t* features) const {
    const auto a = compute_one(features[0]);
    const auto b = compute_one(features[1]);
    return hn::Add(hn::InterleaveLower(Words(), a, b), hn::InterleaveUpper(Words(), a, b));
  }
  [[nodiscard]] HWY_INLINE hn::Vec<Words> compute_one(std::int32_t feature) const {
    const std::uint8_t* const descriptor = descriptors_ + 32 * static_cast<std::size_t>(feature);
    const auto sums = sum_differences(Bytes(), first_, hn::LoadU(Bytes(), descriptor));
    return kLast == 0 ? sums : hn::Add(sums, sum_differences(Bytes(), last_, hn::LoadU(Bytes(), descriptor + kLast)));
  }

  static constexpr std::size_t kLast = 32 - hn::MaxLanes(Bytes());  ///< 0: one vector holds a descriptor
  const std::uint8_t* descriptors_;
  hn::Vec<Bytes> first_;
  hn::Vec<Bytes> last_;
};

/// The keys, and those of `count` features more. @param features with as many spare ones behind as a vector holds words.
HWY_INLINE BestKeys compare(const std::uint8_t* descriptors, const std::uint8_t* wanted, std::int32_t* features,
                            std::size_t count, BestKeys keys) {
  const Keys tag;
  const std::size_t lanes = hn::Lanes(tag);
  const Costs costs(descriptors, wanted);
  const auto none = hn::Set(tag, kNone);
  auto best = none;
  auto second = none;
  hn::StoreU(hn::Zero(hn::Rebind<std::int32_t, Keys>()), hn::Rebind<std::int32_t, Keys>(), features + count);
  auto place = hn::Iota(tag, 0);  // in the list, for the number of the feature there
  for (std::size_t i = 0; i < count; i += lanes) {
    const auto all = hn::Or(hn::ShiftLeft<32>(hn::BitCast(tag, costs.compute(features + i))), place);
    const auto key = hn::IfThenElse(hn::FirstN(tag, count - i), all, none);
    place = hn::Add(place, hn::Set(tag, static_cast<std::int64_t>(lanes)));
    second = hn::Min(second, hn::Max(best, key));
    best = hn::Min(best, key);
  }
  HWY_ALIGN std::int64_t firsts[HWY_MAX_BYTES / 8];   // NOLINT(modernize-avoid-c-arrays)
  HWY_ALIGN std::int64_t seconds[HWY_MAX_BYTES / 8];  // NOLINT(modernize-avoid-c-arrays)
  hn::Store(best, tag, firsts);
  hn::Store(second, tag, seconds);
  BestKeys found;
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    found.add(firsts[lane]);
    found.second = std::min(found.second, seconds[lane]);
  }
  if (found.best != kNone) keys.add((found.best & ~kLowHalf) | features[found.best & kLowHalf]);
  keys.second = std::min(keys.second, found.second);
  return keys;
}

#endif

BestTwo search_pieces(const float* u, const float* v, const std::uint8_t* descriptors, const FeaturePieces& pieces,
                      const float* window, const std::uint8_t* wanted) {
  const Floats floats;
  const Ints ints;
  const std::size_t lanes = hn::Lanes(floats);
  const auto least_u = hn::Set(floats, window[0]);
  const auto least_v = hn::Set(floats, window[1]);
  const auto greatest_u = hn::Set(floats, window[2]);
  const auto greatest_v = hn::Set(floats, window[3]);
  constexpr std::size_t kAtOnce = 256;
  HWY_ALIGN std::int32_t within[kAtOnce + 16];  // NOLINT(modernize-avoid-c-arrays)
  std::size_t count = 0;
  BestKeys keys;
  for (std::size_t piece = 0; piece < pieces.pieces; ++piece) {
    const std::size_t* const begin = pieces.begins + piece * pieces.stride;
    const std::size_t end = begin[pieces.length];
    for (std::size_t first = *begin; first < end; first += lanes) {
      const auto column = hn::LoadU(floats, u + first);
      const auto row = hn::LoadU(floats, v + first);
      const auto beside = hn::And(hn::Ge(column, least_u), hn::Le(column, greatest_u));
      const auto above = hn::And(hn::Ge(row, least_v), hn::Le(row, greatest_v));
      const auto is_within = hn::And(hn::And(beside, above), hn::FirstN(floats, end - first));
      std::uint8_t bits = 0;
      hn::StoreMaskBits(floats, is_within, &bits);
      const auto numbers = hn::PromoteTo(ints, hn::LoadU(hn::Rebind<std::uint8_t, Ints>(), kSetBits.numbers[bits]));
      hn::StoreU(hn::Add(numbers, hn::Set(ints, static_cast<std::int32_t>(first))), ints, within + count);
      count += static_cast<std::size_t>(std::popcount(bits));
      if (count < kAtOnce) continue;
      keys = compare(descriptors, wanted, within, count, keys);
      count = 0;
    }
  }
  keys = compare(descriptors, wanted, within, count, keys);
  BestTwo two;
  if (keys.best != kNone) {
    two.best = static_cast<int>(keys.best & kLowHalf);
    two.cost = static_cast<int>(keys.best >> 32);
  }
  if (keys.second != kNone) two.second_cost = static_cast<int>(keys.second >> 32);
  return two;
}

}  // namespace
}  // namespace brink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace brink {

HWY_EXPORT(search_pieces);

BestTwo find_best_two(const FeatureColumns& features, const FeaturePieces& pieces, const std::array<float, 4>& window,
                      const FeatureDescriptor& wanted) {
  const auto* const descriptors = reinterpret_cast<const std::uint8_t*>(features.descriptors.data());
  return HWY_DYNAMIC_DISPATCH(search_pieces)(features.u.data(), features.v.data(), descriptors, pieces, window.data(),
                                             wanted.data());
}

}  // namespace brink
#endif  // HWY_ONCE
