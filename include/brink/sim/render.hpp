#pragma once

#include <functional>
#include <memory>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "brink/camera.hpp"
#include "brink/sim/scene.hpp"

namespace brink::sim {

/// The rendered truth of the left camera's pixel centres.
struct Truth {
  cv::Mat1f disparity;  ///< px; 0 where the ray meets nothing
  cv::Mat1b obstacle;   ///< id of the negative obstacle whose inside is seen, 0 = none
};

/// Pose of the left camera (x right, y down, z forward) in the world at a time, s.
using CameraMotion = std::function<Eigen::Isometry3d(double)>;

struct RenderParams {
  int samples = 4;         ///< rays per pixel and eye; with blur they spread over the shutter
  double shutter_s = 0.0;  ///< exposure time; 0 = no motion blur
  int sky_rays = 8;        ///< rays per quarter-resolution pixel for the sky's occlusion
  void validate() const;   ///< @throws std::invalid_argument "render.name = value, must be ..."
};

/// Traces rays through a scene (Embree). The result depends on the arguments only, not on the number of threads.
class Renderer {
 public:
  /// @throws std::invalid_argument when the scene is not valid.
  explicit Renderer(const Scene& scene);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// One eye's picture, linear BGR radiance, anti-aliased.
  /// @param time s; with blur the middle of the shutter.
  /// @param eye 0 left, 1 right: baseline metres along the camera's x axis. @param seed of the sample pattern.
  /// @throws std::invalid_argument when camera, size, time, eye or parameters are not valid.
  [[nodiscard]] cv::Mat3f render(const StereoCamera& camera, const cv::Size& size, const CameraMotion& world_from_camera,
                                 double time, int eye, const RenderParams& params, unsigned seed);

  /// Exact truth at the pixel centres at one moment. @throws std::invalid_argument when camera, size or time are not valid.
  [[nodiscard]] Truth trace(const StereoCamera& camera, const cv::Size& size, const Eigen::Isometry3d& world_from_camera,
                            double time);

  /// Height of the topmost standing surface that is no more than 0.6 m above and 3 m below z, under (x, y); NaN when there is
  /// none.
  [[nodiscard]] double ground_height(double x, double y, double z) const;

 private:
  struct Model;
  std::unique_ptr<Model> model_;
};

/// What a sensor does to light. docs/simulator.md tells where the defaults come from.
struct SensorParams {
  double exposure = 1.0;            ///< factor on the automatic exposure, which puts the mean of the left picture at 110
  double gain_difference = 0.02;    ///< right eye's gain is larger by this share
  double noise = 1.0;               ///< factor on shot and read noise; 0 = none
  double vignetting = 0.15;         ///< share of light lost in the corners
  double blur_px = 0.5;             ///< lens, pixel area and colour interpolation: standard deviation, 0..1
  int jpeg_quality = 0;             ///< 1..100; 0 = no JPEG
  double vertical_offset_px = 0.0;  ///< mis-rectification of the right picture
  double rotation_deg = 0.0;        ///< mis-rectification of the right picture, about its centre
  void validate() const;            ///< @throws std::invalid_argument "sensor.name = value, must be ..."
};

/// Linear radiance to an 8-bit picture: exposure, vignetting, noise, display curve, optional JPEG artefacts and
/// mis-rectification.
/// @param gain radiance 1 becomes this much light, where 1 is full scale; the same for both eyes of a frame (automatic exposure
///        is the caller's). Beyond 10 the sensor amplifies and gets noisier.
/// @return size of radiance; empty when that is. @throws std::invalid_argument when gain, eye or parameters are not valid.
cv::Mat3b expose(const cv::Mat3f& radiance, double gain, int eye, const SensorParams& params, unsigned seed);

/// The gain that puts the mean grey of a picture at 110 of 255, within 1e-4..1e4; 1 for an empty picture.
double compute_auto_gain(const cv::Mat3f& radiance);

}  // namespace brink::sim
