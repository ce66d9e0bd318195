#include "brink/sim/scene.hpp"

#include <array>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace brink::sim {
namespace {

void require(bool good, const std::string& fault) {
  if (!good) throw std::invalid_argument("scene: " + fault);
}

bool is_share(const Eigen::Vector3f& color) {
  return color.allFinite() && color.minCoeff() >= 0.0F && color.maxCoeff() <= 1.0F;
}

bool is_light(const Eigen::Vector3f& color) { return color.allFinite() && color.minCoeff() >= 0.0F; }

void validate_material(const Material& material, std::size_t index) {
  require(is_share(material.color) && is_share(material.second_color),
          fmt::format("materials[{}] has a colour outside 0..1", index));
  require(material.cell_m > 0.0F && std::isfinite(material.cell_m),
          fmt::format("materials[{}].cell_m = {}, must be positive", index, material.cell_m));
  require(material.contrast >= 0.0F && material.contrast <= 1.0F,
          fmt::format("materials[{}].contrast = {}, must be 0..1", index, material.contrast));
  require(material.gloss >= 0.0F && material.gloss <= 1.0F,
          fmt::format("materials[{}].gloss = {}, must be 0..1", index, material.gloss));
  require(material.relief_m >= 0.0F && material.relief_m <= 0.1F,
          fmt::format("materials[{}].relief_m = {}, must be 0..0.1", index, material.relief_m));
}

void validate_mesh(const Scene& scene, const std::array<bool, 256>& known, std::size_t index) {
  const Mesh& mesh = scene.meshes[index];
  require(mesh.material >= 0 && mesh.material < static_cast<int>(scene.materials.size()),
          fmt::format("meshes[{}].material = {}, must be an index into {} materials", index, mesh.material,
                      scene.materials.size()));
  require(mesh.body >= -1 && mesh.body < static_cast<int>(scene.bodies.size()),
          fmt::format("meshes[{}].body = {}, must be -1 or an index into {} bodies", index, mesh.body, scene.bodies.size()));
  const bool labelled = mesh.obstacle >= 0 && mesh.obstacle <= 255 && known.at(static_cast<std::size_t>(mesh.obstacle));
  require(labelled, fmt::format("meshes[{}].obstacle = {}, must be 0, 255 or the id of an instance", index, mesh.obstacle));
  for (const Eigen::Vector3f& p : mesh.vertices)
    require(p.allFinite(), fmt::format("meshes[{}] has a vertex that is not finite", index));
  const int count = static_cast<int>(mesh.vertices.size());
  for (const Eigen::Vector3i& t : mesh.triangles) {
    require(t.minCoeff() >= 0 && t.maxCoeff() < count,
            fmt::format("meshes[{}] has a triangle outside its {} vertices", index, count));
  }
}

void validate_instance(const Instance& instance) {
  require(!instance.type.empty(), fmt::format("instance {} has no type", instance.id));
  require(instance.depth_m > 0.0 && std::isfinite(instance.depth_m),
          fmt::format("depth_m of instance {} = {}, must be positive", instance.id, instance.depth_m));
  require(instance.opening.size() >= 3, fmt::format("opening of instance {} has fewer than 3 corners", instance.id));
  for (const Eigen::Vector3d& p : instance.opening) {
    require(p.allFinite(), fmt::format("opening of instance {} has a corner that is not finite", instance.id));
  }
}

}  // namespace

void Scene::validate() const {
  for (std::size_t i = 0; i < materials.size(); ++i) validate_material(materials[i], i);
  for (const Body& body : bodies) require(body.velocity.allFinite(), "a body's velocity is not finite");
  std::array<bool, 256> known{};
  known.front() = known.back() = true;
  for (const Instance& instance : instances) {
    require(instance.id >= 1 && instance.id <= 254, fmt::format("instance id = {}, must be 1..254", instance.id));
    bool& seen = known.at(static_cast<std::size_t>(instance.id));
    require(!seen, fmt::format("instance id {} appears twice", instance.id));
    seen = true;
    validate_instance(instance);
  }
  for (std::size_t i = 0; i < meshes.size(); ++i) validate_mesh(*this, known, i);
  require(is_light(light.sun) && is_light(light.sky), "light has a colour that is negative or not finite");
  require(std::abs(light.to_sun.norm() - 1.0F) < 1e-3F, "light.to_sun must be a unit vector");
  require(light.sun_radius_deg >= 0.0F && std::isfinite(light.sun_radius_deg),
          fmt::format("light.sun_radius_deg = {}, must not be negative", light.sun_radius_deg));
}

}  // namespace brink::sim
