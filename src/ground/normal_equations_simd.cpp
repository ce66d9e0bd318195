#include "ground/normal_equations_simd.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ground/normal_equations_simd.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace brink::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kMostLanes = 4;

/// The terms of the sums, four by four of one sample side by side.
struct Terms {
  std::array<double, 4 * kMostLanes> first;   // w u u, w u v, w u, w v v
  std::array<double, 4 * kMostLanes> second;  // w v, w, w d u, w d v
  std::array<double, kMostLanes> last;        // w d
};

/// Of the samples [i, i + lanes of the tag); 0 of those outside the band.
template <class D>
HWY_INLINE void weigh(D doubles, const DisparitySample* samples, double cx, const GroundPlane& plane, const SampleBand& band,
                      Terms& terms) {
  const hn::Rebind<float, D> floats;
  auto float_u = hn::Undefined(floats);
  auto float_v = hn::Undefined(floats);
  auto float_d = hn::Undefined(floats);
  hn::LoadInterleaved3(floats, &samples->u, float_u, float_v, float_d);
  const auto u = hn::PromoteTo(doubles, float_u);
  const auto v = hn::PromoteTo(doubles, float_v);
  const auto d = hn::PromoteTo(doubles, float_d);
  const auto au = hn::Mul(hn::Set(doubles, plane.a), hn::Add(u, hn::Set(doubles, cx)));
  const auto expected = hn::Add(hn::Add(au, hn::Mul(hn::Set(doubles, plane.b), v)), hn::Set(doubles, plane.c));
  const auto error = hn::Sub(d, expected);
  const auto tolerance = hn::Max(hn::Set(doubles, band.tolerance_px), hn::Mul(hn::Set(doubles, band.tolerance_ratio), d));
  const auto half_width = hn::Mul(hn::Set(doubles, band.widen), tolerance);
  const auto is_outside = hn::Or(hn::Le(expected, hn::Zero(doubles)), hn::Ge(hn::Abs(error), half_width));
  const auto residual = hn::Div(error, half_width);
  const auto root = hn::Sub(hn::Set(doubles, 1.0), hn::Mul(residual, residual));
  const auto w = hn::IfThenZeroElse(is_outside, hn::Mul(root, root));
  const auto wu = hn::Mul(w, u);
  const auto wv = hn::Mul(w, v);
  const auto wd = hn::Mul(w, d);
  hn::StoreInterleaved4(hn::Mul(wu, u), hn::Mul(wu, v), wu, hn::Mul(wv, v), doubles, terms.first.data());
  hn::StoreInterleaved4(wv, w, hn::Mul(wd, u), hn::Mul(wd, v), doubles, terms.second.data());
  hn::StoreU(wd, doubles, terms.last.data());
}

/// Sums kept in registers.
struct Sums {
  HWY_INLINE void add(const Terms& terms, std::size_t lanes) {
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      for (std::size_t k = 0; k < 4; ++k) first[k] += terms.first[4 * lane + k];
      for (std::size_t k = 0; k < 4; ++k) second[k] += terms.second[4 * lane + k];
      last += terms.last[lane];
    }
  }
  std::array<double, 4> first{};
  std::array<double, 4> second{};
  double last = 0.0;
};

void add_up(const std::vector<DisparitySample>& samples, double cx, const GroundPlane& plane, const SampleBand& band,
            NormalEquations& equations) {
  const hn::CappedTag<double, kMostLanes> doubles;
  const std::size_t lanes = hn::Lanes(doubles);
  Terms terms{};
  Sums sums;
  std::size_t i = 0;
  for (; i + lanes <= samples.size(); i += lanes) {
    weigh(doubles, samples.data() + i, cx, plane, band, terms);
    sums.add(terms, lanes);
  }
  // The rest in full lanes, too: one lane alone sends StoreInterleaved4 of Highway 1.0.3 into endless recursion on NEON.
  std::array<DisparitySample, kMostLanes> rest{};
  std::copy(samples.begin() + static_cast<std::ptrdiff_t>(i), samples.end(), rest.begin());
  weigh(doubles, rest.data(), cx, plane, band, terms);
  sums.add(terms, samples.size() - i);
  std::copy(sums.first.begin(), sums.first.end(), equations.begin());
  std::copy(sums.second.begin(), sums.second.end(), equations.begin() + 4);
  equations[8] = sums.last;
}

}  // namespace
}  // namespace brink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace brink {

HWY_EXPORT(add_up);

NormalEquations add_up_normal_equations(const std::vector<DisparitySample>& samples, double cx, const GroundPlane& plane,
                                        const SampleBand& band) {
  NormalEquations equations{};
  HWY_DYNAMIC_DISPATCH(add_up)(samples, cx, plane, band, equations);
  return equations;
}

}  // namespace brink
#endif  // HWY_ONCE
