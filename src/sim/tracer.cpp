#include "tracer.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include <Eigen/Geometry>
#include <tbb/task_arena.h>

namespace brink::sim {
namespace {

constexpr unsigned kAllGeometry = ~0U;  // Embree ignores rays whose mask is 0

/// Builds with one thread: the order of triangles in the tree, which decides between two surfaces in one place, must not depend
/// on the machine.
void commit(RTCScene scene) {
  tbb::task_arena(1).execute([&] { rtcCommitScene(scene); });
}

void attach(RTCDevice device, RTCScene scene, const Mesh& mesh, unsigned id, unsigned time_steps) {
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetGeometryTimeStepCount(geometry, time_steps);
  for (unsigned step = 0; step < time_steps; ++step) {
    auto* vertices = static_cast<Eigen::Vector3f*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, step, RTC_FORMAT_FLOAT3, sizeof(Eigen::Vector3f), mesh.vertices.size()));
    std::copy(mesh.vertices.begin(), mesh.vertices.end(), vertices);
  }
  auto* triangles = static_cast<Eigen::Vector3i*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                          sizeof(Eigen::Vector3i), mesh.triangles.size()));
  std::copy(mesh.triangles.begin(), mesh.triangles.end(), triangles);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene, geometry, id);
  rtcReleaseGeometry(geometry);
}

RTCIntersectContext make_context(RTCIntersectContextFlags flags) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = flags;
  return context;
}

}  // namespace

Tracer::Tracer(const Scene& scene) : scene_(scene), device_(rtcNewDevice(nullptr)) {
  if (device_ == nullptr) throw std::runtime_error("Embree does not start on this machine");
  standing_ = rtcNewScene(device_);
  rtcSetSceneFlags(standing_, RTC_SCENE_FLAG_ROBUST);  // no cracks between triangles
  for (unsigned id = 0; id < scene.meshes.size(); ++id) {
    const Mesh& mesh = scene.meshes[id];
    if (mesh.triangles.empty()) continue;
    if (mesh.body < 0) {
      attach(device_, standing_, mesh, id, 1);
      continue;
    }
    if (moving_ == nullptr) {
      moving_ = rtcNewScene(device_);
      rtcSetSceneFlags(moving_, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC);
    }
    attach(device_, moving_, mesh, id, 2);
  }
  commit(standing_);
  if (moving_ != nullptr) commit(moving_);
}

Tracer::~Tracer() {
  if (moving_ != nullptr) rtcReleaseScene(moving_);
  rtcReleaseScene(standing_);
  rtcReleaseDevice(device_);
}

void Tracer::open_shutter(double start, double end) {
  start_ = start;
  end_ = end;
  if (moving_ == nullptr) return;
  for (unsigned id = 0; id < scene_.meshes.size(); ++id) {
    const Mesh& mesh = scene_.meshes[id];
    if (mesh.body < 0 || mesh.triangles.empty()) continue;
    const RTCGeometry geometry = rtcGetGeometry(moving_, id);
    for (const unsigned step : {0U, 1U}) {
      const Eigen::Vector3f shift = velocity(id) * static_cast<float>(step == 0U ? start : end);
      auto* vertices = static_cast<Eigen::Vector3f*>(rtcGetGeometryBufferData(geometry, RTC_BUFFER_TYPE_VERTEX, step));
      std::transform(mesh.vertices.begin(), mesh.vertices.end(), vertices,
                     [&](const Eigen::Vector3f& vertex) -> Eigen::Vector3f { return vertex + shift; });
      rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, step);
    }
    rtcCommitGeometry(geometry);
  }
  commit(moving_);
}

