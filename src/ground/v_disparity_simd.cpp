#include "ground/v_disparity_simd.hpp"

#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ground/v_disparity_simd.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace brink::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// Rows [row, row + lanes of the tag). Places in the histogram are whole numbers that doubles hold exactly.
template <class D>
HWY_INLINE void count_rows(D doubles, const CumulativeCounts& histogram, const double* row_v, int row, const LineBand& band,
                           int* band_counts) {
  const hn::Rebind<std::int32_t, D> ints;
  const auto zero = hn::Zero(doubles);
  const auto bins = hn::Set(doubles, histogram.bins);
  const auto bins_per_px = hn::Set(doubles, histogram.bins_per_px);
  const auto d = hn::Add(hn::Mul(hn::Set(doubles, band.slope), hn::LoadU(doubles, row_v + row)), hn::Set(doubles, band.offset));
  const auto tolerance = hn::Max(hn::Set(doubles, band.tolerance_px), hn::Mul(hn::Set(doubles, band.relative_tolerance), d));
  const auto low = hn::Floor(hn::Mul(hn::Sub(d, tolerance), bins_per_px));
  const auto high = hn::Ceil(hn::Mul(hn::Add(d, tolerance), bins_per_px));
  const auto first = hn::Min(hn::Max(low, zero), bins);
  const auto last = hn::IfThenElse(hn::Gt(d, zero), hn::Min(hn::Max(high, zero), bins), first);
  const auto count_before = [&](auto bin) {
    const auto place = hn::Add(hn::Mul(bin, hn::Set(doubles, histogram.rows)), hn::Iota(doubles, row));
    return hn::GatherIndex(ints, histogram.counts, hn::DemoteTo(ints, place));
  };
  hn::StoreU(hn::Sub(count_before(last), count_before(first)), ints, band_counts + row);
}

void count_band(const CumulativeCounts& histogram, const double* row_v, int begin, int end, const LineBand& band,
                int* band_counts) {
  const hn::CappedTag<double, 4> doubles;
  const auto lanes = static_cast<int>(hn::Lanes(doubles));
  int row = begin;
  for (; row + lanes <= end; row += lanes) count_rows(doubles, histogram, row_v, row, band, band_counts);
  for (; row < end; ++row) count_rows(hn::CappedTag<double, 1>(), histogram, row_v, row, band, band_counts);
}

}  // namespace
}  // namespace brink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace brink {

HWY_EXPORT(count_band);

void count_rows_in_band(const CumulativeCounts& histogram, const double* row_v, int begin, int end, const LineBand& band,
                        int* band_counts) {
  HWY_DYNAMIC_DISPATCH(count_band)(histogram, row_v, begin, end, band, band_counts);
}

}  // namespace brink
#endif  // HWY_ONCE
