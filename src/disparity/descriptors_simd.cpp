#include "disparity/descriptors_simd.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "disparity/descriptors_simd.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "simd/sums_of_differences-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace brink::HWY_NAMESPACE {
namespace {

#if HWY_TARGET == HWY_SCALAR

void gather(const DescriptorSamples& samples, std::size_t width, Descriptor* row) {
  for (std::size_t u = 0; u < width; ++u) row[u] = describe(samples, static_cast<int>(u));
}

void add_up_texture(const Descriptor* row, std::size_t width, std::int16_t* texture) {
  for (std::size_t u = 0; u < width; ++u) texture[u] = static_cast<std::int16_t>(compute_texture(row[u]));
}

#else

using SixteenBytes = hn::FixedTag<std::uint8_t, 16>;
using Matrix = hn::Vec<SixteenBytes>[16];  // NOLINT(modernize-avoid-c-arrays): as EightSums

/// Merges rows i and i + 8 of a 16x16 matrix of bytes; four times makes columns of its rows.
HWY_INLINE void interleave_halves(SixteenBytes bytes, const Matrix& from, Matrix& to) {
  for (std::size_t i = 0; i < 8; ++i) {
    to[2 * i] = hn::InterleaveLower(bytes, from[i], from[i + 8]);
    to[2 * i + 1] = hn::InterleaveUpper(bytes, from[i], from[i + 8]);
  }
}

void gather(const DescriptorSamples& samples, std::size_t width, Descriptor* row) {
  const SixteenBytes bytes;
  const std::size_t whole = width - width % 16;
  for (std::size_t u = 0; u < whole; u += 16) {
    Matrix a;
    Matrix b;
    for (std::size_t k = 0; k < 16; ++k) a[k] = hn::LoadU(bytes, samples[k] + u);
    interleave_halves(bytes, a, b);
    interleave_halves(bytes, b, a);
    interleave_halves(bytes, a, b);
    interleave_halves(bytes, b, a);
    for (std::size_t k = 0; k < 16; ++k) hn::StoreU(a[k], bytes, row[u + k].data());
  }
  for (std::size_t u = whole; u < width; ++u) row[u] = describe(samples, static_cast<int>(u));
}

void add_up_texture(const Descriptor* row, std::size_t width, std::int16_t* texture) {
  const Bytes bytes;
  const Shorts shorts;
  const std::size_t step = descriptors_per_vector();
  const std::size_t lanes = hn::Lanes(shorts);
  const auto no_gradient = hn::Set(bytes, 128);
  const std::size_t whole = width - width % lanes;
  for (std::size_t u = 0; u < whole; u += lanes) {
    EightSums sums;
    for (std::size_t j = 0; j < 8; ++j) sums[j] = sum_differences(hn::LoadU(bytes, row[u + j * step].data()), no_gradient);
    store_in_order(pack_sums(sums), reinterpret_cast<std::uint16_t*>(texture + u));
  }
  for (std::size_t u = whole; u < width; ++u) texture[u] = static_cast<std::int16_t>(compute_texture(row[u]));
}

#endif  // HWY_TARGET == HWY_SCALAR

}  // namespace
}  // namespace brink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace brink {

HWY_EXPORT(gather);
HWY_EXPORT(add_up_texture);

void gather_descriptors(const DescriptorSamples& samples, int width, Descriptor* row) {
  HWY_DYNAMIC_DISPATCH(gather)(samples, static_cast<std::size_t>(width), row);
}

void compute_texture_row(const Descriptor* row, int width, std::int16_t* texture) {
  HWY_DYNAMIC_DISPATCH(add_up_texture)(row, static_cast<std::size_t>(width), texture);
}

}  // namespace brink
#endif  // HWY_ONCE
