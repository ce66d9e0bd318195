#include "candidates/below_ground_simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "candidates/below_ground_simd.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace brink::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// Pixels [u, u + lanes of the tag).
template <class D>
HWY_INLINE void sort_pixels(D floats, const float* disparity, const float* elevation, int u, const BelowGroundLimits& limits,
                            const BelowGroundRow& masks) {
  const hn::Rebind<std::int32_t, D> ints;
  const hn::Rebind<std::uint8_t, D> bytes;
  const auto d = hn::LoadU(floats, disparity + u);
  const auto e = hn::LoadU(floats, elevation + u);
  const auto least = hn::Set(floats, limits.least_disparity);
  const auto noise = hn::Div(hn::Set(floats, limits.noise_px_m), hn::Max(d, least));
  const auto wanted = hn::Max(noise, hn::Set(floats, limits.measured_m));
  const auto rim = hn::Mul(hn::Set(floats, limits.rim_ratio), wanted);
  const auto valid = hn::Ge(d, least);
  const auto is_level = hn::And(hn::Gt(e, hn::Neg(rim)), hn::Lt(e, hn::Set(floats, limits.tolerance_m)));
  const auto store = [&](auto mask, std::uint8_t* row) {
    const auto values = hn::IfThenElseZero(hn::RebindMask(ints, mask), hn::Set(ints, 255));
    hn::StoreU(hn::DemoteTo(bytes, values), bytes, row + u);
  };
  store(hn::Not(valid), masks.none);
  store(hn::And(valid, hn::Le(e, hn::Neg(wanted))), masks.deep);
  store(hn::And(valid, hn::Le(e, hn::Neg(rim))), masks.low);
  store(hn::And(valid, is_level), masks.level);
}

void sort_row(const float* disparity, const float* elevation, int width, const BelowGroundLimits& limits,
              const BelowGroundRow& masks) {
  const hn::ScalableTag<float> floats;
  const auto lanes = static_cast<int>(hn::Lanes(floats));
  int u = 0;
  for (; u + lanes <= width; u += lanes) sort_pixels(floats, disparity, elevation, u, limits, masks);
  for (; u < width; ++u) sort_pixels(hn::CappedTag<float, 1>(), disparity, elevation, u, limits, masks);
}

}  // namespace
}  // namespace brink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace brink {

HWY_EXPORT(sort_row);

void sort_below_ground_row(const float* disparity, const float* elevation, int width, const BelowGroundLimits& limits,
                           const BelowGroundRow& masks) {
  HWY_DYNAMIC_DISPATCH(sort_row)(disparity, elevation, width, limits, masks);
}

}  // namespace brink
#endif  // HWY_ONCE
