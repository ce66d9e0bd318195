#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "brink/evaluation_report.hpp"
#include "evaluation/frame_overlaps.hpp"

namespace brink {
namespace {

bool overlaps(const NegativeObstacle& obstacle, const cv::Mat1b& mask) {
  return cv::countNonZero(fill_contour(obstacle.candidate.contour, mask.size()) & mask) > 0;
}

// Regions have a contour when they come from the detector, and at least their area's middle when they were read from a file.
bool overlaps(const Candidate& region, const cv::Mat1b& mask, const StereoCamera& camera) {
  if (!region.contour.empty()) return cv::countNonZero(fill_contour(region.contour, mask.size()) & mask) > 0;
  if (region.centroid.z() <= 0.0) return false;
  const Eigen::Vector3d pixel = camera.project(region.centroid);
  const cv::Point at(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
  return cv::Rect({0, 0}, mask.size()).contains(at) && mask(at) != 0;
}

}  // namespace

std::string explain_miss(const FrameTruth& truth, const Detection& detection, int id, const StereoCamera& camera) {
  if (detection.status != FrameStatus::ok) return to_string(detection.status);
  if (detection.ground.state == GroundState::not_visible) return "ground not_visible";
  const cv::Mat1b instance(truth.negative == id);
  const cv::Mat1b mask = widen(instance, EvaluationParams{}.dilation_px);
  const auto on_it = [&mask](const NegativeObstacle& obstacle) { return overlaps(obstacle, mask); };
  if (std::any_of(detection.obstacles.begin(), detection.obstacles.end(), on_it)) return "overlap too small";
  if (std::any_of(detection.tracks.begin(), detection.tracks.end(), on_it)) return "tracked, not reported";
  // Of several regions the largest is what became of the obstacle.
  const Candidate* region = nullptr;
  for (const Candidate& one : detection.rejected) {
    if (overlaps(one, mask, camera) && (region == nullptr || one.area_px > region->area_px)) region = &one;
  }
  if (region != nullptr && region->rejection) {
    return fmt::format("rejected: {} ({})", region->rejection->rule, to_string(region->type));
  }
  return detection.ground.state == GroundState::uncertain ? "no region, ground uncertain" : "no region";
}

std::string explain_false_alarm(const cv::Mat1f& disparity, const NegativeObstacle& obstacle, const GroundPlane& ground,
                                const StereoCamera& camera) {
  constexpr double kLevel = 0.10;  // m: what counts as ground, as T_g
  std::string type = to_string(obstacle.candidate.type);
  if (disparity.empty()) return type;
  const cv::Mat1b region = fill_contour(obstacle.candidate.contour, disparity.size());
  const cv::Mat1f elevation = compute_elevation(disparity, ground, camera);
  std::array<int, 3> pixels{};  // above, level, below
  for (int v = 0; v < region.rows; ++v) {
    for (int u = 0; u < region.cols; ++u) {
      const float height = elevation(v, u);
      if (region(v, u) == 0 || std::isnan(height)) continue;
      ++pixels[height > kLevel ? 0 : height < -kLevel ? 2 : 1];
    }
  }
  const std::array<const char*, 3> names{"something that stands on the ground", "ground", "a surface below the ground"};
  const auto most = std::max_element(pixels.begin(), pixels.end()) - pixels.begin();
  return fmt::format("{} on {}", type, names[static_cast<std::size_t>(most)]);
}

}  // namespace brink
