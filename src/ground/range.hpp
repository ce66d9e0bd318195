#pragma once

#include <algorithm>
#include <cmath>

#include "brink/camera.hpp"
#include "brink/ground.hpp"

namespace brink {

/// The whole numbers [begin, end).
struct Span {
  int begin = 0;
  int end = 0;
};

inline Span common(const Span& a, const Span& b) {
  const int begin = std::max(a.begin, b.begin);
  return {begin, std::max(begin, std::min(a.end, b.end))};
}

/// Those of [0, count) for which a test holds, when these lie side by side.
/// @param peak the test holds beside it when it holds neither at the first nor at the last one, but anywhere.
template <typename Test>
Span find_span(int count, double peak, const Test& test) {
  if (count <= 0) return {};
  const int last = count - 1;
  int inside = last;
  if (test(0)) {
    inside = 0;
  } else if (!test(last)) {
    const double place = std::clamp(peak, 0.0, static_cast<double>(last));
    inside = static_cast<int>(std::floor(place));
    if (!test(inside)) inside = std::min(inside + 1, last);
    if (!test(inside)) return {};
  }
  // The end of those alike, from one of them to one that differs: bisection.
  const auto find_edge = [&test](int like, int unlike) {
    while (std::abs(unlike - like) > 1) {
      const int middle = (like + unlike) / 2;
      (test(middle) ? like : unlike) = middle;
    }
    return like;
  };
  return {test(0) ? 0 : find_edge(inside, 0), (test(last) ? last : find_edge(inside, last)) + 1};
}

/// The pixels whose rays meet the ground within a distance in the ground plane. On the ray r, |r| h / (down . r) is the
/// distance from the camera, so distance^2 in the plane = h^2 (|r|^2 / (down . r)^2 - 1). These rays are a cone, and so the
/// pixels of a row lie side by side.
class GroundRange {
 public:
  GroundRange(const GroundPose& pose, const StereoCamera& camera, double max_range_m)
      : down_(pose.down),
        camera_(camera),
        height2_(pose.height_m * pose.height_m),
        reach2_(max_range_m * max_range_m + pose.height_m * pose.height_m) {}

  [[nodiscard]] bool contains(int u, int v) const {
    const double x = (u - camera_.cx) / camera_.focal;
    const double y = (v - camera_.cy) / camera_.focal;
    const double descent = down_.x() * x + down_.y() * y + down_.z();
    return descent > 0.0 && height2_ * (x * x + y * y + 1.0) <= reach2_ * descent * descent;
  }
  /// The columns of a row.
  [[nodiscard]] Span columns(int v, int width) const {
    return find_span(width, peak(v), [this, v](int u) { return contains(u, v); });
  }
  /// The column that lies deepest within the range, where the range ends on both sides; else any.
  [[nodiscard]] double peak(int v) const {
    const double row_descent = down_.y() * (v - camera_.cy) / camera_.focal + down_.z();
    const double bend = height2_ - reach2_ * down_.x() * down_.x();
    return bend > 0.0 ? camera_.cx + camera_.focal * reach2_ * down_.x() * row_descent / bend : 0.0;
  }

 private:
  Eigen::Vector3d down_;
  StereoCamera camera_;
  double height2_;
  double reach2_;
};

}  // namespace brink
