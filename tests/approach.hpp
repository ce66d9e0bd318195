#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "brink/detector.hpp"
#include "floor_profile.hpp"

namespace brink::test {

/// What a detector says on a straight way to an edge, from disparities with noise and known poses.
struct ApproachResult {
  int frames = 0;                     ///< from the third one on, with the edge within 4 m and within the view before
  int reported = 0;                   ///< of these, with a distance that is off by at most 0.15 m
  int silent = 0;                     ///< of these, with a ground `seen` and no obstacle
  double nearest_reported_m = 1e9;    ///< smallest true distance up to which every frame was reported
  double worst_height_error_m = 0.0;  ///< where there is a ground
};

/// Walks from 3 m before an edge to 0.3 m before it.
inline ApproachResult approach_edge(double depth_m, const Stand& first, const StereoCamera& camera, const cv::Size& size,
                                    double step_m = 0.1, double noise_px = 0.1) {
  constexpr double kEdge = 3.0;      // m
  constexpr double kNearest = 0.3;   // m
  constexpr double kAllowed = 0.15;  // m
  constexpr double kFps = 10.0;
  Detector detector;
  ApproachResult result;
  bool held = true;
  int index = 0;
  for (const Stand& stand : make_approach(0.0, kEdge - kNearest, step_m, first)) {
    const cv::Mat1f disparity =
        make_disparity({{0.0, 0.0}, {kEdge, depth_m}}, stand, camera, size, noise_px, 1U + static_cast<unsigned>(index));
    Frame frame = make_frame_with_disparity({}, disparity, camera, index, index / kFps);
    frame.world_from_camera = stand.world_from_camera();
    const Detection detection = detector.process(frame);
    const double distance_m = kEdge - stand.along_m;
    if (detection.ground.plane) {
      result.worst_height_error_m =
          std::max(result.worst_height_error_m, std::abs(detection.ground.pose.height_m - stand.height_m));
    }
    if (index++ < 3) continue;
    ++result.frames;
    bool reported = false;
    for (const NegativeObstacle& obstacle : detection.obstacles) {
      reported = reported || std::abs(obstacle.candidate.distance_m - distance_m) <= kAllowed;
    }
    held = held && reported;
    result.reported += reported ? 1 : 0;
    if (held) result.nearest_reported_m = distance_m;
    if (detection.obstacles.empty() && detection.ground.state == GroundState::seen) ++result.silent;
  }
  return result;
}

}  // namespace brink::test
