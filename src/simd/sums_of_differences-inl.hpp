// Part of every kernel that compares descriptors: included once for each target, by Highway's foreach_target.
#if defined(BRINK_SIMD_SUMS_OF_DIFFERENCES_INL_HPP_) == defined(HWY_TARGET_TOGGLE)
#ifdef BRINK_SIMD_SUMS_OF_DIFFERENCES_INL_HPP_
#undef BRINK_SIMD_SUMS_OF_DIFFERENCES_INL_HPP_
#else
#define BRINK_SIMD_SUMS_OF_DIFFERENCES_INL_HPP_
#endif

#include <array>
#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace brink::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET != HWY_SCALAR

using Bytes = hn::ScalableTag<std::uint8_t>;
using Shorts = hn::ScalableTag<std::uint16_t>;
using Words = hn::ScalableTag<std::uint64_t>;

/// Not std::array: its constructor would be compiled for another target than that of the vectors.
using EightSums = hn::Vec<Words>[8];  // NOLINT(modernize-avoid-c-arrays)

/// Descriptors of 16 bytes that one vector holds.
HWY_INLINE std::size_t descriptors_per_vector() { return hn::Lanes(Bytes()) / 16; }

HWY_INLINE std::size_t bytes_per_vector() { return hn::Lanes(Bytes()); }

/// Sums of |a - b| over every 8 bytes. Highway 1.0.3 has no such operation, x86 has an instruction.
template <class D>
HWY_INLINE hn::Vec<hn::Repartition<std::uint64_t, D>> sum_differences(D /*bytes*/, hn::Vec<D> a, hn::Vec<D> b) {
#if HWY_TARGET == HWY_SSSE3 || HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3 || \
    HWY_TARGET == HWY_AVX3_DL
  using Sums = hn::Vec<hn::Repartition<std::uint64_t, D>>;
  if constexpr (hn::MaxLanes(D()) == 16) {
    return Sums{_mm_sad_epu8(a.raw, b.raw)};
#if HWY_TARGET <= HWY_AVX2
  } else if constexpr (hn::MaxLanes(D()) == 32) {
    return Sums{_mm256_sad_epu8(a.raw, b.raw)};
#endif
#if HWY_TARGET <= HWY_AVX3
  } else if constexpr (hn::MaxLanes(D()) == 64) {
    return Sums{_mm512_sad_epu8(a.raw, b.raw)};
#endif
  }
#else
  return hn::SumsOf8(hn::Or(hn::SaturatedSub(a, b), hn::SaturatedSub(b, a)));
#endif
}
HWY_INLINE hn::Vec<Words> sum_differences(hn::Vec<Bytes> a, hn::Vec<Bytes> b) { return sum_differences(Bytes(), a, b); }

/// Costs of as many pixels as a vector has 16-bit lanes, from the sums of eight vectors of consecutive descriptors, two sums of
/// at most 16,383 a descriptor. Lane 8 k + j is pixel K j + k, where K = descriptors_per_vector().
HWY_INLINE hn::Vec<Shorts> pack_sums(const EightSums& sums) {
  const auto pack_four = [&sums](std::size_t first) {
    return hn::Or(hn::Or(sums[first], hn::ShiftLeft<16>(sums[first + 1])),
                  hn::Or(hn::ShiftLeft<32>(sums[first + 2]), hn::ShiftLeft<48>(sums[first + 3])));
  };
  const Words words;
  const Shorts shorts;
  const auto first = pack_four(0);
  const auto second = pack_four(4);
  return hn::Add(hn::BitCast(shorts, hn::InterleaveLower(words, first, second)),
                 hn::BitCast(shorts, hn::InterleaveUpper(words, first, second)));
}

/// The least of the lanes, none of which is negative. Highway 1.0.3 takes many steps for that, x86 has an instruction.
template <class D>
HWY_INLINE std::int16_t least_of_lanes(D d16, hn::Vec<D> lanes) {
#if HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  if constexpr (hn::MaxLanes(D()) == 8) {
    return static_cast<std::int16_t>(_mm_extract_epi16(_mm_minpos_epu16(lanes.raw), 0));
  } else {
    const hn::Half<D> half;
    return least_of_lanes(half, hn::Min(hn::LowerHalf(half, lanes), hn::UpperHalf(half, lanes)));
  }
#else
  return hn::GetLane(hn::MinOfLanes(d16, lanes));
#endif
}

/// Which pixel each lane of pack_sums is: Iota in its order.
HWY_INLINE hn::Vec<hn::RebindToSigned<Shorts>> columns_of_lanes() {
  const hn::RebindToSigned<Shorts> d16;
  const auto lane = hn::Iota(d16, 0);
  const auto j = hn::And(lane, hn::Set(d16, 7));
  const auto k = hn::ShiftRight<3>(lane);
  return hn::Add(hn::Mul(j, hn::Set(d16, static_cast<std::int16_t>(descriptors_per_vector()))), k);
}

/// Stores lanes in pack_sums' order as consecutive pixels.
HWY_INLINE void store_in_order(hn::Vec<Shorts> packed, std::uint16_t* pixels) {
  const std::size_t blocks = descriptors_per_vector();
  if (blocks == 1) {
    hn::StoreU(packed, Shorts(), pixels);
    return;
  }
  const hn::FixedTag<std::uint16_t, 8> block;
  HWY_ALIGN std::array<std::uint16_t, HWY_MAX_BYTES / 2> lanes;
  hn::Store(packed, Shorts(), lanes.data());
  const auto load = [&](std::size_t k) { return hn::Load(block, lanes.data() + 8 * k); };
  const auto store = [&](auto values, std::size_t k) { hn::StoreU(values, block, pixels + 8 * k); };
  if (blocks == 2) {
    store(hn::InterleaveLower(block, load(0), load(1)), 0);
    store(hn::InterleaveUpper(block, load(0), load(1)), 1);
    return;
  }
  const auto even_low = hn::InterleaveLower(block, load(0), load(2));
  const auto even_high = hn::InterleaveUpper(block, load(0), load(2));
  const auto odd_low = hn::InterleaveLower(block, load(1), load(3));
  const auto odd_high = hn::InterleaveUpper(block, load(1), load(3));
  store(hn::InterleaveLower(block, even_low, odd_low), 0);
  store(hn::InterleaveUpper(block, even_low, odd_low), 1);
  store(hn::InterleaveLower(block, even_high, odd_high), 2);
  store(hn::InterleaveUpper(block, even_high, odd_high), 3);
}

#endif  // HWY_TARGET != HWY_SCALAR

}  // namespace brink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
