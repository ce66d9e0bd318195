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

#include "simd/sums_of_differences-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace brink::HWY_NAMESPACE {
namespace {

constexpr std::size_t kMostLanes = std::max(HWY_MAX_BYTES / 2, 8);
constexpr std::int16_t kNoEnergy = RowSearch::kNoEnergy;

namespace hn = hwy::HWY_NAMESPACE;

/// Sets of disparities: bit d of the words.
using Bits = std::vector<std::uint64_t>;

void insert(Bits& bits, int first, int last) {
  for (int d = first; d <= last; ++d)
    bits[static_cast<std::size_t>(d) / 64] |= std::uint64_t{1} << static_cast<unsigned>(d % 64);
}

bool contains(const std::uint64_t* bits, int d) { return ((bits[d / 64] >> static_cast<unsigned>(d % 64)) & 1U) != 0; }

/// With the disparities on both sides of each.
void widen(const Bits& bits, int largest, Bits& wide) {
  for (std::size_t k = 0; k < bits.size(); ++k) {
    wide[k] = bits[k] | bits[k] << 1U | bits[k] >> 1U;
    if (k > 0) wide[k] |= bits[k - 1] >> 63U;
    if (k + 1 < bits.size()) wide[k] |= bits[k + 1] << 63U;
  }
  const auto left_over = static_cast<unsigned>(largest % 64 + 1);
  if (left_over < 64) wide.back() &= (std::uint64_t{1} << left_over) - 1;
}

template <typename Visit>
void for_each(const Bits& bits, const Visit& visit) {
  for (std::size_t k = 0; k < bits.size(); ++k) {
    for (std::uint64_t word = bits[k]; word != 0; word &= word - 1) visit(static_cast<int>(64 * k) + std::countr_zero(word));
  }
}

/// Matches the pixels of a row, a vector's worth at a time.
class RowMatcher {
 public:
  RowMatcher(View view, const DescriptorImage& image, const DescriptorImage& other, int v, const RowPrior& prior,
             const CandidateGrid& grid, const Penalty& penalty, const ElasParams& params, RowSearch& scratch)
      : direction_(view == View::left ? -1 : 1),
        width_(image.width()),
        image_(image.row(v)),
        other_(other.row(v)),
        v_(v),
        prior_(prior),
        grid_(grid),
        penalty_(penalty),
        radius_(static_cast<int>(penalty.near_plane.size()) - 1),
        max_disparity_(params.max_disparity),
        candidates_(scratch.candidates),
        looked_at_(scratch.looked_at),
        cells_(scratch.cells) {
    candidates_.resize(static_cast<std::size_t>(max_disparity_) / 64 + 1);
    looked_at_.resize(candidates_.size());
  }

  /// Pixels that are matched together.
  static std::size_t lanes() {
#if HWY_TARGET == HWY_SCALAR
    return 8;
#else
    return hn::Lanes(Shorts());
#endif
  }

  /// @param count at most lanes().
  void match(int first, std::size_t count, RowSearch& found) {
    if (!collect(first, count)) return;
    prepare(first, count);
    search(first, found);
  }

 private:
  /// Unites the candidates of the pixels. @return whether there are any.
  bool collect(int first, std::size_t count) {
    const int end = first + static_cast<int>(count);
    std::fill(candidates_.begin(), candidates_.end(), 0);
    cells_.clear();
    for (int u = first; u < end; u = (u / grid_.cell_px + 1) * grid_.cell_px) {
      cells_.push_back(grid_.at(u, v_));
      for (std::size_t k = 0; k < candidates_.size(); ++k) candidates_[k] |= cells_.back()[k];
    }
    const Expected planes = find_expected(first, count);
    if (!planes.any_wanted) return false;
    // One range for all of them, as what is a candidate of none is not allowed anywhere later; but not across edges.
    constexpr int kOneSurface = 8;  // px
    if (planes.least <= planes.greatest && planes.greatest - planes.least <= kOneSurface) {
      insert_around(planes.least, planes.greatest);
    } else {
      for (int u = first; u < end; ++u) insert_around(ExpectedDisparity::disparity(prior_.expected[u]));
    }
    widen(candidates_, max_disparity_, looked_at_);
    return true;
  }

