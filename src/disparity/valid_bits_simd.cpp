#include "disparity/valid_bits_simd.hpp"

#include <array>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "disparity/valid_bits_simd.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "brink/disparity.hpp"

HWY_BEFORE_NAMESPACE();
namespace brink::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// The lanes of a mask as bits, the first lane lowest.
template <class D, class Mask>
HWY_INLINE std::uint64_t to_bits(D floats, Mask mask) {
  std::array<std::uint8_t, 8> bytes{};
  hn::StoreMaskBits(floats, mask, bytes.data());
  return bytes[0] | static_cast<std::uint64_t>(bytes[1]) << 8U;
}

void find_bits(const float* row, int width, float similarity_px, ValidBits& bits) {
  const std::size_t words = (static_cast<std::size_t>(width) + 63) / 64;
  bits.valid.assign(words, 0);
  bits.joined.assign(words, 0);
  /// Of the pixel and the lanes - 1 behind it, and what they are joined to.
  const auto find = [&](auto floats, int u) {
    const auto none = hn::Set(floats, kInvalidDisparity);
    const auto here = hn::LoadU(floats, row + u);
    const auto next = hn::LoadU(floats, row + u + 1);
    const auto valid = hn::Ne(here, none);
    const auto alike = hn::Le(hn::Abs(hn::Sub(next, here)), hn::Set(floats, similarity_px));
    const auto joined = hn::And(hn::And(valid, hn::Ne(next, none)), alike);
    const auto word = static_cast<std::size_t>(u / 64);
    const auto shift = static_cast<unsigned>(u % 64);
    bits.valid[word] |= to_bits(floats, valid) << shift;
    bits.joined[word] |= to_bits(floats, joined) << shift;
  };
  const hn::CappedTag<float, 16> floats;
  const auto lanes = static_cast<int>(hn::Lanes(floats));
  int u = 0;
  for (; u + lanes < width; u += lanes) find(floats, u);
  for (; u + 1 < width; ++u) find(hn::CappedTag<float, 1>(), u);
  if (u < width && row[u] != kInvalidDisparity)
    bits.valid[static_cast<std::size_t>(u / 64)] |= std::uint64_t{1} << static_cast<unsigned>(u % 64);
}

}  // namespace
}  // namespace brink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace brink {

HWY_EXPORT(find_bits);

void find_valid_bits(const float* row, int width, float similarity_px, ValidBits& bits) {
  HWY_DYNAMIC_DISPATCH(find_bits)(row, width, similarity_px, bits);
}

}  // namespace brink
#endif  // HWY_ONCE
