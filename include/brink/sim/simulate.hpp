#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "brink/camera.hpp"
#include "brink/imu.hpp"
#include "brink/sim/render.hpp"
#include "brink/sim/scene.hpp"

namespace brink::sim {

/// Height of the ground at (x, y), m; NaN where there is none. @param z height of the ground a little earlier on the path, m:
/// of several floors the one is meant that is reached from there.
using GroundHeight = std::function<double(double x, double y, double z)>;

/// Smooth head motion of a walk. Twice differentiable in time, so that an IMU can be derived from it.
///
/// The camera follows the path and the ground under it, both smoothed along the way, at even speed; it looks along the path
/// and down by Walk::pitch_deg. The gait adds bob, sway, roll, pitch and yaw; now and then the head turns to look around.
class HeadMotion {
 public:
  /// @param ground_height asked along the path in order; where it is NaN the ground goes on as it was.
  /// @throws std::invalid_argument "walk.name = value, must be ..." when the walk is not valid.
  HeadMotion(const Walk& walk, const GroundHeight& ground_height);

  /// @param time s; before 0 and after duration() the walk goes straight on.
  /// @return world_from_camera of the left camera.
  [[nodiscard]] Eigen::Isometry3d operator()(double time) const;

  /// Time at which the path ends, s.
  [[nodiscard]] double duration() const;

 private:
  /// A turn of the head from where it looked before, smooth from start to start + length.
  struct Look {
    double start = 0.0;     ///< s
    double length = 0.0;    ///< s
    Eigen::Vector2d angle;  ///< yaw to the right and pitch downwards at the end, rad
  };
  void plan_looks();
  [[nodiscard]] Eigen::Vector2d look(double time) const;  // yaw and pitch, rad

  Walk walk_;
  double length_ = 0.0;                 // m along the smoothed path
  std::vector<Eigen::Vector4d> track_;  // x, y, ground, heading (rad): control points of a cubic B-spline along the path
  std::vector<Look> looks_;
};

/// Noise of a typical MEMS sensor, as in phones. White noise plus a bias that wanders around zero: a first-order Gauss-Markov
/// process with the given standard deviation.
struct ImuParams {
  double rate_hz = 200.0;
  double gyro_noise_dps = 0.005;     ///< deg/s/sqrt(Hz)
  double gyro_bias_dps = 0.2;        ///< deg/s, standard deviation on each axis
  double accel_noise_mps2 = 981e-6;  ///< m/s^2/sqrt(Hz): 100 ug
  double accel_bias_mps2 = 0.02;     ///< m/s^2, standard deviation on each axis
  double bias_time_s = 100.0;        ///< time in which a bias forgets itself
  void validate() const;             ///< @throws std::invalid_argument "imu.name = value, must be ..."
};

/// What an IMU in the left camera reads, gravity being along -z of the world, from time 0 to duration_s, both included.
/// @throws std::invalid_argument when the parameters are not valid or the duration is negative.
std::vector<ImuSample> make_imu(const CameraMotion& world_from_camera, double duration_s, const ImuParams& params,
                                unsigned seed);

struct SimulationParams {
  std::string family;
  int seed = 1;
  int frames = 150;
  int width = 1280;
  int height = 720;
  double focal_px = 700.0;
  double baseline_m = 0.15;
  double fps = 15.0;
  std::string light;                ///< sunny, overcast, dusk; empty = by the seed
  double noise = 1.0;               ///< factor on the sensor's noise
  bool blur = false;                ///< motion blur
  double vertical_offset_px = 0.0;  ///< mis-rectification of the right picture
  double rotation_deg = 0.0;        ///< mis-rectification of the right picture, about its centre
  double dropped = 0.0;             ///< share of frames whose pictures are missing; not the first, not the last
  void validate() const;            ///< @throws std::invalid_argument "name = value, must be ..."
};

/// What the two eyes see, 8-bit BGR.
struct StereoPictures {
  cv::Mat3b left;
  cv::Mat3b right;
};

/// A virtual walk. Every frame is a function of the parameters and its number alone, so frames can be made in any order, and
/// a run that was interrupted goes on with the same bytes. The world of all results is the left camera of frame 0 (formats.md).
class Simulator {
 public:
  /// Builds the scene. @throws std::invalid_argument when the parameters are not valid.
  explicit Simulator(const SimulationParams& params);
  ~Simulator();
  Simulator(const Simulator&) = delete;
  Simulator& operator=(const Simulator&) = delete;

  [[nodiscard]] const SimulationParams& params() const;
  [[nodiscard]] StereoCamera camera() const;
  [[nodiscard]] double time(int frame) const;  ///< s
  [[nodiscard]] Eigen::Isometry3d world_from_camera(int frame) const;
  [[nodiscard]] bool is_dropped(int frame) const;
  [[nodiscard]] std::vector<Instance> instances() const;
  /// From frame 0 to the last one.
  [[nodiscard]] std::vector<ImuSample> imu() const;
  // The frame is 0 .. params().frames - 1.
  [[nodiscard]] StereoPictures pictures(int frame);
  [[nodiscard]] Truth truth(int frame);

 private:
  class Walker;
  std::unique_ptr<Walker> walker_;
};

}  // namespace brink::sim
