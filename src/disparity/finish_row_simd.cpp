#include <cstddef>
#include <cstdint>
#include <vector>

#include "disparity/dense_matching_simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "disparity/finish_row_simd.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace brink::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// The last step for the pixels of a row: which are certain, and where between whole numbers they lie.
class RowFinisher {
 public:
  RowFinisher(View view, int width, const RowSearch& found, const RowPrior& prior, const ElasParams& params)
      : from_left_(view == View::left),
        width_(width),
        found_(found),
        prior_(prior),
        max_disparity_(static_cast<float>(params.max_disparity)),
        margin_(params.match_margin > 0.0),
        keep_(static_cast<float>(1.0 - params.match_margin)),
        subpixel_(params.subpixel) {}

  /// Pixels [u, u + lanes of the tag).
  template <class D>
  void finish(D floats, int u, float* disparity) const {
    const auto at = static_cast<std::size_t>(u);
    const hn::Rebind<std::int16_t, D> shorts;
    const hn::Rebind<std::int32_t, D> ints;
    const auto load = [&](const std::vector<std::int16_t>& row) {
      return hn::ConvertTo(floats, hn::PromoteTo(ints, hn::LoadU(shorts, row.data() + at)));
    };
    const auto none = hn::Set(floats, static_cast<float>(RowSearch::kNoEnergy));
    const auto energy = load(found_.energy);
    const auto rival = load(found_.rival);
    const auto whole = load(found_.disparity);
    const auto textured = hn::PromoteTo(ints, hn::LoadU(hn::Rebind<std::uint8_t, D>(), prior_.textured + u));
    auto wanted = hn::Ne(textured, hn::Zero(ints));
    if (!prior_.outside) {
      const auto code = hn::PromoteTo(ints, hn::LoadU(shorts, prior_.expected + u));
      wanted = hn::And(wanted, hn::Ne(code, hn::Set(ints, ExpectedDisparity::kNoPlane)));
    }
    auto valid = hn::And(hn::Ne(energy, none), hn::RebindMask(floats, wanted));
    if (margin_) {
      const auto certain = hn::Lt(energy, hn::Mul(hn::Set(floats, keep_), rival));
      valid = hn::And(valid, hn::Or(hn::Eq(rival, none), certain));
    }
    const auto result = subpixel_ ? refine(floats, u, whole) : whole;
    hn::StoreU(hn::IfThenElse(valid, result, hn::Set(floats, kInvalidDisparity)), floats, disparity + u);
  }

 private:
  /// Moves a disparity by up to half a pixel, to the tip of two lines of equal and opposite slope through the costs of it and
  /// its neighbours: an L1 cost is such a wedge, not a parabola.
  template <class D>
  hn::Vec<D> refine(D floats, int u, hn::Vec<D> whole) const {
    const hn::Rebind<std::int16_t, D> shorts;
    const hn::Rebind<std::int32_t, D> ints;
    const auto load = [&](const std::vector<std::int16_t>& row) {
      return hn::ConvertTo(floats, hn::PromoteTo(ints, hn::LoadU(shorts, row.data() + u)));
    };
    const auto below = load(found_.cost_below);
    const auto above = load(found_.cost_above);
    const auto rise = hn::Sub(hn::Max(below, above), load(found_.cost));
    const auto columns = hn::Iota(floats, static_cast<float>(u));
    const auto room = from_left_ ? columns : hn::Sub(hn::Set(floats, static_cast<float>(width_ - 1)), columns);
    const auto largest = hn::Min(room, hn::Set(floats, max_disparity_));
    const auto inside = hn::And(hn::Ge(whole, hn::Set(floats, 1.0F)), hn::Lt(whole, largest));
    const auto half = hn::Set(floats, 0.5F);
    const auto shift = hn::Div(hn::Sub(below, above), hn::Add(rise, rise));
    const auto moved = hn::Add(whole, hn::Max(hn::Neg(half), hn::Min(half, shift)));
    return hn::IfThenElse(hn::And(inside, hn::Gt(rise, hn::Zero(floats))), moved, whole);
  }

  bool from_left_;
  int width_;
  const RowSearch& found_;
  const RowPrior& prior_;
  float max_disparity_;
  bool margin_;
  float keep_;
  bool subpixel_;
};

void finish_pixels(View view, const RowSearch& search, const RowPrior& prior, const ElasParams& params, float* disparity) {
  const int width = prior.width;
  const RowFinisher finisher(view, width, search, prior, params);
  const hn::ScalableTag<float> floats;
  const auto step = static_cast<int>(hn::Lanes(floats));
  int u = 0;
  for (; u + step <= width; u += step) finisher.finish(floats, u, disparity);
  for (; u < width; ++u) finisher.finish(hn::CappedTag<float, 1>(), u, disparity);
}

}  // namespace
}  // namespace brink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace brink {

HWY_EXPORT(finish_pixels);

void finish_row(View view, const RowSearch& search, const RowPrior& prior, const ElasParams& params, float* disparity) {
  HWY_DYNAMIC_DISPATCH(finish_pixels)(view, search, prior, params, disparity);
}

}  // namespace brink
#endif  // HWY_ONCE
