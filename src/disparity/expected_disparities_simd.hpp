#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include <opencv2/core.hpp>

#include "disparity/delaunay.hpp"
#include "disparity/dense_matching.hpp"
#include "disparity/support_points.hpp"

namespace brink {

/// What the planes of the triangles expect of a pixel before it is matched, in one number: twice the disparity in whole px
/// (PriorPlane::whole_disparity), plus one where the plane is reliable.
struct ExpectedDisparity {
  static constexpr std::int16_t kNoPlane = std::numeric_limits<std::int16_t>::min();  ///< outside all triangles
  static constexpr std::int16_t kNone = kNoPlane / 2;                                 ///< its disparity, far below all others

  static std::int16_t encode(int disparity, bool reliable) {
    return static_cast<std::int16_t>(2 * disparity + (reliable ? 1 : 0));
  }
  static int disparity(std::int16_t code) { return code >> 1; }
  static bool is_reliable(std::int16_t code) { return (code & 1) != 0; }
};

/// The ExpectedDisparity of every pixel. One on an edge belongs to the later of the two triangles.
/// @param planes of the triangles. @param memory an earlier result, whose memory is used again.
/// @return of `size`; kRowPadding more pixels can be read behind every row.
/// Equals the plain twin in tests/reference/dense_matching.hpp for every target.
cv::Mat1s expect_disparities(const std::vector<SupportPoint>& points, const std::vector<Triangle>& triangles,
                             const std::vector<PriorPlane>& planes, cv::Size size, const cv::Mat1s& memory = {});

}  // namespace brink
