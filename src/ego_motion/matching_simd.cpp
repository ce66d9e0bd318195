#include "ego_motion/matching_simd.hpp"

#include <algorithm>
#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ego_motion/matching_simd.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace brink::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

class Query {
 public:
  Query(const float* limits, const std::uint8_t* wanted) : limits_(limits), wanted_(wanted) {}
  [[nodiscard]] bool holds(const FeatureEntry& entry) const {
    return std::equal(entry.place.begin(), entry.place.end(), limits_, [](float place, float limit) { return place >= limit; });
  }
  [[nodiscard]] int compute_cost(const FeatureEntry& entry) const {
    int cost = 0;
    for (std::size_t i = 0; i < entry.descriptor.size(); ++i) cost += std::abs(int{entry.descriptor[i]} - int{wanted_[i]});
    return cost;
  }

 private:
  const float* limits_;
  const std::uint8_t* wanted_;
};

#else

using Bytes = hn::CappedTag<std::uint8_t, 32>;
using Words = hn::Repartition<std::uint64_t, Bytes>;
using Floats = hn::FixedTag<float, 4>;

/// Sums of |a - b| over every 8 bytes. Highway 1.0.3 has no such operation, x86 has an instruction.
HWY_INLINE hn::Vec<Words> sum_differences(hn::Vec<Bytes> a, hn::Vec<Bytes> b) {
#if HWY_TARGET == HWY_SSSE3 || HWY_TARGET == HWY_SSE4
  return hn::Vec<Words>{_mm_sad_epu8(a.raw, b.raw)};
#elif HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  return hn::Vec<Words>{_mm256_sad_epu8(a.raw, b.raw)};
#else
  return hn::SumsOf8(hn::Or(hn::SaturatedSub(a, b), hn::SaturatedSub(b, a)));
#endif
}

class Query {
 public:
  HWY_INLINE Query(const float* limits, const std::uint8_t* wanted)
      : limits_(hn::LoadU(Floats(), limits)), first_(hn::LoadU(Bytes(), wanted)), last_(hn::LoadU(Bytes(), wanted + kLast)) {}
  [[nodiscard]] HWY_INLINE bool holds(const FeatureEntry& entry) const {
    return hn::AllTrue(Floats(), hn::Ge(hn::Load(Floats(), entry.place.data()), limits_));
  }
  [[nodiscard]] HWY_INLINE int compute_cost(const FeatureEntry& entry) const {
    auto sums = sum_differences(first_, hn::LoadU(Bytes(), entry.descriptor.data()));
    if (kLast != 0) sums = hn::Add(sums, sum_differences(last_, hn::LoadU(Bytes(), entry.descriptor.data() + kLast)));
    return static_cast<int>(hn::GetLane(hn::SumOfLanes(Words(), sums)));
  }

 private:
  static constexpr std::size_t kLast = 32 - hn::MaxLanes(Bytes());  ///< 0: one vector holds all
  hn::Vec<Floats> limits_;
  hn::Vec<Bytes> first_;
  hn::Vec<Bytes> last_;
};

#endif

BestTwo search_pieces(const SearchPieces& pieces, const float* limits, const std::uint8_t* wanted) {
  const Query query(limits, wanted);
  BestTwo two;
  for (std::size_t strip = 0; strip < pieces.strips; ++strip) {
    const std::size_t* const begin = pieces.begins + strip * pieces.stride;
    const FeatureEntry* const end = pieces.entries + begin[pieces.length];
    for (const FeatureEntry* entry = pieces.entries + *begin; entry != end; ++entry) {
      if (!query.holds(*entry)) continue;
      const int cost = query.compute_cost(*entry);
      two.second_cost = std::min(two.second_cost, std::max(two.cost, cost));
      two.index = cost < two.cost ? entry->index : two.index;
      two.cost = std::min(two.cost, cost);
    }
  }
  return two;
}

}  // namespace
}  // namespace brink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace brink {

HWY_EXPORT(search_pieces);

BestTwo find_best_two(const SearchPieces& pieces, const std::array<float, 4>& limits, const FeatureDescriptor& wanted) {
  return HWY_DYNAMIC_DISPATCH(search_pieces)(pieces, limits.data(), wanted.data());
}

}  // namespace brink
#endif  // HWY_ONCE
