#include "ground/elevation_simd.hpp"

#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ground/elevation_simd.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace brink::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// The ground's disparities along a row and the camera's height over it.
struct Ground {
  float height_m;
  float first;
  float step;
};

/// Pixels [u, u + lanes of the tag).
template <class D>
HWY_INLINE void elevate(D floats, const Ground& ground, const float* disparity, int u, float* elevation) {
  const auto d = hn::LoadU(floats, disparity + u);
  const auto columns = hn::Iota(floats, static_cast<float>(u));
  const auto expected = hn::Add(hn::Mul(hn::Set(floats, ground.step), columns), hn::Set(floats, ground.first));
  const auto above = hn::Mul(hn::Set(floats, ground.height_m), hn::Sub(hn::Set(floats, 1.0F), hn::Div(expected, d)));
  const auto none = hn::Set(floats, std::numeric_limits<float>::quiet_NaN());
  hn::StoreU(hn::IfThenElse(hn::Gt(d, hn::Zero(floats)), above, none), floats, elevation + u);
}

void elevate_row(const float* disparity, int width, float height_m, float first, float step, float* elevation) {
  const Ground ground{height_m, first, step};
  const hn::ScalableTag<float> floats;
  const auto lanes = static_cast<int>(hn::Lanes(floats));
  int u = 0;
  for (; u + lanes <= width; u += lanes) elevate(floats, ground, disparity, u, elevation);
  for (; u < width; ++u) elevate(hn::CappedTag<float, 1>(), ground, disparity, u, elevation);
}

}  // namespace
}  // namespace brink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace brink {

HWY_EXPORT(elevate_row);

void compute_elevation_row(const float* disparity, int width, float height_m, float first, float step, float* elevation) {
  HWY_DYNAMIC_DISPATCH(elevate_row)(disparity, width, height_m, first, step, elevation);
}

}  // namespace brink
#endif  // HWY_ONCE
