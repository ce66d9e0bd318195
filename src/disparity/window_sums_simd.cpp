#include "disparity/window_sums_simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "disparity/window_sums_simd.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace brink::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Ints = hn::ScalableTag<std::int32_t>;

void slide(const std::int16_t* added, const std::int16_t* removed, int width, std::int32_t* sums) {
  const auto change = [&](auto ints, int u) {
    const hn::Rebind<std::int16_t, decltype(ints)> shorts;
    const auto more = hn::PromoteTo(ints, hn::LoadU(shorts, added + u));
    const auto less = hn::PromoteTo(ints, hn::LoadU(shorts, removed + u));
    hn::StoreU(hn::Add(hn::LoadU(ints, sums + u), hn::Sub(more, less)), ints, sums + u);
  };
  const Ints ints;
  const auto lanes = static_cast<int>(hn::Lanes(ints));
  int u = 0;
  for (; u + lanes <= width; u += lanes) change(ints, u);
  for (; u < width; ++u) change(hn::CappedTag<std::int32_t, 1>(), u);
}

void mark(const std::int32_t* sums, int width, int radius, std::int32_t least, std::uint8_t* marks) {
  const Ints ints;
  const hn::Rebind<std::uint8_t, Ints> bytes;
  const auto too_little = hn::Set(ints, least - 1);
  const auto full = hn::Set(ints, 255);
  for (int u = 0; u < width; u += static_cast<int>(hn::Lanes(ints))) {
    auto sum = hn::Zero(ints);
    for (int k = -radius; k <= radius; ++k) sum = hn::Add(sum, hn::LoadU(ints, sums + u + k));
    hn::StoreU(hn::DemoteTo(bytes, hn::IfThenElseZero(hn::Gt(sum, too_little), full)), bytes, marks + u);
  }
}

}  // namespace
}  // namespace brink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace brink {

HWY_EXPORT(slide);
HWY_EXPORT(mark);

void slide_column_sums(const std::int16_t* added, const std::int16_t* removed, int width, std::int32_t* sums) {
  HWY_DYNAMIC_DISPATCH(slide)(added, removed, width, sums);
}

void mark_windows(const std::int32_t* sums, int width, int radius, std::int32_t least, std::uint8_t* marks) {
  HWY_DYNAMIC_DISPATCH(mark)(sums, width, radius, least, marks);
}

}  // namespace brink
#endif  // HWY_ONCE
