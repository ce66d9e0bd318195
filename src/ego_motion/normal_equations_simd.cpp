#include "ego_motion/normal_equations_simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ego_motion/normal_equations_simd.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace brink::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::CappedTag<double, 4>;

HWY_INLINE void add_observation(const LinearObservation& observation, double* sums) {
  const Doubles doubles;
  const std::size_t lanes = hn::Lanes(doubles);
  HWY_ALIGN double rows[4 * kEquationColumns];      // NOLINT(modernize-avoid-c-arrays)
  HWY_ALIGN double weighted[4 * kEquationColumns];  // NOLINT(modernize-avoid-c-arrays)
  const auto weight = hn::Set(doubles, observation.weight);
  for (std::size_t column = 0; column < kEquationColumns; column += lanes) {
    const auto load = [&](std::size_t k) HWY_ATTR { return hn::LoadU(doubles, observation.rows[k].data() + column); };
    for (std::size_t i = 0; i < 4; ++i) {
      const auto times = [&](std::size_t k)
                             HWY_ATTR { return hn::Mul(hn::Set(doubles, observation.sqrt_information[4 * k + i]), load(k)); };
      const auto row = hn::Add(hn::Add(hn::Add(times(0), times(1)), times(2)), times(3));
      hn::Store(row, doubles, rows + i * kEquationColumns + column);
      hn::Store(hn::Mul(weight, row), doubles, weighted + i * kEquationColumns + column);
    }
  }
  for (std::size_t i = 1; i < kEquationColumns; ++i) {
    for (std::size_t column = 0; column <= i; column += lanes) {
      const double* const one = weighted + i;
      const double* const some = rows + column;
      const auto times = [&](std::size_t k) HWY_ATTR {
        return hn::Mul(hn::Set(doubles, one[k * kEquationColumns]), hn::Load(doubles, some + k * kEquationColumns));
      };
      double* const sum = sums + i * kEquationColumns + column;
      const auto product = hn::Add(hn::Add(times(0), times(2)), hn::Add(times(1), times(3)));
      hn::StoreU(hn::Add(hn::LoadU(doubles, sum), product), doubles, sum);
    }
  }
}

void add_all(const LinearObservation* observations, std::size_t count, double* sums) {
  for (const LinearObservation* one = observations; one != observations + count; ++one) add_observation(*one, sums);
}

}  // namespace
}  // namespace brink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace brink {

HWY_EXPORT(add_all);

EquationSums add_observations(const LinearObservation* observations, std::size_t count, const EquationSums& sums) {
  EquationSums result = sums;
  HWY_DYNAMIC_DISPATCH(add_all)(observations, count, result.front().data());
  return result;
}

}  // namespace brink
#endif  // HWY_ONCE
