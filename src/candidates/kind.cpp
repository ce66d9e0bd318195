#include "candidates/kind.hpp"

#include <algorithm>

#include <opencv2/imgproc.hpp>

#include "candidates/floor.hpp"

namespace brink {
namespace {

constexpr std::size_t kFewestBorderPixels = 20;
constexpr double kClosedShare = 0.85;  // of the border: holes have 93 % and more, edges 79 % and less
constexpr double kRimShare = 0.4;      // of its depth that a rim may lie down, as regions are drawn out,
constexpr double kRimDepth = 0.06;     // m, but never more than this
constexpr double kEdgeLength = 2.0;    // m, at least
constexpr double kHoleLength = 3.0;    // m, at most, of deep ones: stairs may be hidden in longer openings
constexpr double kDeep = 0.45;         // m: three steps of 15 cm
// Shares of the cells of the floor
constexpr double kStairsShare = 0.10;
constexpr double kStairsOverLevel = 0.45;  // times the landing; a track bed is much larger than what seems to lead down to it
constexpr double kBottomShare = 0.40;      // one level below an edge

}  // namespace

std::optional<double> compute_ground_share(const Region& region, const cv::Mat1b& none, const cv::Mat1f& elevation, int gap_px,
                                           double lowest_m, double highest_m) {
  // Without what the region surrounds: specks inside are noise.
  Region filled = region;
  filled.mask = cv::Mat1b(region.mask.size(), uchar{0});
  const std::vector<std::vector<cv::Point>> outline{trace_contour(region.mask, region.box)};
  cv::drawContours(filled.mask, outline, -1, cv::Scalar(255), cv::FILLED, cv::LINE_8, cv::noArray(), 0, -region.box.tl());
  const std::vector<cv::Point> ring = ring_pixels(filled, none, gap_px);
  if (ring.size() < kFewestBorderPixels) return std::nullopt;
  // What is not known compares false.
  const auto is_ground = [&](const cv::Point& p) { return elevation(p) >= lowest_m && elevation(p) <= highest_m; };
  return static_cast<double>(std::ranges::count_if(ring, is_ground)) / static_cast<double>(ring.size());
}

double compute_opening_length_m(const std::vector<Eigen::Vector3d>& rim, const GroundPose& pose) {
  if (rim.empty()) return 0.0;
  std::vector<cv::Point2f> from_above;
  from_above.reserve(rim.size());
  for (const Eigen::Vector3d& point : rim) {
    from_above.emplace_back(static_cast<float>(pose.right.dot(point)), static_cast<float>(pose.forward.dot(point)));
  }
  const cv::RotatedRect around = cv::minAreaRect(from_above);
  return std::max(around.size.width, around.size.height);
}

ObstacleKind tell_kind(const Candidate& candidate, const Region& region, const cv::Mat1b& none, const cv::Mat1f& disparity,
                       const cv::Mat1f& elevation, const StereoCamera& camera, const GroundPose& pose,
                       const CandidateParams& params) {
  const double depth_m = candidate.depth_m.value_or(0.0);  // of Type 2 no floor is seen
  const bool is_deep = depth_m >= kDeep;
  Floor floor;
  if (is_deep) floor = measure_floor(region, disparity, elevation, camera, pose);
  if (floor.stairs_share >= std::max(kStairsShare, kStairsOverLevel * floor.level_share)) return ObstacleKind::stairs_down;

  const double lowest_m = -(candidate.depth_m ? std::min(kRimShare * depth_m, kRimDepth) : kRimDepth);
  const std::optional<double> ground_share =
      compute_ground_share(region, none, elevation, params.touching_gap_px, lowest_m, params.ground_tolerance_m);
  if (!ground_share) return ObstacleKind::unknown;
  const double length_m = compute_opening_length_m(candidate.rim, pose);
  if (*ground_share >= kClosedShare) return is_deep && length_m > kHoleLength ? ObstacleKind::unknown : ObstacleKind::hole;
  const bool has_bottom = candidate.depth_m && (!is_deep || floor.level_share >= kBottomShare);
  return has_bottom && length_m >= kEdgeLength ? ObstacleKind::edge : ObstacleKind::unknown;
}

}  // namespace brink
