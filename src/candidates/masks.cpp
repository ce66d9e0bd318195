#include "candidates/masks.hpp"

#include <algorithm>

#include <tbb/parallel_for.h>

#include "candidates/below_ground_simd.hpp"
#include "candidates/depth_wanted.hpp"
#include "ground/range.hpp"

namespace brink {
BelowGroundMasks find_below_ground(const cv::Mat1f& disparity, const cv::Mat1f& elevation, const GroundSurface& ground,
                                   const StereoCamera& camera, const CandidateParams& params) {
  const GroundRange range(ground.pose, camera, params.max_range_m);
  const BelowGroundLimits limits{.least_disparity = kLeastDisparity,
                                 .noise_px_m = static_cast<float>(noise_depth_wanted(ground, params)),
                                 .measured_m = static_cast<float>(measured_depth_wanted(params)),
                                 .rim_ratio = static_cast<float>(params.rim_depth_ratio),
                                 .tolerance_m = static_cast<float>(params.ground_tolerance_m)};
  BelowGroundMasks masks(disparity.size());
  tbb::parallel_for(0, disparity.rows, [&](int v) {
    const BelowGroundRow row{masks.none[v], masks.deep[v], masks.low[v], masks.level[v]};
    sort_below_ground_row(disparity[v], elevation[v], disparity.cols, limits, row);
    const Span in_range = range.columns(v, disparity.cols);
    for (uchar* const mask : {row.low, row.deep}) {
      std::fill(mask, mask + in_range.begin, uchar{0});
      std::fill(mask + in_range.end, mask + disparity.cols, uchar{0});
    }
  });
  return masks;
}

cv::Mat1b find_no_disparity(const cv::Mat1b& none, const GroundSurface& ground, const StereoCamera& camera,
                            const CandidateParams& params) {
  const GroundRange range(ground.pose, camera, params.max_range_m);
  const int border_px = params.border_px;
  cv::Mat1b mask(none.size(), uchar{0});
  tbb::parallel_for(border_px, std::max(border_px, none.rows - border_px), [&](int v) {
    const auto is_in_right_picture = [&](int u) { return u - ground.plane.disparity(u, v) >= border_px; };
    const Span in_both = find_span(none.cols, 0.0, is_in_right_picture);
    const Span columns = common(common(in_both, range.columns(v, none.cols)), {border_px, none.cols - border_px});
    std::copy(none[v] + columns.begin, none[v] + columns.end, mask[v] + columns.begin);
  });
  return mask;
}

}  // namespace brink
