#include "disparity/row_prior_simd.hpp"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "disparity/row_prior_simd.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace brink::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// Expected disparities of pixels [begin, end) and up to a vector's worth behind, which are written anew later.
template <class D>
HWY_INLINE void expect(D floats, const PriorPlane& plane, int v, int begin, int end, std::int16_t* expected,
                       std::int16_t* reliable) {
  const hn::Rebind<std::int16_t, D> shorts;
  const hn::Rebind<std::int32_t, D> ints;
  constexpr float kFar = PriorPlane::kFar;
  const auto slope = hn::Set(floats, plane.a);
  const auto along_v = hn::Set(floats, plane.b * static_cast<float>(v));
  const auto none = hn::Set(shorts, RowPrior::kNone);
  for (int u = begin; u < end; u += static_cast<int>(hn::Lanes(floats))) {
    const auto columns = hn::Iota(floats, static_cast<float>(u));
    const auto disparity = hn::Add(hn::Add(hn::Mul(slope, columns), along_v), hn::Set(floats, plane.c));
    const auto limited = hn::Min(hn::Max(disparity, hn::Set(floats, -kFar)), hn::Set(floats, kFar));
    const auto whole = hn::ConvertTo(ints, hn::Add(limited, hn::Set(floats, kFar + 0.5F)));
    const auto narrow = hn::DemoteTo(shorts, hn::Sub(whole, hn::Set(ints, static_cast<std::int32_t>(kFar))));
    hn::StoreU(narrow, shorts, expected + u);
    hn::StoreU(plane.reliable ? narrow : none, shorts, reliable + u);
  }
}

void expect_pixels(const int* labels, const std::vector<PriorPlane>& planes, int v, RowPrior& prior) {
  std::int16_t* const expected = prior.expected.data();
  std::int16_t* const reliable = prior.reliable.data();
  for (int begin = 0, end = 0; begin < prior.width; begin = end) {
    const int label = labels[begin];
    while (end < prior.width && labels[end] == label) ++end;
    if (label < 0) {
      std::fill(expected + begin, expected + end, RowPrior::kNone);
      std::fill(reliable + begin, reliable + end, RowPrior::kNone);
    } else {
      expect(hn::ScalableTag<float>(), planes[static_cast<std::size_t>(label)], v, begin, end, expected, reliable);
    }
  }
}

}  // namespace
}  // namespace brink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace brink {

HWY_EXPORT(expect_pixels);

void expect_row(const int* labels, const std::vector<PriorPlane>& planes, int v, RowPrior& prior) {
  HWY_DYNAMIC_DISPATCH(expect_pixels)(labels, planes, v, prior);
}

}  // namespace brink
#endif  // HWY_ONCE
