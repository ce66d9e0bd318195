#include "disparity/delaunay.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <tuple>
#include <utility>

namespace brink {
namespace {

/// An edge seen from one of its ends. Both ends have consecutive numbers, so that e ^ 1 is e seen from the other.
using End = int;
constexpr End kNoEnd = -1;

/// Both ends of the hull of a part: the counter-clockwise one that leaves its first point, and the clockwise one that leaves
/// its last.
struct Hull {
  End first = kNoEnd;
  End last = kNoEnd;
};

/// The divide-and-conquer triangulation of Guibas and Stolfi (1985, "Primitives for the manipulation of general subdivisions"),
/// section 9, over points in the order of row and column; their x is our v, their y our u. All in whole numbers, hence exact.
class Triangulation {
 public:
  /// @param order of the points by row and column.
  Triangulation(const std::vector<SupportPoint>& points, const std::vector<int>& order) : points_(points), order_(order) {
    const std::size_t ends = 6 * points.size();
    origins_.reserve(ends);
    next_.reserve(ends);
    previous_.reserve(ends);
    divide(0, static_cast<int>(order.size()));
  }

  [[nodiscard]] std::vector<Triangle> triangles() const {
    std::vector<Triangle> result;
    result.reserve(2 * points_.size());
    for (End a = 0; a < static_cast<End>(origins_.size()); ++a) {
      if (origins_[at(a)] < 0) continue;
      const End b = around_left(a);
      const End c = around_left(b);
      if (around_left(c) != a || b < a || c < a) continue;  // the outside; told already
      if (area(origin(a), origin(b), origin(c)) > 0) result.push_back({origin(a), origin(c), origin(b)});
    }
    return result;
  }

 private:
  static std::size_t at(End e) { return static_cast<std::size_t>(e); }
  static End turned(End e) { return e ^ 1; }
  [[nodiscard]] int origin(End e) const { return origins_[at(e)]; }
  [[nodiscard]] int target(End e) const { return origin(turned(e)); }
  [[nodiscard]] End next(End e) const { return next_[at(e)]; }          // counter-clockwise around the origin
  [[nodiscard]] End previous(End e) const { return previous_[at(e)]; }  // clockwise around it
  [[nodiscard]] End around_left(End e) const { return previous(turned(e)); }
  [[nodiscard]] const SupportPoint& point(int i) const { return points_[at(i)]; }

  /// Twice the area of a triangle, > 0 when it is counter-clockwise.
  [[nodiscard]] std::int64_t area(int a, int b, int c) const {
    const SupportPoint& p = point(a);
    return std::int64_t{point(b).v - p.v} * (point(c).u - p.u) - std::int64_t{point(b).u - p.u} * (point(c).v - p.v);
  }
  [[nodiscard]] bool is_right_of(int p, End e) const { return area(p, target(e), origin(e)) > 0; }
  [[nodiscard]] bool is_left_of(int p, End e) const { return area(p, origin(e), target(e)) > 0; }

  /// Whether p lies inside the circle through a, b, c, which are counter-clockwise.
  [[nodiscard]] bool is_in_circle(int a, int b, int c, int p) const {
    const auto lift = [&](int i) {
      const std::int64_t x = point(i).v - point(p).v;
      const std::int64_t y = point(i).u - point(p).u;
      return std::tuple(x, y, x * x + y * y);
    };
    const auto [ax, ay, al] = lift(a);
    const auto [bx, by, bl] = lift(b);
    const auto [cx, cy, cl] = lift(c);
    return al * (bx * cy - cx * by) - bl * (ax * cy - cx * ay) + cl * (ax * by - bx * ay) > 0;
  }

  End make_edge(int from, int to) {
    const auto e = static_cast<End>(origins_.size());
    for (const End end : {e, turned(e)}) {
      origins_.push_back(end == e ? from : to);
      next_.push_back(end);
      previous_.push_back(end);
    }
    return e;
  }

  /// Joins the rings of edges around two origins, or parts one.
  void splice(End a, End b) {
    const End after_a = next(a);
    const End after_b = next(b);
    next_[at(a)] = after_b;
    next_[at(b)] = after_a;
    previous_[at(after_b)] = a;
    previous_[at(after_a)] = b;
  }

