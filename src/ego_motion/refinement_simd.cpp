#include "ego_motion/refinement_simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ego_motion/refinement_simd.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace brink::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, kPatchLanes>;
using Ints = hn::Rebind<std::int32_t, Floats>;

/// A picture as vectors look at it.
class Sampler {
 public:
  HWY_INLINE explicit Sampler(const PicturePixels& picture)
      : levels_(picture.levels),
        stride_(hn::Set(Ints(), picture.stride)),
        last_column_(hn::Set(Ints(), picture.columns - 2)),
        last_row_(hn::Set(Ints(), picture.rows - 2)) {}

  [[nodiscard]] HWY_INLINE hn::Vec<Floats> sample(hn::Vec<Floats> u, hn::Vec<Floats> v) const {
    const Floats floats;
    const Ints ints;
    const auto zero = hn::Zero(ints);
    const auto column = hn::Min(hn::Max(hn::ConvertTo(ints, u), zero), last_column_);
    const auto row = hn::Min(hn::Max(hn::ConvertTo(ints, v), zero), last_row_);
    const auto a = hn::Sub(u, hn::ConvertTo(floats, column));
    const auto b = hn::Sub(v, hn::ConvertTo(floats, row));
    // Four bytes from the upper left pixel on, and four up to the lower right one: never outside the picture.
    const auto first = hn::Add(hn::Mul(row, stride_), column);
    const auto upper = hn::BitCast(hn::RebindToUnsigned<Ints>(), gather(first));
    const auto lower = hn::BitCast(hn::RebindToUnsigned<Ints>(), gather(hn::Sub(hn::Add(first, stride_), hn::Set(ints, 2))));
    const auto above = mix(a, to_level(upper), to_level(hn::ShiftRight<8>(upper)));
    const auto below = mix(a, to_level(hn::ShiftRight<16>(lower)), to_level(hn::ShiftRight<24>(lower)));
    return mix(b, above, below);
  }

 private:
  [[nodiscard]] HWY_INLINE hn::Vec<Ints> gather(hn::Vec<Ints> offsets) const {
    return hn::GatherOffset(Ints(), reinterpret_cast<const std::int32_t*>(levels_), offsets);
  }
  template <class V>
  static HWY_INLINE hn::Vec<Floats> to_level(V bytes) {
    const hn::RebindToUnsigned<Ints> words;
    return hn::ConvertTo(Floats(), hn::BitCast(Ints(), hn::And(bytes, hn::Set(words, 0xFFU))));
  }
  static HWY_INLINE hn::Vec<Floats> mix(hn::Vec<Floats> share, hn::Vec<Floats> first, hn::Vec<Floats> second) {
    const auto rest = hn::Sub(hn::Set(Floats(), 1.0F), share);
    return hn::Add(hn::Mul(rest, first), hn::Mul(share, second));
  }

  const std::uint8_t* levels_;
  hn::Vec<Ints> stride_;
  hn::Vec<Ints> last_column_;
  hn::Vec<Ints> last_row_;
};

HWY_INLINE hn::Vec<Floats> load(const PatchLanes& lanes, std::size_t first) {
  return hn::LoadU(Floats(), lanes.data() + first);
}
HWY_INLINE void store(hn::Vec<Floats> values, PatchLanes& lanes, std::size_t first) {
  hn::StoreU(values, Floats(), lanes.data() + first);
}

/// The patches of the lanes [first, first + lanes of a vector).
HWY_INLINE void compare_lanes(const PatchPixels* patches, const PatchPlaces& places, const Sampler& sampler, std::size_t first,
                              PatchComparison& comparison) {
  const Floats floats;
  const std::size_t lanes = hn::Lanes(floats);
  HWY_ALIGN float row_u[kPatchSide * kPatchLanes];     // NOLINT(modernize-avoid-c-arrays)
  HWY_ALIGN float row_v[kPatchSide * kPatchLanes];     // NOLINT(modernize-avoid-c-arrays)
  HWY_ALIGN float levels[kPatchPixels * kPatchLanes];  // NOLINT(modernize-avoid-c-arrays)
  for (int x = -kPatchRadius; x <= kPatchRadius; ++x) {
    const std::size_t i = static_cast<std::size_t>(x + kPatchRadius) * lanes;
    const auto steps = hn::Set(floats, static_cast<float>(x));
    hn::Store(hn::Add(load(places.u, first), hn::Mul(load(places.u_by_x, first), steps)), floats, row_u + i);
    hn::Store(hn::Add(load(places.v, first), hn::Mul(load(places.v_by_x, first), steps)), floats, row_v + i);
  }
  auto sum = hn::Zero(floats);
  float* level = levels;
  for (int y = -kPatchRadius; y <= kPatchRadius; ++y) {
    const auto steps = hn::Set(floats, static_cast<float>(y));
    const auto down_u = hn::Mul(load(places.u_by_y, first), steps);
    const auto down_v = hn::Mul(load(places.v_by_y, first), steps);
    for (std::size_t i = 0; i < kPatchSide * lanes; i += lanes, level += lanes) {
      const auto found =
          sampler.sample(hn::Add(hn::Load(floats, row_u + i), down_u), hn::Add(hn::Load(floats, row_v + i), down_v));
      hn::Store(found, floats, level);
      sum = hn::Add(sum, found);
    }
  }
  const auto mean = hn::Div(sum, hn::Set(floats, static_cast<float>(kPatchPixels)));
  auto gradient_u = hn::Zero(floats);
  auto gradient_v = hn::Zero(floats);
  auto squares = hn::Zero(floats);
  auto correlation = hn::Zero(floats);
  auto contrast = hn::Zero(floats);
  level = levels;
  for (const PatchPixels* pixel = patches; pixel != patches + kPatchPixels; ++pixel, level += lanes) {
    const auto found = hn::Sub(hn::Load(floats, level), mean);
    const auto sought = load(pixel->level, first);
    const auto difference = hn::Sub(found, sought);
    gradient_u = hn::Add(gradient_u, hn::Mul(difference, load(pixel->gradient_u, first)));
    gradient_v = hn::Add(gradient_v, hn::Mul(difference, load(pixel->gradient_v, first)));
    squares = hn::Add(squares, hn::Mul(difference, difference));
    correlation = hn::Add(correlation, hn::Mul(sought, found));
    contrast = hn::Add(contrast, hn::Mul(found, found));
  }
  store(gradient_u, comparison.gradient_u, first);
  store(gradient_v, comparison.gradient_v, first);
  store(squares, comparison.squares, first);
  store(correlation, comparison.correlation, first);
  store(contrast, comparison.contrast, first);
}

void compare_all_lanes(const PatchPixels* patches, const PatchPlaces& places, const PicturePixels& picture,
                       PatchComparison& comparison) {
  const Sampler sampler(picture);
  for (std::size_t first = 0; first < kPatchLanes; first += hn::Lanes(Floats()))
    compare_lanes(patches, places, sampler, first, comparison);
}

}  // namespace
}  // namespace brink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace brink {

HWY_EXPORT(compare_all_lanes);

PatchComparison compare_patches(const PatchPixels* patches, const PatchPlaces& places, const PicturePixels& picture) {
  PatchComparison comparison;
  HWY_DYNAMIC_DISPATCH(compare_all_lanes)(patches, places, picture, comparison);
  return comparison;
}

}  // namespace brink
#endif  // HWY_ONCE
