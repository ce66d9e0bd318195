#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "lighting.hpp"
#include "patterns.hpp"

namespace brink::sim {
namespace {

constexpr int kStep = 4;         // px between two nodes
constexpr float kMiddle = 0.5F;  // of the shutter, as ray time

}  // namespace

SkyLight::SkyLight(const Tracer& tracer, const Lighting& lighting, const View& view, int rays, std::uint32_t seed)
    : tracer_(tracer),
      lighting_(lighting),
      view_(view),
      rays_(rays),
      seed_(seed),
      columns_((view.width + kStep - 1) / kStep),
      rows_((view.height + kStep - 1) / kStep),
      nodes_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {
  tbb::parallel_for(0, rows_, [&](int row) { gather_row(row); });
  std::vector<Eigen::Vector3f> irradiance(nodes_.size());
  tbb::parallel_for(0, rows_, [&](int row) {
    for (int column = 0; column < columns_; ++column) {
      irradiance[index(column, row)] = smoothed(column, row);
    }
  });
  for (std::size_t i = 0; i < nodes_.size(); ++i) nodes_[i].irradiance = irradiance[i];
}

void SkyLight::gather_row(int row) {
  for (int column = 0; column < columns_; ++column) {
    const float u = static_cast<float>(column * kStep) + 0.5F * (kStep - 1);
    const float v = static_cast<float>(row * kStep) + 0.5F * (kStep - 1);
    const Eigen::Vector3f direction =
        view_.world_from_camera * Eigen::Vector3f((u - view_.cx) / view_.focal, (v - view_.cy) / view_.focal, 1.0F);
    RTCRayHit ray = make_ray(view_.origin, direction, kMiddle);
    tracer_.intersect(ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
    Node& node = nodes_[index(column, row)];
    node.place = tracer_.locate(view_.origin, direction, ray.ray.tfar, kMiddle, {ray.hit.Ng_x, ray.hit.Ng_y, ray.hit.Ng_z},
                                ray.hit.geomID, ray.hit.primID);
    node.hit = true;
    // Each node of a 4 x 4 block has its own share of the rays; smoothing adds them up.
    const int share = (column & 3) + 4 * (row & 3);
    const auto random = mix_bits(seed_ + static_cast<std::uint32_t>(row * columns_ + column));
    node.irradiance = lighting_.gather(node.place, kMiddle, share * rays_, rays_, random);
  }
}

float SkyLight::likeness(const Place& place, const Node& node) const {
  constexpr float kNear = 0.01F;       // m, and
  constexpr float kPerMetre = 0.004F;  // m per m of distance: how far off a surface still counts as the same
  if (!node.hit) return 0.0F;
  const float facing = place.normal.dot(node.place.normal);
  if (facing < 0.7F) return 0.0F;
  const Eigen::Vector3f between = node.place.position - place.position;
  const float tolerance = kNear + kPerMetre * (place.position - view_.origin).lpNorm<Eigen::Infinity>();
  return facing * std::max(0.0F, 1.0F - std::abs(place.normal.dot(between)) / tolerance);
}

Eigen::Vector3f SkyLight::smoothed(int column, int row) const {
  const Node& center = node(column, row);
  if (!center.hit) return {0.0F, 0.0F, 0.0F};
  Eigen::Vector3f sum(0.0F, 0.0F, 0.0F);
  float weights = 0.0F;
  for (int dy = -2; dy <= 2; ++dy) {
    for (int dx = -2; dx <= 2; ++dx) {
      const int x = column + dx;
      const int y = row + dy;
      if (x < 0 || x >= columns_ || y < 0 || y >= rows_) continue;
      // Half weight at the rim gives each of the 4 x 4 shares of the rays the same weight.
      const float rim = (std::abs(dx) == 2 ? 0.5F : 1.0F) * (std::abs(dy) == 2 ? 0.5F : 1.0F);
      const float weight = rim * likeness(center.place, node(x, y));
      sum += weight * node(x, y).irradiance;
      weights += weight;
    }
  }
  return sum / weights;  // the centre alone weighs 1
}

Eigen::Vector3f SkyLight::irradiance(const Place& place, float time, std::uint32_t random) const {
  constexpr float kEnough = 0.1F;
  const Eigen::Vector3f p = view_.world_from_camera.transpose() * (place.position - view_.origin);
  Eigen::Vector3f sum(0.0F, 0.0F, 0.0F);
  float weights = 0.0F;
  if (p.z() > 1e-3F) {
    const auto to_node = [](float pixel, int count) {
      return std::clamp((pixel - 0.5F * (kStep - 1)) / kStep, 0.0F, static_cast<float>(count - 1));
    };
    const float u = to_node(view_.focal * p.x() / p.z() + view_.cx, columns_);
    const float v = to_node(view_.focal * p.y() / p.z() + view_.cy, rows_);
    const int column = static_cast<int>(u);
    const int row = static_cast<int>(v);
    const float fu = u - static_cast<float>(column);
    const float fv = v - static_cast<float>(row);
    for (int dy = 0; dy < 2 && row + dy < rows_; ++dy) {
      for (int dx = 0; dx < 2 && column + dx < columns_; ++dx) {
        const Node& near = node(column + dx, row + dy);
        const float weight = (dx == 0 ? 1.0F - fu : fu) * (dy == 0 ? 1.0F - fv : fv) * likeness(place, near);
        sum += weight * near.irradiance;
        weights += weight;
      }
    }
  }
  if (weights >= kEnough) return sum / weights;
  return lighting_.gather(place, time, static_cast<int>(random % 16U) * rays_, rays_, random);
}

}  // namespace brink::sim
