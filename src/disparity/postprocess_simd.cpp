#include "disparity/postprocess_simd.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "disparity/postprocess_simd.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "brink/frame.hpp"

HWY_BEFORE_NAMESPACE();
namespace brink::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// Pixels [at, at + lanes of the tag).
template <class D>
HWY_INLINE void filter_lanes(D floats, const std::array<const float*, 7>& around, std::size_t at, float* result) {
  const auto none = hn::Set(floats, kInvalidDisparity);
  const auto step = hn::Set(floats, 4.0F);
  const auto zero = hn::Zero(floats);
  const auto middle = hn::LoadU(floats, around[3] + at);
  auto sum = zero;
  auto weights = zero;
  for (const float* neighbours : around) {
    const auto value = hn::LoadU(floats, neighbours + at);
    const auto near = hn::Max(zero, hn::Sub(step, hn::Abs(hn::Sub(value, middle))));
    const auto weight = hn::IfThenElseZero(hn::Ne(value, none), near);
    sum = hn::Add(sum, hn::Mul(weight, value));
    weights = hn::Add(weights, weight);
  }
  hn::StoreU(hn::IfThenElse(hn::Eq(middle, none), none, hn::Div(sum, weights)), floats, result + at);
}

void filter_line(const std::array<const float*, 7>& around, std::size_t size, float* result) {
  const hn::ScalableTag<float> floats;
  const std::size_t whole = size - size % hn::Lanes(floats);
  for (std::size_t i = 0; i < whole; i += hn::Lanes(floats)) filter_lanes(floats, around, i, result);
  for (std::size_t i = whole; i < size; ++i) filter_lanes(hn::CappedTag<float, 1>(), around, i, result);
}

}  // namespace
}  // namespace brink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace brink {

HWY_EXPORT(filter_line);

void filter_mean_line(const std::array<const float*, 7>& around, int size, float* result) {
  HWY_DYNAMIC_DISPATCH(filter_line)(around, static_cast<std::size_t>(size), result);
}

}  // namespace brink
#endif  // HWY_ONCE