  /// @param least, greatest of expected disparities; ExpectedDisparity::kNone, which is far below 0, inserts nothing.
  void insert_around(int least, int greatest) {
    insert(candidates_, std::max(least - radius_, 0), std::min(greatest + radius_, max_disparity_));
  }
  void insert_around(int expected) { insert_around(expected, expected); }

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
      largest_[i] = static_cast<std::int16_t>(std::min(max_disparity_, direction_ < 0 ? u : width_ - 1 - u));
    }
  }

  void search(int first, RowSearch& found) {
    for (std::size_t i = 0; i < lanes(); ++i) {
      const int u = first + static_cast<int>(i);
      if (u < width_ && prior_.is_wanted(u)) search_pixel(u, i, found);
    }
  }

  void search_pixel(int u, std::size_t i, RowSearch& found) {
    const std::uint64_t* const nearby = grid_.at(u, v_);
    const auto cost = [&](int d) { return static_cast<std::int16_t>(compute_cost(image_[u], other_[u + direction_ * d])); };
    const auto at = static_cast<std::size_t>(u);
    int earlier = kNoEnergy;
    int last_energy = kNoEnergy;
    int last = -2;
    for_each(candidates_, [&](int d) {
      if (d > largest_[i] || !(contains(nearby, d) || std::abs(d - expected_[i]) <= radius_)) return;
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
    });
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
    const auto room = direction_ < 0 ? columns : hn::Sub(set(width_ - 1), columns);
    const auto inside = hn::Lt(lane_pixels, set(static_cast<int>(count)));
    auto cells = hn::Zero(d16);
    for (std::size_t k = 1; k < cells_.size(); ++k) {
      const int begin = (first / grid_.cell_px + static_cast<int>(k)) * grid_.cell_px - first;
      cells = hn::IfThenElse(hn::Lt(lane_pixels, set(begin)), cells, set(static_cast<int>(k)));
    }
    const auto store = [&](auto pixels, auto& lanes) { hn::Store(to_lanes(pixels), d16, lanes.data()); };
    const auto codes = hn::LoadU(d16, prior_.expected + first);
    const auto expected = hn::ShiftRight<1>(codes);
    const auto is_reliable = hn::Ne(hn::And(codes, set(1)), hn::Zero(d16));
    store(expected, expected_);
    store(hn::IfThenElse(is_reliable, expected, set(ExpectedDisparity::kNone)), reliable_);
    store(hn::IfThenElse(inside, hn::Min(room, set(max_disparity_)), set(-1)), largest_);
    store(cells, cell_of_);
  }

  /// Matching costs of the pixels at one disparity.
  hn::Vec<Signed> compute_costs(int first, int d) const {
    const Bytes bytes;
    const std::size_t step = descriptors_per_vector();
    const std::uint8_t* here = image_[first].data();
    const std::uint8_t* there = other_[first + direction_ * d].data();
    EightSums sums;
    for (std::size_t j = 0; j < 8; ++j) {  // beyond the end of the row, too: there is padding, and what comes out is not used
      sums[j] = sum_differences(hn::LoadU(bytes, here + 16 * step * j), hn::LoadU(bytes, there + 16 * step * j));
    }
    return hn::BitCast(Signed(), pack_sums(sums));
  }

  /// Of the pixels those in whose cells a disparity is a candidate.
  hn::Mask<Signed> find_nearby(hn::Vec<Signed> cell_of, int d) const {
    const Signed d16;
    auto nearby = hn::Lt(cell_of, hn::Zero(d16));  // none: cells count from 0
    for (std::size_t k = 0; k < cells_.size(); ++k) {
      if (contains(cells_[k], d)) nearby = hn::Or(nearby, hn::Eq(cell_of, hn::Set(d16, static_cast<std::int16_t>(k))));
    }
    return nearby;
  }

  void search(int first, RowSearch& found) {
    const Signed d16;
    const auto expected = hn::Load(d16, expected_.data());
    const auto reliable = hn::Load(d16, reliable_.data());
    const auto cell_of = hn::Load(d16, cell_of_.data());
    const auto one = hn::Set(d16, 1);
    const auto too_large = hn::Add(hn::Load(d16, largest_.data()), one);
    const auto too_far = hn::Set(d16, static_cast<std::int16_t>(radius_ + 1));
    const auto none = hn::Set(d16, kNoEnergy);

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
    for_each(looked_at_, [&](int d) {
      const auto disparity = hn::Set(d16, static_cast<std::int16_t>(d));
      const auto off_best = hn::Sub(disparity, best_disparity);
      const auto cost = compute_costs(first, d);
      above = hn::IfThenElse(hn::Eq(off_best, one), cost, above);
      if (contains(candidates_.data(), d)) {
        const auto off = hn::Abs(hn::Sub(disparity, reliable));
        auto penalty = hn::Set(d16, penalty_.elsewhere);
        for (std::size_t x = 0; x < penalty_.near_plane.size(); ++x) {
          const auto here = hn::Eq(off, hn::Set(d16, static_cast<std::int16_t>(x)));
          penalty = hn::IfThenElse(here, hn::Set(d16, penalty_.near_plane[x]), penalty);
        }
        static_assert(Penalty::kUnits == 4);
        auto allowed = hn::Lt(disparity, too_large);
        const auto near_plane = hn::Lt(hn::Abs(hn::Sub(disparity, expected)), too_far);
        allowed = hn::And(allowed, hn::Or(near_plane, find_nearby(cell_of, d)));
        const auto energy = hn::IfThenElse(allowed, hn::Add(hn::ShiftLeft<2>(cost), penalty), none);
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
    });

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
  const Descriptor* image_;
  const Descriptor* other_;
  int v_;
  const RowPrior& prior_;
  const CandidateGrid& grid_;
  const Penalty& penalty_;
  int radius_;
  int max_disparity_;
  Bits& candidates_;
  Bits& looked_at_;
  std::vector<const std::uint64_t*>& cells_;  ///< the words of the cells that the pixels lie in
  HWY_ALIGN std::array<std::int16_t, kMostLanes> expected_{};
  HWY_ALIGN std::array<std::int16_t, kMostLanes> reliable_{};
  HWY_ALIGN std::array<std::int16_t, kMostLanes> largest_{};
  HWY_ALIGN std::array<std::int16_t, kMostLanes> cell_of_{};  ///< index in cells_
};

void search_pixels(View view, const DescriptorImage& image, const DescriptorImage& other, int v, const RowPrior& prior,
                   const CandidateGrid& grid, const Penalty& penalty, const ElasParams& params, RowSearch& found) {
  RowMatcher matcher(view, image, other, v, prior, grid, penalty, params, found);
  const int width = image.width();
  const auto lanes = static_cast<int>(RowMatcher::lanes());
  const std::size_t size = static_cast<std::size_t>(width) + RowMatcher::lanes();
  found.energy.assign(size, kNoEnergy);
  found.rival.assign(size, kNoEnergy);
  for (auto* row : {&found.disparity, &found.cost_below, &found.cost, &found.cost_above}) row->resize(size);
  for (int u = 0; u < width; u += lanes) matcher.match(u, static_cast<std::size_t>(std::min(lanes, width - u)), found);
}

}  // namespace
}  // namespace brink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace brink {

HWY_EXPORT(search_pixels);

void search_row(View view, const DescriptorImage& image, const DescriptorImage& other, int v, const RowPrior& prior,
                const CandidateGrid& grid, const Penalty& penalty, const ElasParams& params, RowSearch& search) {
  HWY_DYNAMIC_DISPATCH(search_pixels)(view, image, other, v, prior, grid, penalty, params, search);
}

}  // namespace brink
#endif  // HWY_ONCE
