#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>
#include <embree3/rtcore.h>

#include "brink/sim/scene.hpp"

namespace brink::sim {

inline constexpr int kPacket = 16;  ///< rays that Embree traces together

/// Which of a packet's rays are to be traced: -1 = yes, 0 = no.
struct alignas(64) PacketMask {
  std::array<int, kPacket> lanes{};
};

/// A ray's first hit.
struct Place {
  Eigen::Vector3f position;       ///< world, m
  Eigen::Vector3f normal;         ///< unit length, towards where the ray came from
  Eigen::Vector3f body_position;  ///< position when the body stood where it is at time 0
  unsigned mesh;                  ///< index into Scene::meshes
  unsigned triangle;              ///< of that mesh
};

/// The meshes of a scene in Embree: what stands in one ray-tracing scene, what moves in another that is rebuilt for each
/// shutter opening with linear motion blur. Tracing is safe from several threads; open_shutter is not.
class Tracer {
 public:
  /// @param scene valid; its meshes are copied, the scene itself has to outlive the tracer.
  explicit Tracer(const Scene& scene);
  ~Tracer();
  Tracer(const Tracer&) = delete;
  Tracer& operator=(const Tracer&) = delete;

  /// Places the moving bodies: a ray's time 0..1 means start..end, s.
  void open_shutter(double start, double end);

  /// First hits of coherent rays; geomID is the mesh, or RTC_INVALID_GEOMETRY_ID.
  void intersect(const PacketMask& mask, RTCRayHit16& rays) const;
  /// Blocked rays get a negative tfar.
  void occlude(const PacketMask& mask, RTCRay16& rays) const;
  void intersect(RTCRayHit& ray) const;
  [[nodiscard]] bool is_blocked(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float time) const;
  /// First hit on what stands only.
  void intersect_standing(RTCRayHit& ray) const;

  /// The place of a hit. @param distance along the direction, @param geometric_normal of any length and side, as Embree tells.
  [[nodiscard]] Place locate(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float distance, float time,
                             const Eigen::Vector3f& geometric_normal, unsigned mesh, unsigned triangle) const;
  /// How far along origin + t direction the plane of a triangle lies, in double precision, at a moment, s.
  [[nodiscard]] double intersect_plane(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, unsigned mesh,
                                       unsigned triangle, double moment) const;

 private:
  [[nodiscard]] Eigen::Vector3f velocity(unsigned mesh) const;

  const Scene& scene_;
  RTCDevice device_;
  RTCScene standing_ = nullptr;
  RTCScene moving_ = nullptr;  ///< null when nothing moves
  double start_ = 0.0;
  double end_ = 0.0;
};

/// A single ray, ready to be traced.
RTCRayHit make_ray(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float time);

/// Sets one ray of a packet.
void set_lane(RTCRay16& rays, int lane, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float time);

/// Where rays that leave a place start: a little above the surface, so that they do not meet it again.
Eigen::Vector3f lift(const Place& place);

}  // namespace brink::sim
