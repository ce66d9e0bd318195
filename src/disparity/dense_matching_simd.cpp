#include "disparity/dense_matching_simd.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "disparity/dense_matching_simd.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "disparity/disparity_window.hpp"
#include "simd/sums_of_differences-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace brink::HWY_NAMESPACE {
namespace {

constexpr std::size_t kMostLanes = std::max(HWY_MAX_BYTES / 2, 8);
constexpr std::int16_t kNoEnergy = RowSearch::kNoEnergy;

namespace hn = hwy::HWY_NAMESPACE;

/// Matches the pixels of a row, a vector's worth at a time.
class RowMatcher {
 public:
  RowMatcher(View view, const Descriptor* row, const Descriptor* other_row, int v, const RowPrior& prior,
             const CandidateGrid& grid, const Penalty& penalty, const ElasParams& params)
      : direction_(view == View::left ? -1 : 1),
        width_(prior.width),
        row_(row),
        other_row_(other_row),
        prior_(prior),
        grid_(grid),
        penalty_(penalty),
        radius_(static_cast<int>(penalty.near_plane.size()) - 1),
        max_disparity_(params.max_disparity),
        cell_(&grid.at(0, v)),
        cell_end_(grid.cell_px) {}

  /// Pixels that are matched together.
  static std::size_t lanes() {
#if HWY_TARGET == HWY_SCALAR
    return 8;
#else
    return hn::Lanes(Shorts());
#endif
  }

  /// Pixels [first, first + count), at most lanes(). To be called from left to right.
  void match(int first, std::size_t count, RowSearch& found) {
    const Expected planes = find_expected(first, count);
    if (!planes.any_wanted) return;
    find_cells(first, count);
    int least = max_disparity_ + 1;
    int greatest = -1;
    for (std::size_t k = 0; k < cell_count_; ++k) {
      least = std::min(least, cells_[k]->first);
      greatest = std::max(greatest, cells_[k]->last);
    }
    if (planes.least <= planes.greatest) {
      least = std::min(least, std::max(planes.least - radius_, 0));
      greatest = std::max(greatest, std::min(planes.greatest + radius_, max_disparity_));
    }
    if (least > greatest) return;
    prepare(first, count);
    search(first, count, planes, {least, greatest}, found);
  }

 private:
  /// The cells that the pixels lie in.
  void find_cells(int first, std::size_t count) {
    while (cell_end_ <= first) {
      cell_end_ += grid_.cell_px;
      ++cell_;
    }
    cell_count_ = 0;
    for (int u = cell_end_ - grid_.cell_px; u < first + static_cast<int>(count); u += grid_.cell_px) {
      cells_[cell_count_] = cell_ + cell_count_;
      ++cell_count_;
    }
  }

  struct Range {
    int least = 0;
    int greatest = 0;
  };

  /// Largest disparity of a pixel whose counterpart lies in the picture.
  [[nodiscard]] int room(int u) const { return direction_ < 0 ? u : width_ - 1 - u; }

  /// What is expected of the pixels that are wanted; least > greatest when they lie outside all triangles.
  struct Expected {
    bool any_wanted = false;
    int least = std::numeric_limits<std::int16_t>::max();
    int greatest = ExpectedDisparity::kNone;
  };

#if HWY_TARGET == HWY_SCALAR

  Expected find_expected(int first, std::size_t count) const {
    Expected result;
    for (int u = first; u < first + static_cast<int>(count); ++u) {
      if (!prior_.is_wanted(u)) continue;
      result.any_wanted = true;
      if (prior_.expected[u] == ExpectedDisparity::kNoPlane) continue;
      result.least = std::min(result.least, ExpectedDisparity::disparity(prior_.expected[u]));
      result.greatest = std::max(result.greatest, ExpectedDisparity::disparity(prior_.expected[u]));
    }
    return result;
  }

  void prepare(int first, std::size_t count) {
    largest_.fill(-1);
    for (std::size_t i = 0; i < count; ++i) {
      const int u = first + static_cast<int>(i);
      const std::int16_t code = prior_.expected[u];
      expected_[i] = static_cast<std::int16_t>(ExpectedDisparity::disparity(code));
      reliable_[i] = ExpectedDisparity::is_reliable(code) ? expected_[i] : ExpectedDisparity::kNone;
      largest_[i] = static_cast<std::int16_t>(std::min(max_disparity_, room(u)));
    }
  }

  void search(int first, std::size_t count, const Expected& /*planes*/, const Range& candidates, RowSearch& found) const {
    for (std::size_t i = 0; i < count; ++i) {
      const int u = first + static_cast<int>(i);
      if (prior_.is_wanted(u)) search_pixel(u, i, candidates, found);
    }
  }