  /// A new edge from the target of a to the origin of b, all three with the same face on their left.
  End connect(End a, End b) {
    const End e = make_edge(target(a), origin(b));
    splice(e, around_left(a));
    splice(turned(e), b);
    return e;
  }

  void remove(End e) {
    for (const End end : {e, turned(e)}) splice(end, previous(end));
    origins_[at(e)] = origins_[at(turned(e))] = -1;
  }

  /// Triangulates the points [begin, end) of the order, at least two.
  Hull divide(int begin, int end) {
    if (end - begin <= 3) return triangulate_few(begin, end);
    const int middle = begin + (end - begin) / 2;
    const Hull lower = divide(begin, middle);
    return merge(lower, divide(middle, end));
  }

  Hull triangulate_few(int begin, int end) {
    const int p = order_[at(begin)];
    const int q = order_[at(begin + 1)];
    const End a = make_edge(p, q);
    if (end - begin == 2) return {a, turned(a)};
    const int r = order_[at(begin + 2)];
    const End b = make_edge(q, r);
    splice(turned(a), b);
    const std::int64_t turn = area(p, q, r);
    if (turn == 0) return {a, turned(b)};
    const End c = connect(b, a);
    return turn > 0 ? Hull{a, turned(b)} : Hull{turned(c), c};
  }

  Hull merge(Hull low, Hull high) {
    // The edge that touches both parts from below: low.last and high.first walk along the hulls until none is in the way.
    End left = low.last;
    End right = high.first;
    while (true) {
      if (is_left_of(origin(right), left)) {
        left = around_left(left);
      } else if (is_right_of(origin(left), right)) {
        right = next(turned(right));
      } else {
        break;
      }
    }
    End base = connect(turned(right), left);
    if (origin(left) == origin(low.first)) low.first = turned(base);
    if (origin(right) == origin(high.last)) high.last = base;
    // It rises through the gap; the better of the two next points makes a triangle with it.
    while (true) {
      const auto is_above = [&](End e) { return is_right_of(target(e), base); };
      const auto is_better = [&](int p, int than) { return is_in_circle(target(base), origin(base), than, p); };
      left = next(turned(base));
      if (is_above(left)) {
        while (is_better(target(next(left)), target(left))) remove(std::exchange(left, next(left)));
      }
      right = previous(base);
      if (is_above(right)) {
        while (is_better(target(previous(right)), target(right))) remove(std::exchange(right, previous(right)));
      }
      if (!is_above(left) && !is_above(right)) break;
      const bool take_right =
          !is_above(left) || (is_above(right) && is_in_circle(target(left), origin(left), origin(right), target(right)));
      base = take_right ? connect(right, turned(base)) : connect(turned(base), turned(left));
    }
    return {low.first, high.last};
  }

  const std::vector<SupportPoint>& points_;
  const std::vector<int>& order_;
  std::vector<int> origins_;  ///< index of the point that an end belongs to; -1 = the edge was removed
  std::vector<End> next_;
  std::vector<End> previous_;
};

}  // namespace

std::vector<SupportPoint> move_to_right_view(const std::vector<SupportPoint>& points) {
  std::vector<SupportPoint> moved = points;
  for (SupportPoint& point : moved) point.u -= point.disparity;
  std::sort(moved.begin(), moved.end(), [](const SupportPoint& a, const SupportPoint& b) {
    return std::tuple(a.v, a.u, -a.disparity) < std::tuple(b.v, b.u, -b.disparity);
  });
  const auto same_pixel = [](const SupportPoint& a, const SupportPoint& b) { return a.u == b.u && a.v == b.v; };
  moved.erase(std::unique(moved.begin(), moved.end(), same_pixel), moved.end());
  return moved;
}

std::vector<Triangle> triangulate(const std::vector<SupportPoint>& points) {
  if (points.size() < 3) return {};
  std::vector<int> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int i, int j) {
    const SupportPoint& a = points[static_cast<std::size_t>(i)];
    const SupportPoint& b = points[static_cast<std::size_t>(j)];
    return std::pair(a.v, a.u) < std::pair(b.v, b.u);
  });
  return Triangulation(points, order).triangles();
}

}  // namespace brink
