#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "brink/ego_motion.hpp"
#include "brink/frame.hpp"

namespace brink::test {

inline StereoCamera room_camera() { return {200.0, 159.5, 89.5, 0.15}; }
inline cv::Size room_size() { return {320, 180}; }

/// A textured square that moves on its own, facing along z: a passer-by.
struct PasserBy {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< m, world
  double half_width_m = 0.0;
  double half_height_m = 0.0;
};

/// Smooth grey of a place on a surface, 0..255: value noise of three cell sizes that the camera resolves.
inline double room_texture(double x, double y, unsigned surface) {
  const auto hash = [](int i, int j, unsigned seed) {
    unsigned h = static_cast<unsigned>(i) * 374761393U + static_cast<unsigned>(j) * 668265263U + seed * 2246822519U;
    h = (h ^ (h >> 13U)) * 1274126177U;
    return static_cast<double>((h ^ (h >> 16U)) & 0xFFFFU) / 65535.0;
  };
  const auto smooth = [](double t) { return t * t * (3.0 - 2.0 * t); };
  double value = 0.0;
  unsigned seed = 10 * surface;
  for (const double cell : {0.08, 0.2, 0.5}) {
    const int i = static_cast<int>(std::floor(x / cell));
    const int j = static_cast<int>(std::floor(y / cell));
    const double s = smooth(x / cell - i);
    const double t = smooth(y / cell - j);
    value += (1 - t) * ((1 - s) * hash(i, j, seed) + s * hash(i + 1, j, seed)) +
             t * ((1 - s) * hash(i, j + 1, seed) + s * hash(i + 1, j + 1, seed));
    ++seed;
  }
  return 10.0 + value / 3.0 * 235.0;
}

/// Where a ray meets the walls of a box of 6 x 3.1 x 10 m.
struct RoomHit {
  double length = std::numeric_limits<double>::infinity();  ///< in lengths of the ray
  int axis = 0;                                             ///< that the wall is square to
};
inline RoomHit hit_room(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) {
  const Eigen::Vector3d low(-3.0, -1.5, -2.0);
  const Eigen::Vector3d high(3.0, 1.6, 8.0);
  RoomHit hit;
  for (int i = 0; i < 3; ++i) {
    const double length = ((ray[i] > 0.0 ? high[i] : low[i]) - origin[i]) / ray[i];
    if (length < hit.length) hit = {length, i};
  }
  return hit;
}

/// Grey seen along a ray inside the room. Its walls are the surfaces 0 to 5, a passer-by is surface 6.
inline double trace_room(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray, const std::optional<PasserBy>& passer_by) {
  const auto [nearest, axis] = hit_room(origin, ray);
  if (passer_by) {
    const double length = (passer_by->centre.z() - origin.z()) / ray.z();
    const Eigen::Vector3d place = origin + length * ray - passer_by->centre;
    if (length > 0.0 && length < nearest && std::abs(place.x()) < passer_by->half_width_m &&
        std::abs(place.y()) < passer_by->half_height_m) {
      return room_texture(place.x(), place.y(), 6);
    }
  }
  const Eigen::Vector3d hit = origin + nearest * ray;
  const unsigned surface = 2U * static_cast<unsigned>(axis) + (ray[axis] > 0.0 ? 1U : 0U);
  return room_texture(hit[(axis + 1) % 3], hit[(axis + 2) % 3], surface);
}

/// What one eye sees: four rays a pixel, then noise of a standard deviation of 1.5 grey levels.
/// @param noise_seed another one for each picture, as a sensor's noise is. 0 = none.
inline cv::Mat1b render_eye(const StereoCamera& camera, const cv::Size& size, const Eigen::Isometry3d& world_from_camera,
                            int eye, unsigned noise_seed, const std::optional<PasserBy>& passer_by) {
  const Eigen::Vector3d origin = world_from_camera * Eigen::Vector3d(eye * camera.baseline, 0.0, 0.0);
  std::mt19937 random(noise_seed);
  std::normal_distribution<double> noise(0.0, 1.5);
  cv::Mat1b picture(size);
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      double grey = 0.0;
      for (const double du : {-0.25, 0.25}) {
        for (const double dv : {-0.25, 0.25}) {
          const Eigen::Vector3d ray((u + du - camera.cx) / camera.focal, (v + dv - camera.cy) / camera.focal, 1.0);
          grey += trace_room(origin, world_from_camera.linear() * ray, passer_by) / 4.0;
        }
      }
      picture(v, u) = cv::saturate_cast<uchar>(grey + (noise_seed > 0 ? noise(random) : 0.0));
    }
  }
  return picture;
}

/// Exact depths of the empty room, m.
inline cv::Mat1f render_room_depth(const Eigen::Isometry3d& world_from_camera) {
  const StereoCamera camera = room_camera();
  cv::Mat1f depth(room_size());
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) {
      const Eigen::Vector3d ray((u - camera.cx) / camera.focal, (v - camera.cy) / camera.focal, 1.0);  // its z is 1 m
      depth(v, u) = static_cast<float>(hit_room(world_from_camera.translation(), world_from_camera.linear() * ray).length);
    }
  }
  return depth;
}

/// A frame of the room. Its pose is world_from_camera; frames are 1/15 s apart.
inline Frame render_room(const Eigen::Isometry3d& world_from_camera, int index,
                         const std::optional<PasserBy>& passer_by = std::nullopt) {
  const auto seed = static_cast<unsigned>(2 * index + 1);
  return make_frame(render_eye(room_camera(), room_size(), world_from_camera, 0, seed, passer_by),
                    render_eye(room_camera(), room_size(), world_from_camera, 1, seed + 1, passer_by), room_camera(), index,
                    index / 15.0);
}

/// A pose by its place, m, and its turns to the right and down, degrees.
inline Eigen::Isometry3d make_pose(double x, double y, double z, double right_deg = 0.0, double down_deg = 0.0) {
  constexpr double kDegree = 3.14159265358979323846 / 180.0;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() << x, y, z;
  pose.linear() = (Eigen::AngleAxisd(right_deg * kDegree, Eigen::Vector3d::UnitY()) *
                   Eigen::AngleAxisd(-down_deg * kDegree, Eigen::Vector3d::UnitX()))
                      .toRotationMatrix();
  return pose;
}

inline double angle_deg(const Eigen::Matrix3d& rotation) {
  return Eigen::AngleAxisd(rotation).angle() * 180.0 / 3.14159265358979323846;
}

/// Squared error in its own standard deviations: 6 on average; above 60 once in 1e10, if the covariance is right.
inline double squared_error_in_sigmas(const EgoMotion& motion, const Eigen::Isometry3d& truth) {
  const Eigen::AngleAxisd turn(truth.linear() * motion.current_from_previous.linear().transpose());
  Eigen::Matrix<double, 6, 1> error;
  error << turn.angle() * turn.axis(), truth.translation() - motion.current_from_previous.translation();
  return error.dot(motion.covariance.inverse() * error);
}

}  // namespace brink::test