  void search_pixel(int u, std::size_t i, const Range& candidates, RowSearch& found) const {
    const std::uint64_t* const nearby = grid_.words_of(*(cell_ + (u - (cell_end_ - grid_.cell_px)) / grid_.cell_px));
    const auto cost = [&](int d) { return static_cast<std::int16_t>(compute_cost(row_[u], other_row_[u + direction_ * d])); };
    const auto at = static_cast<std::size_t>(u);
    int earlier = kNoEnergy;
    int last_energy = kNoEnergy;
    int last = -2;
    for (int d = candidates.least; d <= std::min<int>(candidates.greatest, largest_[i]); ++d) {
      if (!contains(nearby[d / 64], d % 64) && std::abs(d - expected_[i]) > radius_) continue;
      const auto off = static_cast<std::size_t>(std::abs(d - reliable_[i]));
      const int penalty = off < penalty_.near_plane.size() ? penalty_.near_plane[off] : penalty_.elsewhere;
      const int energy = Penalty::kUnits * cost(d) + penalty;
      if (energy < found.energy[at]) {
        found.rival[at] = static_cast<std::int16_t>(last == d - 1 ? earlier : std::min(earlier, last_energy));
        found.energy[at] = static_cast<std::int16_t>(energy);
        found.disparity[at] = static_cast<std::int16_t>(d);
      } else if (d - found.disparity[at] > 1) {
        found.rival[at] = static_cast<std::int16_t>(std::min<int>(found.rival[at], energy));
      }
      earlier = std::min(earlier, last_energy);
      last_energy = energy;
      last = d;
    }
    if (found.energy[at] == kNoEnergy) return;
    const int best = found.disparity[at];
    found.cost[at] = cost(best);
    if (best > 0) found.cost_below[at] = cost(best - 1);
    if (best < largest_[i]) found.cost_above[at] = cost(best + 1);
  }

#else

  using Signed = hn::ScalableTag<std::int16_t>;

  Expected find_expected(int first, std::size_t count) const {
    const Signed d16;
    const auto codes = hn::LoadU(d16, prior_.expected + first);
    const auto expected = hn::ShiftRight<1>(codes);
    const auto textured8 = hn::LoadU(hn::Rebind<std::uint8_t, Signed>(), prior_.textured + first);
    const auto textured = hn::Ne(hn::PromoteTo(d16, textured8), hn::Zero(d16));
    const auto inside = hn::Lt(hn::Iota(d16, 0), hn::Set(d16, static_cast<std::int16_t>(count)));
    const auto matchable = hn::And(inside, textured);
    const auto known = hn::And(matchable, hn::Ne(codes, hn::Set(d16, ExpectedDisparity::kNoPlane)));
    if (hn::AllFalse(d16, prior_.outside ? matchable : known)) return {};
    const auto none = hn::Set(d16, ExpectedDisparity::kNone);
    const auto most = hn::Set(d16, std::numeric_limits<std::int16_t>::max());
    const auto least = hn::GetLane(hn::MinOfLanes(d16, hn::IfThenElse(known, expected, most)));
    const auto greatest = hn::GetLane(hn::MaxOfLanes(d16, hn::IfThenElse(known, expected, none)));
    return {true, least, greatest};
  }

  /// Consecutive pixels as lanes in pack_sums' order: the inverse of store_in_order.
  static hn::Vec<Signed> to_lanes(hn::Vec<Signed> pixels) {
    const Signed d16;
    for (std::size_t blocks = descriptors_per_vector(); blocks > 1; blocks /= 2) {
      pixels = hn::ConcatUpperLower(d16, hn::ConcatOdd(d16, pixels, pixels), hn::ConcatEven(d16, pixels, pixels));
    }
    return pixels;
  }

  void prepare(int first, std::size_t count) {
    const Signed d16;
    const auto set = [&](int value) { return hn::Set(d16, static_cast<std::int16_t>(value)); };
    const auto lane_pixels = hn::Iota(d16, 0);
    const auto columns = hn::Add(set(first), lane_pixels);
    const auto rooms = direction_ < 0 ? columns : hn::Sub(set(width_ - 1), columns);
    const auto inside = hn::Lt(lane_pixels, set(static_cast<int>(count)));
    auto cells = hn::Zero(d16);
    for (std::size_t k = 1; k < cell_count_; ++k) {
      const int begin = cell_end_ + (static_cast<int>(k) - 1) * grid_.cell_px - first;
      cells = hn::IfThenElse(hn::Lt(lane_pixels, set(begin)), cells, set(static_cast<int>(k)));
    }
    const auto store = [&](auto pixels, auto& lanes) { hn::Store(to_lanes(pixels), d16, lanes.data()); };
    const auto codes = hn::LoadU(d16, prior_.expected + first);
    const auto expected = hn::ShiftRight<1>(codes);
    const auto is_reliable = hn::Ne(hn::And(codes, set(1)), hn::Zero(d16));
    store(expected, expected_);
    store(hn::IfThenElse(is_reliable, expected, set(ExpectedDisparity::kNone)), reliable_);
    store(hn::IfThenElse(inside, hn::Min(rooms, set(max_disparity_)), set(-1)), largest_);
    store(cells, cell_of_);
  }

