#include "ego_motion/features_simd.hpp"

#include <bit>

#include "simd/set_bits.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ego_motion/features_simd.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace brink::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// Calls f(tag, first) for the vectors that cover [begin, end): as long as may be, then shorter ones.
template <class F>
HWY_INLINE void for_each_vector(int begin, int end, const F& f) {
  const hn::ScalableTag<std::int16_t> all;
  const hn::CappedTag<std::int16_t, 8> some;
  const hn::CappedTag<std::int16_t, 1> one;
  const auto all_lanes = static_cast<int>(hn::Lanes(all));
  const auto some_lanes = static_cast<int>(hn::Lanes(some));
  int u = begin;
  for (; u + all_lanes <= end; u += all_lanes) f(all, u);
  for (; u + some_lanes <= end; u += some_lanes) f(some, u);
  for (; u < end; ++u) f(one, u);
}

/// Weighted sums of the five pixels above each other, column by column.
struct ColumnSums {
  ColumnSums(std::int16_t* scratch, std::ptrdiff_t columns)
      : blob_centre(scratch),
        blob_inner(blob_centre + columns),
        blob_outer(blob_inner + columns),
        checker(blob_outer + columns),
        smooth(checker + columns),
        derivative(smooth + columns) {}
  std::int16_t* blob_centre;
  std::int16_t* blob_inner;
  std::int16_t* blob_outer;  ///< of which the filter has the negative
  std::int16_t* checker;
  std::int16_t* smooth;
  std::int16_t* derivative;
};

/// Columns [u, u + lanes of the tag).
template <class D>
HWY_INLINE void add_columns(D shorts, const std::uint8_t* const* rows, int u, const ColumnSums& sums) {
  const auto load = [&](int row)
                        HWY_ATTR { return hn::PromoteTo(shorts, hn::LoadU(hn::Rebind<std::uint8_t, D>(), rows[row] + u)); };
  const auto top = load(0);
  const auto upper = load(1);
  const auto centre = load(2);
  const auto lower = load(3);
  const auto bottom = load(4);
  const auto inner = hn::Add(upper, lower);
  const auto outer = hn::Add(top, bottom);
  const auto ring = hn::Sub(hn::Add(inner, centre), outer);  // 2 (three rows) - (five rows)
  hn::StoreU(hn::Add(ring, hn::Sub(hn::ShiftLeft<3>(centre), centre)), shorts, sums.blob_centre + u);
  hn::StoreU(ring, shorts, sums.blob_inner + u);
  hn::StoreU(hn::Add(hn::Add(inner, centre), outer), shorts, sums.blob_outer + u);
  const auto far_step = hn::Sub(bottom, top);
  const auto near_step = hn::Sub(lower, upper);
  hn::StoreU(hn::Add(far_step, near_step), shorts, sums.checker + u);
  hn::StoreU(hn::Add(far_step, hn::Add(near_step, near_step)), shorts, sums.derivative + u);
  const auto inner_and_centre = hn::Add(hn::ShiftLeft<1>(inner), hn::Add(hn::ShiftLeft<1>(centre), centre));
  hn::StoreU(hn::Add(outer, hn::ShiftLeft<1>(inner_and_centre)), shorts, sums.smooth + u);
}

/// A 128th, rounded half to even, around 128.
template <class D, class V>
HWY_INLINE V to_gradient(D shorts, V sum) {
  const auto odd = hn::And(hn::ShiftRight<7>(sum), hn::Set(shorts, std::int16_t{1}));
  return hn::Add(hn::ShiftRight<7>(hn::Add(hn::Add(sum, odd), hn::Set(shorts, std::int16_t{63}))),
                 hn::Set(shorts, std::int16_t{128}));
}

/// Pixels [u, u + lanes of the tag): their columns are [u, u + 4 + lanes).
template <class D>
HWY_INLINE void filter_pixels(D shorts, const ColumnSums& sums, int u, const FilteredRow& filtered) {
  const auto load = [&](const std::int16_t* columns, int i) HWY_ATTR { return hn::LoadU(shorts, columns + u + i); };
  const auto ends = hn::Add(load(sums.blob_outer, 0), load(sums.blob_outer, 4));
  const auto sides = hn::Add(load(sums.blob_inner, 1), load(sums.blob_inner, 3));
  hn::StoreU(hn::Sub(hn::Add(load(sums.blob_centre, 2), sides), ends), shorts, filtered.blobs + u);
  const auto right = hn::Add(load(sums.checker, 3), load(sums.checker, 4));
  const auto left = hn::Add(load(sums.checker, 0), load(sums.checker, 1));
  hn::StoreU(hn::Sub(right, left), shorts, filtered.corners + u);
  const auto near_step = hn::Sub(load(sums.smooth, 3), load(sums.smooth, 1));
  const auto far_step = hn::Sub(load(sums.smooth, 4), load(sums.smooth, 0));
  const auto along = to_gradient(shorts, hn::Add(far_step, hn::Add(near_step, near_step)));
  const auto centre = load(sums.derivative, 2);
  const auto inner = hn::Add(load(sums.derivative, 1), load(sums.derivative, 3));
  const auto outer = hn::Add(load(sums.derivative, 0), load(sums.derivative, 4));
  const auto inner_and_centre = hn::Add(hn::ShiftLeft<1>(inner), hn::Add(hn::ShiftLeft<1>(centre), centre));
  const auto down = to_gradient(shorts, hn::Add(outer, hn::ShiftLeft<1>(inner_and_centre)));
  const hn::Rebind<std::uint16_t, D> pairs;
  hn::StoreU(hn::BitCast(pairs, hn::Or(along, hn::ShiftLeft<8>(down))), pairs, filtered.gradients + u);
}

