#include "candidates/far_rim.hpp"

#include <algorithm>
#include <optional>

namespace brink {
namespace {

constexpr double kTolerance = 0.1;  // m: rims are rounded, and drawn by a pixel too much
constexpr double kSigmas = 3.0;
constexpr int kGap = 8;  // px without a surface between a region and the ground above it

/// The lowest pixel of ground right above the topmost pixel of a region in a column; -1 = there is none.
int find_ground_above(const cv::Mat1b& ground, const cv::Mat1f& disparity, int u, int top) {
  for (int v = top - 1; v >= std::max(0, top - 1 - kGap); --v) {
    if (ground(v, u) != 0) return v;
    if (disparity(v, u) > 0.0F) return -1;
  }
  return -1;
}

}  // namespace

double compute_share_beyond_rim(const Region& region, const cv::Mat1b& ground, const cv::Mat1f& disparity,
                                const StereoCamera& camera, const GroundPose& pose, double disparity_sd_px) {
  int counted = 0;
  int beyond = 0;
  for (int column = 1; column < region.mask.cols - 1; ++column) {
    const int u = region.box.x + column;
    std::optional<double> far_rim_m;
    for (int row = 1; row < region.mask.rows - 1; ++row) {
      if (region.mask(row, column) == 0) continue;
      const int v = region.box.y + row;
      if (!far_rim_m) {
        const int above = find_ground_above(ground, disparity, u, v);
        if (above < 0) break;
        far_rim_m = pose.distance(camera.triangulate(u, above, disparity(above, u)));
      }
      const double d = disparity(v, u);
      const Eigen::Vector3d point = camera.triangulate(u, v, d);
      const double noise_m = kSigmas * point.z() * disparity_sd_px / d;
      ++counted;
      beyond += pose.distance(point) > *far_rim_m + kTolerance + noise_m ? 1 : 0;
    }
  }
  return 2 * counted < region.area_px ? 0.0 : static_cast<double>(beyond) / counted;
}

}  // namespace brink
