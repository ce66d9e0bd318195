#include "brink/sim/render.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "lighting.hpp"
#include "picture.hpp"
#include "tracer.hpp"

namespace brink::sim {
namespace {

void require(bool valid, const char* name, double value, const char* expected) {
  if (!valid) throw std::invalid_argument(fmt::format("{} = {}, must be {}", name, value, expected));
}

void check_view(const StereoCamera& camera, const cv::Size& size, double time) {
  constexpr int kLargest = 16384;
  camera.validate();
  require(size.width >= 0 && size.width <= kLargest, "width", size.width, "0 to 16384 px");
  require(size.height >= 0 && size.height <= kLargest, "height", size.height, "0 to 16384 px");
  require(std::isfinite(time), "time", time, "finite, s");
}

}  // namespace

void RenderParams::validate() const {
  require(samples >= 1 && samples <= 1024, "render.samples", samples, "1 to 1024");
  require(shutter_s >= 0.0 && shutter_s <= 1.0, "render.shutter_s", shutter_s, "0 to 1 s");
  require(sky_rays >= 1 && sky_rays <= 64, "render.sky_rays", sky_rays, "1 to 64");
}

struct Renderer::Model {
  explicit Model(Scene source) : scene(std::move(source)), tracer(scene), lighting(scene, tracer) {}
  Scene scene;
  Tracer tracer;
  Lighting lighting;
};

Renderer::Renderer(const Scene& scene) {
  scene.validate();
  model_ = std::make_unique<Model>(scene);
}

Renderer::~Renderer() = default;

cv::Mat3f Renderer::render(const StereoCamera& camera, const cv::Size& size, const CameraMotion& world_from_camera, double time,
                           int eye, const RenderParams& params, unsigned seed) {
  check_view(camera, size, time);
  params.validate();
  require(eye == 0 || eye == 1, "eye", eye, "0 (left) or 1 (right)");
  model_->tracer.open_shutter(time - 0.5 * params.shutter_s, time + 0.5 * params.shutter_s);
  return render_picture(model_->scene, model_->tracer, model_->lighting, camera, size, world_from_camera, time, eye, params,
                        seed);
}

Truth Renderer::trace(const StereoCamera& camera, const cv::Size& size, const Eigen::Isometry3d& world_from_camera,
                      double time) {
  check_view(camera, size, time);
  Tracer& tracer = model_->tracer;
  tracer.open_shutter(time, time);
  const Eigen::Vector3d origin = world_from_camera.translation();
  Truth truth{cv::Mat1f(size, 0.0F), cv::Mat1b(size, std::uint8_t{0})};
  tbb::parallel_for(0, size.height, [&](int row) {
    for (int column = 0; column < size.width; ++column) {
      // With z = 1 the distance along the ray is the depth.
      const Eigen::Vector3d direction = world_from_camera.linear() * Eigen::Vector3d((column - camera.cx) / camera.focal,
                                                                                     (row - camera.cy) / camera.focal, 1.0);
      RTCRayHit ray = make_ray(origin.cast<float>(), direction.cast<float>(), 0.0F);
      tracer.intersect(ray);
      if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
      const double depth = tracer.intersect_plane(origin, direction, ray.hit.geomID, ray.hit.primID, time);
      truth.disparity(row, column) = static_cast<float>(camera.focal * camera.baseline / depth);
      truth.obstacle(row, column) = static_cast<std::uint8_t>(model_->scene.meshes[ray.hit.geomID].obstacle);
    }
  });
  return truth;
}

double Renderer::ground_height(double x, double y, double z) const {
  constexpr double kAbove = 0.6;  // m
  constexpr double kBelow = 3.0;  // m
  const Eigen::Vector3d origin(x, y, z + kAbove);
  const Eigen::Vector3d down(0.0, 0.0, -1.0);
  RTCRayHit ray = make_ray(origin.cast<float>(), down.cast<float>(), 0.0F);
  ray.ray.tfar = static_cast<float>(kAbove + kBelow);
  model_->tracer.intersect_standing(ray);
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::numeric_limits<double>::quiet_NaN();
  return origin.z() - model_->tracer.intersect_plane(origin, down, ray.hit.geomID, ray.hit.primID, 0.0);
}

}  // namespace brink::sim
