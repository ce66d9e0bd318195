#include "disparity/consistency_simd.hpp"

#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "disparity/consistency_simd.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "brink/frame.hpp"

HWY_BEFORE_NAMESPACE();
namespace brink::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// Pixels [u, u + lanes of the tag).
template <class D>
HWY_INLINE void check_pixels(D floats, const float* left, const float* right, int u, int width, float threshold_px,
                             float* checked) {
  const hn::Rebind<std::int32_t, D> ints;
  const auto none = hn::Set(floats, kInvalidDisparity);
  const auto d = hn::LoadU(floats, left + u);
  const auto columns = hn::Iota(floats, static_cast<float>(u));
  const auto counterpart = hn::Add(hn::Sub(columns, d), hn::Set(floats, 0.5F));
  const auto inside =
      hn::And(hn::Ge(counterpart, hn::Zero(floats)), hn::Lt(counterpart, hn::Set(floats, static_cast<float>(width))));
  const auto back = hn::GatherIndex(floats, right, hn::ConvertTo(ints, hn::IfThenElseZero(inside, counterpart)));
  const auto near = hn::Le(hn::Abs(hn::Sub(d, back)), hn::Set(floats, threshold_px));
  const auto matched = hn::And(hn::Ne(d, none), hn::Ne(back, none));
  hn::StoreU(hn::IfThenElse(hn::And(hn::And(matched, inside), near), d, none), floats, checked + u);
}

void check_row(const float* left, const float* right, int width, float threshold_px, float* checked) {
  const hn::ScalableTag<float> floats;
  const auto lanes = static_cast<int>(hn::Lanes(floats));
  int u = 0;
  for (; u + lanes <= width; u += lanes) check_pixels(floats, left, right, u, width, threshold_px, checked);
  for (; u < width; ++u) check_pixels(hn::CappedTag<float, 1>(), left, right, u, width, threshold_px, checked);
}

}  // namespace
}  // namespace brink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace brink {

HWY_EXPORT(check_row);

void check_consistency_row(const float* left, const float* right, int width, float threshold_px, float* checked) {
  HWY_DYNAMIC_DISPATCH(check_row)(left, right, width, threshold_px, checked);
}

}  // namespace brink
#endif  // HWY_ONCE