void filter_one_row(const std::uint8_t* const* rows, int width, std::int16_t* scratch, const FilteredRow& filtered) {
  const int columns = width + 2 * kFilterRadius;
  const ColumnSums sums(scratch, columns);
  for_each_vector(0, columns, [&](auto shorts, int u) HWY_ATTR { add_columns(shorts, rows, u, sums); });
  for_each_vector(0, width, [&](auto shorts, int u) HWY_ATTR { filter_pixels(shorts, sums, u, filtered); });
}

/// The least and the greatest of each of the columns [u, u + lanes of the tag).
template <class D>
HWY_INLINE void find_limits(D shorts, const std::int16_t* const* rows, int count, int u, std::int16_t* least,
                            std::int16_t* greatest) {
  auto low = hn::LoadU(shorts, rows[0] + u);
  auto high = low;
  for (int i = 1; i < count; ++i) {
    const auto response = hn::LoadU(shorts, rows[i] + u);
    low = hn::Min(low, response);
    high = hn::Max(high, response);
  }
  hn::StoreU(low, shorts, least);
  hn::StoreU(high, shorts, greatest);
}

/// Which of the pixels [u, u + lanes of the tag) are extrema, a bit each.
/// @param least of the columns from u - radius on. @param greatest likewise.
template <class D>
HWY_INLINE std::uint64_t select_extrema(D shorts, const std::int16_t* row, const std::int16_t* least,
                                        const std::int16_t* greatest, int radius, int u, std::int16_t least_strength) {
  auto low = hn::LoadU(shorts, least);
  auto high = hn::LoadU(shorts, greatest);
  for (int i = 1; i <= 2 * radius; ++i) {
    low = hn::Min(low, hn::LoadU(shorts, least + i));
    high = hn::Max(high, hn::LoadU(shorts, greatest + i));
  }
  const auto response = hn::LoadU(shorts, row + u);
  const auto weak = hn::Set(shorts, static_cast<std::int16_t>(least_strength - 1));
  const auto minimum = hn::And(hn::Eq(response, low), hn::Lt(response, hn::Neg(weak)));
  const auto maximum = hn::And(hn::Eq(response, high), hn::Gt(response, weak));
  std::uint64_t bits = 0;
  hn::StoreMaskBits(shorts, hn::Or(minimum, maximum), reinterpret_cast<std::uint8_t*>(&bits));
  return bits;
}

/// Stores the columns of the bits that are set, of `count` from column u on. @return where the next one goes.
HWY_INLINE std::int32_t* store_columns(std::uint64_t bits, std::size_t count, int u, std::int32_t* columns) {
  const hn::CappedTag<std::int32_t, 8> ints;
  for (std::size_t first = 0; first < count; first += 8) {
    const std::uint64_t eight = bits >> first & 0xFFU;
    const std::uint8_t* const numbers = kSetBits.numbers[eight];
    const auto column = hn::Set(ints, u + static_cast<int>(first));
    for (std::size_t i = 0; i < 8; i += hn::Lanes(ints)) {
      const auto number = hn::PromoteTo(ints, hn::LoadU(hn::Rebind<std::uint8_t, decltype(ints)>(), numbers + i));
      hn::StoreU(hn::Add(number, column), ints, columns + i);
    }
    columns += std::popcount(eight);
  }
  return columns;
}

std::size_t find_in_row(const std::int16_t* const* rows, int radius, int begin, int end, int least_strength,
                        std::int16_t* scratch, std::int32_t* columns) {
  const int first = begin - radius;
  const int last = end + radius;
  std::int16_t* const least = scratch;
  std::int16_t* const greatest = scratch + (last - first);
  for_each_vector(first, last, [&](auto shorts, int u) HWY_ATTR {
    find_limits(shorts, rows, 2 * radius + 1, u, least + u - first, greatest + u - first);
  });
  const auto strength = static_cast<std::int16_t>(least_strength);
  std::int32_t* next = columns;
  for_each_vector(begin, end, [&](auto shorts, int u) HWY_ATTR {
    const int i = u - begin;
    const std::uint64_t bits = select_extrema(shorts, rows[radius], least + i, greatest + i, radius, u, strength);
    next = store_columns(bits, hn::Lanes(shorts), u, next);
  });
  return static_cast<std::size_t>(next - columns);
}

}  // namespace
}  // namespace brink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace brink {

HWY_EXPORT(filter_one_row);
HWY_EXPORT(find_in_row);

void filter_row(const std::array<const std::uint8_t*, 5>& rows, int width, std::int16_t* scratch, const FilteredRow& filtered) {
  HWY_DYNAMIC_DISPATCH(filter_one_row)(rows.data(), width, scratch, filtered);
}

std::size_t find_row_extrema(const std::int16_t* const* rows, int radius, int begin, int end, int least_strength,
                             std::int16_t* scratch, std::int32_t* columns) {
  return HWY_DYNAMIC_DISPATCH(find_in_row)(rows, radius, begin, end, least_strength, scratch, columns);
}

}  // namespace brink
#endif  // HWY_ONCE
