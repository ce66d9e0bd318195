#pragma once

#include <vector>

#include <opencv2/imgproc.hpp>

#include "brink/evaluation.hpp"

// Truth and detections of a picture of 101x81 px in which instance k has a place of its own: 20x20 = 400 px from column 25 (k -
// 1).
namespace brink::test {

inline constexpr double kRate = 15.0;  // frames per second

inline cv::Rect place_of(int id) { return {25 * (id - 1), 0, 20, 20}; }

inline VisibleInstance make_instance(int id, double distance_m, int visible_px = 400, double depth_m = 1.0) {
  VisibleInstance instance;
  instance.id = id;
  instance.visible_px = visible_px;
  instance.depth_m = depth_m;
  instance.distance_m = distance_m;
  instance.bearing_deg = 0.0;
  return instance;
}

inline FrameTruth make_truth(int frame, const std::vector<VisibleInstance>& instances, double rate = kRate) {
  FrameTruth truth;
  truth.frame = frame;
  truth.time = frame / rate;
  truth.negative = cv::Mat1b(81, 101, uchar{0});
  for (const VisibleInstance& instance : instances) truth.negative(place_of(instance.id)).setTo(instance.id);
  truth.instances = instances;
  return truth;
}

inline FrameTruth at(FrameTruth truth, const Eigen::Vector3d& position) {
  truth.world_from_camera = Eigen::Isometry3d(Eigen::Translation3d(position));
  return truth;
}

inline std::vector<cv::Point> contour_of(const cv::Rect& area) {
  return {area.tl(), {area.br().x - 1, area.y}, area.br() - cv::Point(1, 1), {area.x, area.br().y - 1}};
}

inline NegativeObstacle make_obstacle(const cv::Rect& area, double distance_m, int id = 1) {
  NegativeObstacle obstacle;
  obstacle.id = id;
  obstacle.candidate.contour = contour_of(area);
  obstacle.candidate.distance_m = distance_m;
  obstacle.candidate.rim_nearest = {0.0, 1.0, distance_m};
  return obstacle;
}

/// A detection of exactly one instance.
inline NegativeObstacle on(int instance, double distance_m = 2.0) { return make_obstacle(place_of(instance), distance_m); }

/// A detection where there is nothing, with its place on the ground in the camera's frame.
inline NegativeObstacle off(const Eigen::Vector3d& rim_nearest = {0.0, 1.0, 2.0}, int id = 9) {
  NegativeObstacle obstacle = make_obstacle({40, 50, 10, 10}, 2.0, id);
  obstacle.candidate.rim_nearest = rim_nearest;
  return obstacle;
}

inline Detection make_detection(int frame, const std::vector<NegativeObstacle>& obstacles) {
  Detection detection;
  detection.frame = frame;
  detection.ground.state = GroundState::seen;
  detection.obstacles = obstacles;
  return detection;
}

inline bool operator==(const Counts& a, const Counts& b) { return a.tp == b.tp && a.fn == b.fn && a.fp == b.fp; }

}  // namespace brink::test
