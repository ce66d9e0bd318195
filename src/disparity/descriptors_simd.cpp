#include "disparity/descriptors_simd.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "disparity/descriptors_simd.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace brink::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Signed = hn::ScalableTag<std::int16_t>;

void compute_row(const std::array<const std::uint8_t*, 3>& rows, int count, std::uint8_t* horizontal, std::uint8_t* vertical) {
  const Signed d16;
  const hn::Rebind<std::uint8_t, Signed> d8;
  const auto& [above, here, below] = rows;
  const auto one = hn::Set(d16, 1);
  const auto middle = hn::Set(d16, 128);
  const auto load = [&](const std::uint8_t* row, int i) { return hn::PromoteTo(d16, hn::LoadU(d8, row + i)); };
  const auto weigh = [](auto before, auto at, auto after) { return hn::Add(hn::Add(before, after), hn::Add(at, at)); };
  const auto store = [&](auto sobel, std::uint8_t* to) {
    const auto odd = hn::And(hn::ShiftRight<2>(sobel), one);
    const auto quarter = hn::ShiftRight<2>(hn::Add(hn::Add(sobel, one), odd));
    hn::StoreU(hn::DemoteTo(d8, hn::Add(quarter, middle)), d8, to);
  };
  for (int i = 0; i < count; i += static_cast<int>(hn::Lanes(d16))) {
    const auto upper_left = load(above, i);
    const auto upper_right = load(above, i + 2);
    const auto lower_left = load(below, i);
    const auto lower_right = load(below, i + 2);
    const auto left = weigh(upper_left, load(here, i), lower_left);
    const auto right = weigh(upper_right, load(here, i + 2), lower_right);
    store(hn::Sub(right, left), horizontal + i);
    const auto upper = weigh(upper_left, load(above, i + 1), upper_right);
    const auto lower = weigh(lower_left, load(below, i + 1), lower_right);
    store(hn::Sub(lower, upper), vertical + i);
  }
}

/// Pixels [u, u + lanes of the tag).
template <class D>
HWY_INLINE void add_up(D d16, const DescriptorSamples& samples, int u, std::int16_t* texture) {
  const hn::Rebind<std::uint8_t, D> d8;
  const auto no_gradient = hn::Set(d16, 128);
  auto sum = hn::Zero(d16);
  for (const std::uint8_t* const sample : samples) {
    sum = hn::Add(sum, hn::Abs(hn::Sub(hn::PromoteTo(d16, hn::LoadU(d8, sample + u)), no_gradient)));
  }
  hn::StoreU(sum, d16, texture + u);
}

void add_up_texture(const DescriptorSamples& samples, int width, std::int16_t* texture) {
  const Signed d16;
  const auto lanes = static_cast<int>(hn::Lanes(d16));
  if (width < lanes) {
    for (int u = 0; u < width; ++u) add_up(hn::CappedTag<std::int16_t, 1>(), samples, u, texture);
    return;
  }
  for (int u = 0; u < width; u += lanes) add_up(d16, samples, std::min(u, width - lanes), texture);  // the last ones twice
}

#if HWY_TARGET == HWY_SCALAR

void gather(const DescriptorSamples& samples, int width, Descriptor* row) {
  for (int u = 0; u < width; ++u) row[u] = describe(samples, u);
}

#else

using Bytes = hn::ScalableTag<std::uint8_t>;
using Matrix = hn::Vec<Bytes>[16];  // NOLINT(modernize-avoid-c-arrays): std::array would be compiled for another target

/// In each block of 16 columns, merges rows i and i + 8 of 16 rows of bytes; four times makes columns of its rows.
HWY_INLINE void interleave_halves(Bytes bytes, const Matrix& from, Matrix& to) {
  for (std::size_t i = 0; i < 8; ++i) {
    to[2 * i] = hn::InterleaveLower(bytes, from[i], from[i + 8]);
    to[2 * i + 1] = hn::InterleaveUpper(bytes, from[i], from[i + 8]);
  }
}

/// Stores blocks of 16 bytes as descriptors of every 16th pixel.
template <class D>
HWY_INLINE void store_blocks(D bytes, hn::Vec<D> blocks, Descriptor* row) {
  if constexpr (hn::MaxLanes(D()) == 16) {
    hn::StoreU(blocks, bytes, row->data());
  } else {
    const hn::Half<D> half;
    store_blocks(half, hn::LowerHalf(half, blocks), row);
    store_blocks(half, hn::UpperHalf(half, blocks), row + hn::MaxLanes(half));
  }
}

void gather(const DescriptorSamples& samples, int width, Descriptor* row) {
  const Bytes bytes;
  for (int u = 0; u < width; u += static_cast<int>(hn::Lanes(bytes))) {
    Matrix a;
    Matrix b;
    for (std::size_t k = 0; k < 16; ++k) a[k] = hn::LoadU(bytes, samples[k] + u);
    interleave_halves(bytes, a, b);
    interleave_halves(bytes, b, a);
    interleave_halves(bytes, a, b);
    interleave_halves(bytes, b, a);
    for (std::size_t k = 0; k < 16; ++k) store_blocks(bytes, a[k], row + u + k);
  }
}

#endif  // HWY_TARGET == HWY_SCALAR

}  // namespace
}  // namespace brink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace brink {

HWY_EXPORT(compute_row);
HWY_EXPORT(gather);
HWY_EXPORT(add_up_texture);

void compute_gradient_rows(const std::array<const std::uint8_t*, 3>& rows, int count, std::uint8_t* horizontal,
                           std::uint8_t* vertical) {
  HWY_DYNAMIC_DISPATCH(compute_row)(rows, count, horizontal, vertical);
}

void gather_descriptors(const DescriptorSamples& samples, int width, Descriptor* row) {
  HWY_DYNAMIC_DISPATCH(gather)(samples, width, row);
}

void compute_texture_row(const DescriptorSamples& samples, int width, std::int16_t* texture) {
  HWY_DYNAMIC_DISPATCH(add_up_texture)(samples, width, texture);
}

}  // namespace brink
#endif  // HWY_ONCE
