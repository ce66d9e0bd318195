#include "sim/materials.hpp"

#include <algorithm>

namespace brink::sim::materials {
namespace {

Material make(Pattern pattern, Eigen::Vector3f color, Eigen::Vector3f second, float cell_m, float contrast, float gloss,
              float relief_m = 0.0F) {
  return {.pattern = pattern,
          .color = std::move(color),
          .second_color = std::move(second),
          .cell_m = cell_m,
          .contrast = contrast,
          .gloss = gloss,
          .relief_m = relief_m};
}

}  // namespace

Material asphalt() {
  return make(Pattern::asphalt, {0.10F, 0.10F, 0.105F}, {0.26F, 0.25F, 0.24F}, 0.012F, 1.0F, 0.0F, 0.0012F);
}
Material wet_asphalt() {
  return make(Pattern::asphalt, {0.035F, 0.036F, 0.04F}, {0.08F, 0.08F, 0.08F}, 0.012F, 0.7F, 0.05F, 0.0012F);
}
Material oil() { return make(Pattern::asphalt, {0.012F, 0.011F, 0.012F}, {0.03F, 0.03F, 0.03F}, 0.012F, 0.4F, 0.04F, 0.0012F); }
Material concrete() {
  return make(Pattern::concrete, {0.32F, 0.31F, 0.29F}, {0.20F, 0.19F, 0.18F}, 0.25F, 0.8F, 0.0F, 0.0004F);
}
Material paving() { return make(Pattern::tiles, {0.34F, 0.33F, 0.31F}, {0.12F, 0.11F, 0.10F}, 0.40F, 1.0F, 0.0F, 0.0006F); }
Material cobbles() { return make(Pattern::tiles, {0.24F, 0.22F, 0.21F}, {0.07F, 0.06F, 0.05F}, 0.11F, 1.0F, 0.0F, 0.003F); }
Material soot() { return make(Pattern::concrete, {0.045F, 0.043F, 0.04F}, {0.025F, 0.024F, 0.022F}, 0.25F, 0.8F, 0.0F); }
Material gravel() { return make(Pattern::gravel, {0.36F, 0.33F, 0.29F}, {0.13F, 0.12F, 0.10F}, 0.025F, 1.0F, 0.0F, 0.004F); }
Material soil() { return make(Pattern::gravel, {0.17F, 0.12F, 0.08F}, {0.08F, 0.055F, 0.035F}, 0.035F, 0.9F, 0.0F, 0.004F); }
Material grass() { return make(Pattern::grass, {0.09F, 0.17F, 0.045F}, {0.035F, 0.07F, 0.02F}, 0.02F, 1.0F, 0.0F, 0.006F); }
Material leaves() { return make(Pattern::leaves, {0.07F, 0.15F, 0.035F}, {0.025F, 0.06F, 0.015F}, 0.08F, 1.0F, 0.0F); }
Material bark() { return make(Pattern::plaster, {0.14F, 0.10F, 0.07F}, {0.06F, 0.045F, 0.03F}, 0.03F, 1.0F, 0.0F); }
Material iron() { return make(Pattern::metal, {0.12F, 0.105F, 0.095F}, {0.05F, 0.042F, 0.038F}, 0.05F, 1.0F, 0.06F); }
Material painted_steel() { return make(Pattern::metal, {0.30F, 0.30F, 0.30F}, {0.22F, 0.22F, 0.22F}, 0.10F, 0.4F, 0.05F); }
Material dark_steel() { return make(Pattern::metal, {0.022F, 0.022F, 0.025F}, {0.012F, 0.012F, 0.013F}, 0.05F, 0.5F, 0.04F); }
Material rubber() { return make(Pattern::rubber, {0.018F, 0.018F, 0.018F}, {0.008F, 0.008F, 0.008F}, 0.02F, 0.6F, 0.0F); }
Material tactile() { return make(Pattern::tactile, {0.55F, 0.42F, 0.08F}, {0.38F, 0.28F, 0.05F}, 0.06F, 1.0F, 0.0F); }
Material white_paint() { return make(Pattern::concrete, {0.70F, 0.70F, 0.68F}, {0.45F, 0.45F, 0.43F}, 0.10F, 0.6F, 0.0F); }
Material white_wall() { return make(Pattern::plaster, {0.78F, 0.78F, 0.76F}, {0.72F, 0.72F, 0.70F}, 0.02F, 0.25F, 0.0F); }
Material plaster() { return make(Pattern::plaster, {0.48F, 0.42F, 0.33F}, {0.36F, 0.31F, 0.24F}, 0.02F, 0.8F, 0.0F); }
Material brick() { return make(Pattern::tiles, {0.26F, 0.11F, 0.075F}, {0.30F, 0.28F, 0.25F}, 0.12F, 1.0F, 0.0F); }
Material dark_window() { return make(Pattern::plain, {0.012F, 0.014F, 0.016F}, {0.012F, 0.014F, 0.016F}, 1.0F, 0.0F, 0.06F); }
Material wood() { return make(Pattern::plaster, {0.27F, 0.17F, 0.09F}, {0.17F, 0.10F, 0.05F}, 0.015F, 0.9F, 0.0F); }
Material cloth() { return make(Pattern::cloth, {0.16F, 0.16F, 0.22F}, {0.10F, 0.10F, 0.14F}, 0.03F, 0.8F, 0.0F); }
Material skin() { return make(Pattern::plain, {0.38F, 0.24F, 0.17F}, {0.38F, 0.24F, 0.17F}, 0.1F, 0.0F, 0.02F); }

Material colored(Material material, const Eigen::Vector3f& color) {
  const Eigen::Vector3f ratio = material.second_color.cwiseQuotient(material.color);
  material.color = color;
  material.second_color = color.cwiseProduct(ratio).cwiseMin(1.0F);
  return material;
}

Material varied(Material material, Random& random) {
  const auto brighter = static_cast<float>(random.uniform(0.75, 1.3));
  const auto warmer = static_cast<float>(random.uniform(-0.06, 0.06));
  const Eigen::Vector3f tint = brighter * Eigen::Vector3f(1.0F + warmer, 1.0F, 1.0F - warmer);
  material.color = material.color.cwiseProduct(tint).cwiseMin(0.9F);
  material.second_color = material.second_color.cwiseProduct(tint).cwiseMin(0.9F);
  material.cell_m *= static_cast<float>(random.uniform(0.75, 1.35));
  material.contrast = std::min(1.0F, material.contrast * static_cast<float>(random.uniform(0.75, 1.2)));
  return material;
}

Eigen::Vector3f random_color(Random& random) {
  const double value = random.uniform(0.03, 0.45);
  const double saturation = random.uniform(0.0, 0.8);
  Eigen::Vector3f color;
  for (int i = 0; i < 3; ++i) color[i] = static_cast<float>(value * (1.0 - saturation * random.uniform(0.0, 1.0)));
  return color;
}

}  // namespace brink::sim::materials