  /// Matching costs of the pixels at one disparity.
  hn::Vec<Signed> compute_costs(int first, int d) const {
    const Bytes bytes;
    const std::size_t step = descriptors_per_vector();
    const std::uint8_t* here = row_[first].data();
    const std::uint8_t* there = other_row_[first + direction_ * d].data();
    EightSums sums;
    for (std::size_t j = 0; j < 8; ++j) {  // beyond the end of the row, too: there is padding, and what comes out is not used
      sums[j] = sum_differences(hn::LoadU(bytes, here + 16 * step * j), hn::LoadU(bytes, there + 16 * step * j));
    }
    return hn::BitCast(Signed(), pack_sums(sums));
  }

  /// The candidates of the pixels in a window, and those of them that are in the sets of all cells.
  struct Candidates {
    std::uint64_t of_any = 0;
    std::uint64_t of_all = 0;
  };

  Candidates collect(DisparityWindow window, int first, std::size_t count, const Expected& planes) {
    Candidates result{0, ~std::uint64_t{0}};
    for (std::size_t k = 0; k < cell_count_; ++k) {
      nearby_[k] = window.of_cell(grid_.words_of(*cells_[k]));
      result.of_any |= nearby_[k];
      result.of_all &= nearby_[k];
    }
    // One range for all of them, as what is a candidate of none is not allowed anywhere later; but not across edges.
    constexpr int kOneSurface = 8;  // px
    if (planes.greatest - planes.least <= kOneSurface) {
      result.of_any |= window.range(planes.least - radius_, planes.greatest + radius_);
    } else {
      for (int u = first; u < first + static_cast<int>(count); ++u) {
        const int expected = ExpectedDisparity::disparity(prior_.expected[u]);
        result.of_any |= window.range(expected - radius_, expected + radius_);
      }
    }
    result.of_any &= window.range(0, max_disparity_);
    return result;
  }

  /// Of the pixels those in whose cells a disparity is a candidate.
  hn::Mask<Signed> find_nearby(hn::Vec<Signed> cell_of, int i) const {
    const Signed d16;
    auto nearby = hn::Lt(cell_of, hn::Zero(d16));  // none: cells count from 0
    for (std::size_t k = 0; k < cell_count_; ++k) {
      if (contains(nearby_[k], i)) nearby = hn::Or(nearby, hn::Eq(cell_of, hn::Set(d16, static_cast<std::int16_t>(k))));
    }
    return nearby;
  }

