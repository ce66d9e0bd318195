#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "brink/sim/scene.hpp"
#include "tracer.hpp"

namespace brink::sim {

/// Light that arrives at places of a scene: sun, sky, and what one bounce sends on. Linear RGB. A diffuse surface of
/// reflectance r under irradiance E has radiance r E / pi.
class Lighting {
 public:
  /// @param scene and tracer have to outlive the lighting.
  Lighting(const Scene& scene, const Tracer& tracer);

  [[nodiscard]] bool has_sun() const { return has_sun_; }
  /// A direction to a point of the sun's disc. @param u, v within 0..1, uniform.
  [[nodiscard]] Eigen::Vector3f to_sun(float u, float v) const;
  /// Radiance of the background in a direction of unit length: sky, or far ground below the horizon.
  [[nodiscard]] Eigen::Vector3f sky(const Eigen::Vector3f& direction) const;
  /// Radiance that arrives along a ray backwards, surfaces in their mean colour.
  [[nodiscard]] Eigen::Vector3f look(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float time,
                                     std::uint32_t random) const;
  /// Irradiance of a place by everything but the sun itself, from the rays [first, first + count) of kGatherRays, which cover
  /// the hemisphere together and evenly.
  [[nodiscard]] Eigen::Vector3f gather(const Place& place, float time, int first, int count, std::uint32_t random) const;

  static constexpr int kGatherRays = 1024;

 private:
  const Scene& scene_;
  const Tracer& tracer_;
  bool has_sun_;
  Eigen::Vector3f sun_right_, sun_up_;             ///< span the sun's disc at distance 1
  std::vector<Eigen::Vector3f> mean_reflectance_;  ///< of the materials
  std::vector<Eigen::Vector3f> hemisphere_;        ///< cosine-distributed directions about z; any run of them is spread out
};

/// The irradiance of sky and bounce over one eye's picture, gathered at every fourth pixel of every fourth row and smoothed
/// along surfaces: it varies slowly, and its rays cost more than all others.
class SkyLight {
 public:
  struct View {
    Eigen::Matrix3f world_from_camera;
    Eigen::Vector3f origin;  ///< m, world
    float focal, cx, cy;     ///< px
    int width, height;       ///< px
  };

  SkyLight(const Tracer& tracer, const Lighting& lighting, const View& view, int rays, std::uint32_t seed);

  /// Irradiance of a place near the picture's surface points; gathered afresh where none of them is near enough.
  [[nodiscard]] Eigen::Vector3f irradiance(const Place& place, float time, std::uint32_t random) const;

 private:
  struct Node {
    Place place;
    Eigen::Vector3f irradiance;
    bool hit = false;
  };
  void gather_row(int row);
  [[nodiscard]] Eigen::Vector3f smoothed(int column, int row) const;
  [[nodiscard]] float likeness(const Place& place, const Node& node) const;
  [[nodiscard]] std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }
  [[nodiscard]] const Node& node(int column, int row) const { return nodes_[index(column, row)]; }

  const Tracer& tracer_;
  const Lighting& lighting_;
  View view_;
  int rays_;
  std::uint32_t seed_;
  int columns_, rows_;
  std::vector<Node> nodes_;
};

}  // namespace brink::sim
