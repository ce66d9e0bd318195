#include "disparity/expected_disparities_simd.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "disparity/expected_disparities_simd.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace brink::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// A side of a triangle. How far a pixel lies inside of it, in an arbitrary unit; negative outside.
class Side {
 public:
  Side(const SupportPoint& from, const SupportPoint& to) : from_(from), run_(to.u - from.u), rise_(to.v - from.v) {}
  [[nodiscard]] int at(int u, int v) const { return run_ * (v - from_.v) - rise_ * (u - from_.u); }
  [[nodiscard]] int per_column() const { return -rise_; }
  [[nodiscard]] int per_row() const { return run_; }

  /// Leaves of the rows those in which a pixel of columns [begin, last] can lie inside of this side.
  void limit(int begin, int last, cv::Range& rows) const {
    const int least = rise_ * ((rise_ > 0 ? begin : last) - from_.u);  // run (v - from.v) must be this or more
    if (run_ > 0) rows.start = std::max(rows.start, from_.v + divide_up(least, run_));
    if (run_ < 0) rows.end = std::min(rows.end, from_.v - divide_up(least, -run_) + 1);
  }

 private:
  /// ceil(a / b), b > 0.
  static int divide_up(int a, int b) { return a > 0 ? (a + b - 1) / b : -(-a / b); }

  SupportPoint from_;
  int run_;
  int rise_;
};

// Most triangles are a few pixels wide: longer vectors would be empty.
using Floats = hn::CappedTag<float, 8>;
using Ints = hn::Rebind<std::int32_t, Floats>;
using Codes = hn::Rebind<std::int16_t, Floats>;

/// Of the pixels of a triangle's rows that lie in columns [u, u + lanes).
void paint_columns(const std::array<Side, 3>& sides, const PriorPlane& plane, int u, const cv::Range& rows,
                   cv::Mat1s& expected) {
  const Floats floats;
  const Ints ints;
  const Codes codes;
  const auto inside = [&](const Side& side) {
    return hn::Add(hn::Set(ints, side.at(u, rows.start)), hn::Mul(hn::Set(ints, side.per_column()), hn::Iota(ints, 0)));
  };
  auto inside0 = inside(sides[0]);
  auto inside1 = inside(sides[1]);
  auto inside2 = inside(sides[2]);
  const auto down0 = hn::Set(ints, sides[0].per_row());
  const auto down1 = hn::Set(ints, sides[1].per_row());
  const auto down2 = hn::Set(ints, sides[2].per_row());
  constexpr float kFar = PriorPlane::kFar;
  const auto least = hn::Set(floats, -kFar);
  const auto most = hn::Set(floats, kFar);
  const auto shift = hn::Set(floats, kFar + 0.5F);
  const auto twice_far = hn::Set(ints, 2 * static_cast<std::int32_t>(kFar) - (plane.reliable ? 1 : 0));
  const auto along_u = hn::Mul(hn::Set(floats, plane.a), hn::Iota(floats, static_cast<float>(u)));
  const auto offset = hn::Set(floats, plane.c);
  const auto zero = hn::Zero(ints);
  std::int16_t* row = expected[rows.start] + u;
  for (int v = rows.start; v < rows.end; ++v) {
    // PriorPlane::whole_disparity
    const auto disparity = hn::Add(hn::Add(along_u, hn::Set(floats, plane.b * static_cast<float>(v))), offset);
    const auto limited = hn::Min(hn::Max(disparity, least), most);
    const auto whole = hn::ConvertTo(ints, hn::Add(limited, shift));
    const auto code = hn::Sub(hn::ShiftLeft<1>(whole), twice_far);
    const auto outside = hn::Lt(hn::Min(hn::Min(inside0, inside1), inside2), zero);
    const auto before = hn::PromoteTo(ints, hn::LoadU(codes, row));
    hn::StoreU(hn::DemoteTo(codes, hn::IfThenElse(outside, before, code)), codes, row);
    row += expected.step1();
    inside0 = hn::Add(inside0, down0);
    inside1 = hn::Add(inside1, down1);
    inside2 = hn::Add(inside2, down2);
  }
}

void paint_triangle(const std::array<SupportPoint, 3>& corners, const PriorPlane& plane, cv::Mat1s& expected) {
  const auto& [p, q, r] = corners;
  const std::array<Side, 3> sides = {Side(p, q), Side(q, r), Side(r, p)};
  const cv::Range rows(std::max(std::min({p.v, q.v, r.v}), 0), std::min(std::max({p.v, q.v, r.v}) + 1, expected.rows));
  const int end = std::min(std::max({p.u, q.u, r.u}) + 1, expected.cols);
  const auto lanes = static_cast<int>(hn::Lanes(Floats()));
  for (int u = std::max(std::min({p.u, q.u, r.u}), 0); u < end; u += lanes) {
    cv::Range reached = rows;
    for (const Side& side : sides) side.limit(u, u + lanes - 1, reached);
    if (reached.start < reached.end) paint_columns(sides, plane, u, reached, expected);
  }
}

void paint_triangles(const std::vector<SupportPoint>& points, const std::vector<Triangle>& triangles,
                     const std::vector<PriorPlane>& planes, cv::Mat1s& expected) {
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto corner = [&](std::size_t k) { return points[static_cast<std::size_t>(triangles[i][k])]; };
    paint_triangle({corner(0), corner(1), corner(2)}, planes[i], expected);
  }
}

}  // namespace
}  // namespace brink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace brink {

HWY_EXPORT(paint_triangles);

cv::Mat1s expect_disparities(const std::vector<SupportPoint>& points, const std::vector<Triangle>& triangles,
                             const std::vector<PriorPlane>& planes, cv::Size size, const cv::Mat1s& memory) {
  cv::Mat1s expected = make_padded_rows(size, memory);
  for (int v = 0; v < size.height; ++v) std::fill_n(expected[v], size.width, ExpectedDisparity::kNoPlane);
  HWY_DYNAMIC_DISPATCH(paint_triangles)(points, triangles, planes, expected);
  return expected;
}

}  // namespace brink
#endif  // HWY_ONCE