  void search(int first, std::size_t count, const Expected& planes, const Range& range, RowSearch& found) {
    const Signed d16;
    const auto expected = hn::Load(d16, expected_.data());
    const auto reliable = hn::Load(d16, reliable_.data());
    const auto cell_of = hn::Load(d16, cell_of_.data());
    const auto zero = hn::Zero(d16);
    const auto one = hn::Set(d16, 1);
    const auto elsewhere = hn::Set(d16, penalty_.elsewhere);
    const auto too_large = hn::Add(hn::Load(d16, largest_.data()), one);
    const auto too_far = hn::Set(d16, static_cast<std::int16_t>(radius_ + 1));
    const auto none = hn::Set(d16, kNoEnergy);
    const int largest_of_all = count < lanes() ? -1 : std::min(room(first), room(first + static_cast<int>(count) - 1));

    // In one pass from small disparities to large ones; what lies 1 px beside the best is no rival.
    auto best = none;
    auto best_disparity = hn::Zero(d16);
    auto rival = none;
    auto below = hn::Zero(d16);
    auto at = hn::Zero(d16);
    auto above = hn::Zero(d16);
    auto previous_cost = hn::Zero(d16);
    auto last_energy = none;  // of the last candidate, `last`
    auto earlier = none;      // least of all candidates before that
    int last = -2;
    // A window's first and last disparity are looked at beside its candidates: windows overlap by two.
    for (DisparityWindow window{range.least - 1}; window.first < range.greatest; window.first += DisparityWindow::kSize - 2) {
      auto [candidates, of_all] = collect(window, first, count, planes);
      candidates &= window.range(window.first + 1, window.first + DisparityWindow::kSize - 2);
      const std::uint64_t allowed_everywhere = of_all & window.range(0, largest_of_all);
      std::uint64_t looked_at = (candidates | candidates << 1U | candidates >> 1U) & window.range(0, max_disparity_);
      for (; looked_at != 0; looked_at &= looked_at - 1) {
        const int i = std::countr_zero(looked_at);
        const int d = window.first + i;
        const auto disparity = hn::Set(d16, static_cast<std::int16_t>(d));
        const auto off_best = hn::Sub(disparity, best_disparity);
        const auto cost = compute_costs(first, d);
        above = hn::IfThenElse(hn::Eq(off_best, one), cost, above);
        if (contains(candidates, i)) {
          const auto off = hn::Abs(hn::Sub(disparity, reliable));
          auto penalty = elsewhere;
          auto x = zero;
          for (const std::int16_t near_plane : penalty_.near_plane) {
            penalty = hn::IfThenElse(hn::Eq(off, x), hn::Set(d16, near_plane), penalty);
            x = hn::Add(x, one);
          }
          static_assert(Penalty::kUnits == 4);
          auto energy = hn::Add(hn::ShiftLeft<2>(cost), penalty);
          if (!contains(allowed_everywhere, i)) {
            const auto near_plane = hn::Lt(hn::Abs(hn::Sub(disparity, expected)), too_far);
            const auto allowed = hn::And(hn::Lt(disparity, too_large), hn::Or(near_plane, find_nearby(cell_of, i)));
            energy = hn::IfThenElse(allowed, energy, none);
          }
          const auto less = hn::Lt(energy, best);
          const auto at_least_two_below = last == d - 1 ? earlier : hn::Min(earlier, last_energy);
          rival = hn::IfThenElse(hn::Gt(off_best, one), hn::Min(rival, energy), rival);
          rival = hn::IfThenElse(less, at_least_two_below, rival);
          best = hn::IfThenElse(less, energy, best);
          best_disparity = hn::IfThenElse(less, disparity, best_disparity);
          below = hn::IfThenElse(less, previous_cost, below);
          at = hn::IfThenElse(less, cost, at);
          earlier = hn::Min(earlier, last_energy);
          last_energy = energy;
          last = d;
        }
        previous_cost = cost;
      }
    }

    const auto store = [&](auto values, std::vector<std::int16_t>& row) {
      store_in_order(hn::BitCast(Shorts(), values), reinterpret_cast<std::uint16_t*>(row.data() + first));
    };
    store(best, found.energy);
    store(rival, found.rival);
    store(best_disparity, found.disparity);
    store(below, found.cost_below);
    store(at, found.cost);
    store(above, found.cost_above);
  }

#endif  // HWY_TARGET == HWY_SCALAR

  int direction_;
  int width_;
  const Descriptor* row_;
  const Descriptor* other_row_;
  const RowPrior& prior_;
  const CandidateGrid& grid_;
  const Penalty& penalty_;
  int radius_;
  int max_disparity_;
  const CandidateGrid::Cell* cell_;                                 ///< of the last pixel that was asked for,
  int cell_end_;                                                    ///< and where it ends
  std::array<const CandidateGrid::Cell*, kMostLanes + 1> cells_{};  ///< that the pixels lie in
  std::array<std::uint64_t, kMostLanes + 1> nearby_{};              ///< their sets in a window
  std::size_t cell_count_ = 0;
  HWY_ALIGN std::array<std::int16_t, kMostLanes> expected_{};
  HWY_ALIGN std::array<std::int16_t, kMostLanes> reliable_{};
  HWY_ALIGN std::array<std::int16_t, kMostLanes> largest_{};
  HWY_ALIGN std::array<std::int16_t, kMostLanes> cell_of_{};  ///< index in cells_
};

void search_pixels(View view, const Descriptor* row, const Descriptor* other_row, int v, const RowPrior& prior,
                   const CandidateGrid& grid, const Penalty& penalty, const ElasParams& params, RowSearch& found) {
  RowMatcher matcher(view, row, other_row, v, prior, grid, penalty, params);
  const int width = prior.width;
  const auto lanes = static_cast<int>(RowMatcher::lanes());
  const std::size_t size = static_cast<std::size_t>(width) + RowMatcher::lanes();
  found.energy.assign(size, kNoEnergy);
  found.rival.assign(size, kNoEnergy);
  for (auto* values : {&found.disparity, &found.cost_below, &found.cost, &found.cost_above}) values->resize(size);
  for (int u = 0; u < width; u += lanes) matcher.match(u, static_cast<std::size_t>(std::min(lanes, width - u)), found);
}

}  // namespace
}  // namespace brink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace brink {

HWY_EXPORT(search_pixels);

void search_row(View view, const Descriptor* row, const Descriptor* other_row, int v, const RowPrior& prior,
                const CandidateGrid& grid, const Penalty& penalty, const ElasParams& params, RowSearch& search) {
  HWY_DYNAMIC_DISPATCH(search_pixels)(view, row, other_row, v, prior, grid, penalty, params, search);
}

}  // namespace brink
#endif  // HWY_ONCE
