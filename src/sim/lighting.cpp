#include "lighting.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "patterns.hpp"

namespace brink::sim {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr std::uint32_t kNext = 0x9e3779b9U;  // steps from one random number of a ray to the next

/// Bits reversed: the van der Corput sequence, which fills [0, 1) evenly at any length.
float radical_inverse(std::uint32_t i) {
  std::uint32_t reversed = 0;
  for (int bit = 0; bit < 32; ++bit, i >>= 1U) reversed = reversed << 1U | (i & 1U);
  return to_unit(reversed);
}

/// Cosine-distributed about z from two uniform numbers.
Eigen::Vector3f to_hemisphere(float u, float v) {
  const float radius = std::sqrt(u);
  return {radius * std::cos(2.0F * kPi * v), radius * std::sin(2.0F * kPi * v), std::sqrt(1.0F - u)};
}

/// Axes at right angles to a unit vector, without a jump except at -z (Duff et al. 2017, "Building an orthonormal basis,
/// revisited").
Eigen::Matrix3f make_axes(const Eigen::Vector3f& n) {
  const float sign = std::copysign(1.0F, n.z());
  const float a = -1.0F / (sign + n.z());
  const float b = n.x() * n.y() * a;
  Eigen::Matrix3f axes;
  axes.col(0) = Eigen::Vector3f(1.0F + sign * n.x() * n.x() * a, sign * b, -sign * n.x());
  axes.col(1) = Eigen::Vector3f(b, sign + n.y() * n.y() * a, -n.y());
  axes.col(2) = n;
  return axes;
}

}  // namespace

Lighting::Lighting(const Scene& scene, const Tracer& tracer)
    : scene_(scene), tracer_(tracer), has_sun_(scene.light.sun.maxCoeff() > 0.0F) {
  const Eigen::Matrix3f axes = make_axes(scene.light.to_sun.normalized());
  const float radius = std::tan(scene.light.sun_radius_deg * kPi / 180.0F);
  sun_right_ = radius * axes.col(0);
  sun_up_ = radius * axes.col(1);
  for (const Material& material : scene.materials) mean_reflectance_.push_back(compute_mean_reflectance(material));
  // A rank-1 lattice (golden ratio, van der Corput): every run of consecutive points covers the hemisphere.
  for (std::uint32_t i = 0; i < kGatherRays; ++i) {
    hemisphere_.push_back(to_hemisphere(radical_inverse(i), to_unit(i * kNext)));
  }
}

Eigen::Vector3f Lighting::to_sun(float u, float v) const {
  const float radius = std::sqrt(u);
  return (scene_.light.to_sun + radius * std::cos(2.0F * kPi * v) * sun_right_ + radius * std::sin(2.0F * kPi * v) * sun_up_)
      .normalized();
}

Eigen::Vector3f Lighting::sky(const Eigen::Vector3f& direction) const {
  constexpr float kFarGround = 0.25F;  // radiance of the ground beyond the scene's end, share of the horizon's
  constexpr float kHaze = 0.03F;       // sine of the angle over which the horizon blurs
  // Overcast: the CIE sky, three times brighter in the zenith than at the horizon. Clear: brighter towards the horizon. Both
  // give a free horizontal surface the irradiance pi times Light::sky.
  const float height = std::max(direction.z(), 0.0F);
  const float gradient = has_sun_ ? 1.4F - 0.6F * height : (3.0F + 6.0F * height) / 7.0F;
  const float below = std::clamp(-direction.z() / kHaze, 0.0F, 1.0F);
  return scene_.light.sky * (gradient * (1.0F - below * (1.0F - kFarGround)));
}

Eigen::Vector3f Lighting::look(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float time,
                               std::uint32_t random) const {
  RTCRayHit ray = make_ray(origin, direction, time);
  tracer_.intersect(ray);
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return sky(direction);
  const Place place = tracer_.locate(origin, direction, ray.ray.tfar, time, {ray.hit.Ng_x, ray.hit.Ng_y, ray.hit.Ng_z},
                                     ray.hit.geomID, ray.hit.primID);
  const Eigen::Vector3f start = lift(place);
  Eigen::Vector3f irradiance(0.0F, 0.0F, 0.0F);
  const Eigen::Vector3f up =
      make_axes(place.normal) * to_hemisphere(to_unit(mix_bits(random)), to_unit(mix_bits(random + kNext)));
  if (!tracer_.is_blocked(start, up, time)) irradiance = kPi * sky(up);
  const float facing = place.normal.dot(scene_.light.to_sun);
  if (has_sun_ && facing > 0.0F && !tracer_.is_blocked(start, scene_.light.to_sun, time)) {
    irradiance += facing * scene_.light.sun;
  }
  const auto material = static_cast<std::size_t>(scene_.meshes[place.mesh].material);
  return mean_reflectance_[material].cwiseProduct(irradiance) / kPi;
}

Eigen::Vector3f Lighting::gather(const Place& place, float time, int first, int count, std::uint32_t random) const {
  const Eigen::Matrix3f axes = make_axes(place.normal);
  const Eigen::Vector3f start = lift(place);
  Eigen::Vector3f sum(0.0F, 0.0F, 0.0F);
  for (int i = 0; i < count; ++i) {
    const auto index = static_cast<std::uint32_t>(first + i);
    const Eigen::Vector3f direction = axes * hemisphere_[index % kGatherRays];
    sum += look(start, direction, time, random + 2U * kNext * index);
  }
  return sum * (kPi / static_cast<float>(count));
}

}  // namespace brink::sim
