#include "candidates/masks.hpp"

#include <algorithm>

#include <tbb/parallel_for.h>

#include "candidates/below_ground_simd.hpp"
#include "candidates/depth_wanted.hpp"

namespace brink {
namespace {

/// Whether the ray of a pixel meets the ground within max_range_m. On the ray r, |r| h / (down . r) is the distance from the
/// camera, so distance^2 in the plane = h^2 (|r|^2 / (down . r)^2 - 1).
class Range {
 public:
  Range(const GroundPose& pose, const StereoCamera& camera, double max_range_m)
      : pose_(pose),
        camera_(camera),
        height2_(pose.height_m * pose.height_m),
        reach2_(max_range_m * max_range_m + pose.height_m * pose.height_m) {}

  [[nodiscard]] bool contains(int u, int v) const {
    const double x = (u - camera_.cx) / camera_.focal;
    const double y = (v - camera_.cy) / camera_.focal;
    const double descent = pose_.down.x() * x + pose_.down.y() * y + pose_.down.z();
    return descent > 0.0 && height2_ * (x * x + y * y + 1.0) <= reach2_ * descent * descent;
  }

 private:
  GroundPose pose_;
  StereoCamera camera_;
  double height2_;
  double reach2_;
};

}  // namespace

// Few pixels are low, so that only these are asked for their range.
BelowGroundMasks find_below_ground(const cv::Mat1f& disparity, const cv::Mat1f& elevation, const GroundSurface& ground,
                                   const StereoCamera& camera, const CandidateParams& params) {
  const Range range(ground.pose, camera, params.max_range_m);
  const BelowGroundLimits limits{.least_disparity = kLeastDisparity,
                                 .noise_px_m = static_cast<float>(noise_depth_wanted(ground, params)),
                                 .measured_m = static_cast<float>(measured_depth_wanted(params)),
                                 .rim_ratio = static_cast<float>(params.rim_depth_ratio),
                                 .tolerance_m = static_cast<float>(params.ground_tolerance_m)};
  BelowGroundMasks masks(disparity.size());
  tbb::parallel_for(0, disparity.rows, [&](int v) {
    const BelowGroundRow row{masks.none[v], masks.deep[v], masks.low[v], masks.level[v]};
    sort_below_ground_row(disparity[v], elevation[v], disparity.cols, limits, row);
    for (int u = 0; u < disparity.cols; ++u) {
      if (row.low[u] != 0 && !range.contains(u, v)) row.low[u] = row.deep[u] = 0;
    }
  });
  return masks;
}

cv::Mat1b find_no_disparity(const cv::Mat1b& none, const GroundSurface& ground, const StereoCamera& camera,
                            const CandidateParams& params) {
  const Range range(ground.pose, camera, params.max_range_m);
  const int border_px = params.border_px;
  cv::Mat1b mask(none.size(), uchar{0});
  tbb::parallel_for(border_px, std::max(border_px, none.rows - border_px), [&](int v) {
    const uchar* const from = none[v];
    uchar* const to = mask[v];
    for (int u = border_px; u < none.cols - border_px; ++u) {
      if (from[u] != 0 && u - ground.plane.disparity(u, v) >= border_px && range.contains(u, v)) to[u] = 255;
    }
  });
  return mask;
}

}  // namespace brink