void Tracer::intersect(const PacketMask& mask, RTCRayHit16& rays) const {
  RTCIntersectContext context = make_context(RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
  rtcIntersect16(mask.lanes.data(), standing_, &context, &rays);
  if (moving_ != nullptr) rtcIntersect16(mask.lanes.data(), moving_, &context, &rays);
}

void Tracer::occlude(const PacketMask& mask, RTCRay16& rays) const {
  RTCIntersectContext context = make_context(RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
  rtcOccluded16(mask.lanes.data(), standing_, &context, &rays);
  if (moving_ == nullptr) return;
  PacketMask left = mask;
  for (int i = 0; i < kPacket; ++i) {
    if (rays.tfar[i] < 0.0F) left.lanes[static_cast<std::size_t>(i)] = 0;
  }
  rtcOccluded16(left.lanes.data(), moving_, &context, &rays);
}

void Tracer::intersect(RTCRayHit& ray) const {
  RTCIntersectContext context = make_context(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
  rtcIntersect1(standing_, &context, &ray);
  if (moving_ != nullptr) rtcIntersect1(moving_, &context, &ray);
}

void Tracer::intersect_standing(RTCRayHit& ray) const {
  RTCIntersectContext context = make_context(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
  rtcIntersect1(standing_, &context, &ray);
}

bool Tracer::is_blocked(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float time) const {
  RTCIntersectContext context = make_context(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
  RTCRay ray = make_ray(origin, direction, time).ray;
  rtcOccluded1(standing_, &context, &ray);
  if (ray.tfar < 0.0F || moving_ == nullptr) return ray.tfar < 0.0F;
  rtcOccluded1(moving_, &context, &ray);
  return ray.tfar < 0.0F;
}

Eigen::Vector3f Tracer::velocity(unsigned mesh) const {
  const int body = scene_.meshes[mesh].body;
  return body < 0 ? Eigen::Vector3f(0.0F, 0.0F, 0.0F) : scene_.bodies[static_cast<std::size_t>(body)].velocity;
}

Place Tracer::locate(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float distance, float time,
                     const Eigen::Vector3f& geometric_normal, unsigned mesh, unsigned triangle) const {
  Place place{origin + distance * direction, geometric_normal.normalized(), {}, mesh, triangle};
  if (place.normal.dot(direction) > 0.0F) place.normal = -place.normal;
  place.body_position = place.position;
  if (scene_.meshes[mesh].body >= 0) {
    place.body_position -= velocity(mesh) * static_cast<float>(start_ + static_cast<double>(time) * (end_ - start_));
  }
  return place;
}

double Tracer::intersect_plane(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, unsigned mesh,
                               unsigned triangle, double moment) const {
  const Mesh& m = scene_.meshes[mesh];
  const Eigen::Vector3i corners = m.triangles[triangle];
  const auto corner = [&](int i) -> Eigen::Vector3d {
    return m.vertices[static_cast<std::size_t>(corners[i])].cast<double>() + moment * velocity(mesh).cast<double>();
  };
  const Eigen::Vector3d a = corner(0);
  const Eigen::Vector3d normal = (corner(1) - a).cross(corner(2) - a);
  return normal.dot(a - origin) / normal.dot(direction);
}

RTCRayHit make_ray(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float time) {
  RTCRayHit ray{};
  ray.ray.org_x = origin.x();
  ray.ray.org_y = origin.y();
  ray.ray.org_z = origin.z();
  ray.ray.dir_x = direction.x();
  ray.ray.dir_y = direction.y();
  ray.ray.dir_z = direction.z();
  ray.ray.time = time;
  ray.ray.tfar = std::numeric_limits<float>::infinity();
  ray.ray.mask = kAllGeometry;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  return ray;
}

void set_lane(RTCRay16& rays, int lane, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float time) {
  rays.org_x[lane] = origin.x();
  rays.org_y[lane] = origin.y();
  rays.org_z[lane] = origin.z();
  rays.tnear[lane] = 0.0F;
  rays.dir_x[lane] = direction.x();
  rays.dir_y[lane] = direction.y();
  rays.dir_z[lane] = direction.z();
  rays.time[lane] = time;
  rays.tfar[lane] = std::numeric_limits<float>::infinity();
  rays.mask[lane] = kAllGeometry;
  rays.id[lane] = 0U;
  rays.flags[lane] = 0U;
}

Eigen::Vector3f lift(const Place& place) {
  constexpr float kNear = 2e-4F;  // m
  constexpr float kFar = 4e-6F;   // of the coordinates, which floats hold to 6e-8
  return place.position + (kNear + kFar * place.position.cwiseAbs().maxCoeff()) * place.normal;
}

}  // namespace brink::sim
