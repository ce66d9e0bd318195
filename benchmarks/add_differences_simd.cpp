#include "add_differences_simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "add_differences_simd.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "simd/sums_of_differences-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace brink::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

std::uint64_t add_up(const Descriptor* a, const Descriptor* b, std::size_t count) {
#if HWY_TARGET == HWY_SCALAR
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < count; ++i) sum += static_cast<std::uint64_t>(compute_cost(a[i], b[i]));
  return sum;
#else
  const Bytes bytes;
  const std::size_t step = descriptors_per_vector();
  auto even = hn::Zero(Words());  // two sums, so that neither waits for the other
  auto odd = hn::Zero(Words());
  for (std::size_t i = 0; i < count; i += 2 * step) {
    even = hn::Add(even, sum_differences(hn::LoadU(bytes, a[i].data()), hn::LoadU(bytes, b[i].data())));
    odd = hn::Add(odd, sum_differences(hn::LoadU(bytes, a[i + step].data()), hn::LoadU(bytes, b[i + step].data())));
  }
  return hn::GetLane(hn::SumOfLanes(Words(), hn::Add(even, odd)));
#endif
}

}  // namespace
}  // namespace brink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace brink {

HWY_EXPORT(add_up);

namespace benchmarks {

std::uint64_t add_differences(const Descriptor* a, const Descriptor* b, std::size_t count) {
  return HWY_DYNAMIC_DISPATCH(add_up)(a, b, count);
}

}  // namespace benchmarks
}  // namespace brink
#endif  // HWY_ONCE
