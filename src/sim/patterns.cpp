#include "patterns.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace brink::sim {
namespace {

/// Where in a pattern a place lies.
struct Shade {
  float mix;         ///< share of second_color, 0..1
  float brightness;  ///< factor on the mixed colour, mean 1
};

/// How strongly a surface varies on which scale: standard deviation of an octave with cells of size c is
/// floor + peak * min(c / peak_m, peak_m / c), relative to the mean. docs/simulator.md compares it with real roads.
struct Grain {
  float peak_m;  ///< size of the grains
  float peak;    ///< what they add
  float floor;   ///< of all coarser variation: patches, dirt, wear
};

constexpr float kPatches = 1.024F;  // m; the coarsest variation: dirt, wear, repairs
constexpr float kLargestReflectance = 0.95F;

float smooth(float x) {
  x = std::clamp(x, 0.0F, 1.0F);
  return x * x * (3.0F - 2.0F * x);
}

/// 1 for features that the footprint resolves, falling to 0 for those half as large as it. Samples of a pixel average what is
/// smaller than the pixel but larger than that, as a real pixel does.
float visibility(float cell, float footprint) { return std::clamp(cell / footprint - 0.5F, 0.0F, 1.0F); }

/// Quintic weight, twice differentiable: no creases at the cells' borders.
float ease(float x) { return x * x * x * (x * (x * 6.0F - 15.0F) + 10.0F); }

/// Without the call into the C library that std::floor is on a plain x86-64.
int floor_of(float x) {
  const int truncated = static_cast<int>(x);
  return truncated - (x < static_cast<float>(truncated) ? 1 : 0);
}

/// Value noise on the integer lattice, mean 0, variance 1.
float lattice_noise(const Eigen::Vector3f& p, std::uint32_t seed) {
  // The weights' mean square sum per axis is 181/231, the variance of uniform values in [-1, 1] is 1/3.
  constexpr float kToUnitVariance = 2.4973F;
  constexpr std::uint32_t kX = 0x8da6b343U;
  constexpr std::uint32_t kY = 0xd8163841U;
  constexpr std::uint32_t kZ = 0xcb1ab31fU;
  const int ix = floor_of(p.x());
  const int iy = floor_of(p.y());
  const int iz = floor_of(p.z());
  const std::uint32_t x = static_cast<std::uint32_t>(ix) * kX;
  const std::uint32_t y = static_cast<std::uint32_t>(iy) * kY;
  const std::uint32_t z = static_cast<std::uint32_t>(iz) * kZ;
  const auto corner = [&](std::uint32_t cx, std::uint32_t cy, std::uint32_t cz) {
    std::uint32_t h = cx ^ cy ^ cz ^ seed;
    h ^= h >> 15U;
    h *= 0x2c1b3c6dU;
    h ^= h >> 13U;
    return static_cast<float>(static_cast<std::int32_t>(h * 0x297a2d39U));
  };
  const float wx = ease(p.x() - static_cast<float>(ix));
  const float wy = ease(p.y() - static_cast<float>(iy));
  const float wz = ease(p.z() - static_cast<float>(iz));
  const auto along_x = [&](std::uint32_t cy, std::uint32_t cz) {
    const float a = corner(x, cy, cz);
    return a + wx * (corner(x + kX, cy, cz) - a);
  };
  const float a = along_x(y, z);
  const float b = along_x(y, z + kZ);
  const float near = a + wy * (along_x(y + kY, z) - a);
  const float far = b + wy * (along_x(y + kY, z + kZ) - b);
  return (near + wz * (far - near)) * (kToUnitVariance * 0x1p-31F);
}

/// Turns by an oblique angle, so that the lattices of two octaves never line up with each other or with the world.
Eigen::Vector3f tilt(const Eigen::Vector3f& p) {
  return {0.80F * p.y() + 0.60F * p.z(), -0.80F * p.x() + 0.36F * p.y() - 0.48F * p.z(),
          -0.60F * p.x() - 0.48F * p.y() + 0.64F * p.z()};
}

}  // namespace

float compute_noise(const Eigen::Vector3f& position, float cell, std::uint32_t seed) {
  return lattice_noise(tilt(position) / cell, seed);
}

namespace {

/// Relative variation of a surface: octaves from patches down to what the footprint resolves. Finer grains do not vanish: n of
/// them average to 1 / sqrt(n) of their contrast, so each octave hands a quarter of the variance that is not seen to the next
/// coarser.
float sum_octaves(const SurfacePoint& point, const Grain& grain, std::uint32_t seed) {
  constexpr int kOctaves = 11;  // from 1.024 m to 1 mm
  std::array<float, kOctaves> strengths{};
  float cell = kPatches / static_cast<float>(1 << (kOctaves - 1));
  float carried = 0.0F;
  for (auto strength = strengths.rbegin(); strength != strengths.rend(); ++strength, cell *= 2.0F) {
    const float own = grain.floor + grain.peak * std::min(cell / grain.peak_m, grain.peak_m / cell);
    const float variance = own * own + carried;
    const float seen = visibility(cell, point.footprint);
    *strength = seen >= 1.0F && carried <= 0.0F ? own : seen * std::sqrt(variance);
    carried = 0.25F * (1.0F - seen) * variance;
  }
  Eigen::Vector3f p = tilt(point.position) / kPatches;
  float sum = 0.0F;
  for (const float strength : strengths) {
    if (strength <= 0.0F) break;
    sum += strength * lattice_noise(p, seed);
    seed = seed * 0x9e3779b9U + 1U;
    p = 2.0F * tilt(p);
  }
  return sum;
}

/// Share of a surface that spots of a size cover at a place, a third on average. Where the footprint is larger than a spot, the
/// spots' density still varies: like sum_octaves, with half the contrast for each doubling of the cell.
/// @param raggedness moves the spots' edges in and out, standard deviations of the noise.
float cover_spots(const SurfacePoint& point, float spot, float raggedness, std::uint32_t seed) {
  constexpr float kMeanCover = 0.33F;
  constexpr int kDoublings = 5;
  float cover = kMeanCover;
  float share = 1.0F;
  for (int i = 0; i < kDoublings && share > 0.0F; ++i, spot *= 2.0F) {
    const float seen = visibility(spot, point.footprint);
    if (seen <= 0.0F) continue;
    const float noise = compute_noise(point.position, spot, seed + static_cast<std::uint32_t>(i)) + raggedness;
    const float spots = smooth(0.5F * noise + 0.28F);
    cover += share * seen * (spots - kMeanCover) / static_cast<float>(1 << i);
    share *= 1.0F - seen;
  }
  return cover;
}

/// Two coordinates in the plane that the normal chooses: floors get (x, y), walls one horizontal axis and z.
Eigen::Vector2f flatten(const SurfacePoint& point) {
  const Eigen::Vector3f n = point.normal.cwiseAbs();
  if (n.z() >= n.x() && n.z() >= n.y()) return point.position.head<2>();
  return {n.x() > n.y() ? point.position.y() : point.position.x(), point.position.z()};
}

std::uint32_t hash_cell(float x, float y, std::uint32_t seed) {
  return mix_bits(static_cast<std::uint32_t>(static_cast<int>(x)) * 0x8da6b343U ^
                  static_cast<std::uint32_t>(static_cast<int>(y)) * 0xd8163841U ^ seed);
}

/// The nearest of jittered points, one in each cell of a plane (Worley), with how much nearer it is than the next.
struct Stone {
  std::uint32_t hash;
  float gap;  ///< distance to the next point less that to the nearest, cells
};

Stone find_stone(const Eigen::Vector2f& p, std::uint32_t seed) {
  const float cx = std::floor(p.x());
  const float cy = std::floor(p.y());
  float first = std::numeric_limits<float>::max();
  float second = first;
  Stone stone{0U, 0.0F};
  for (int i = 0; i < 9; ++i) {
    const int dx = i % 3 - 1;
    const int dy = i / 3 - 1;
    const float x = cx + static_cast<float>(dx);
    const float y = cy + static_cast<float>(dy);
    const std::uint32_t hash = hash_cell(x, y, seed);
    const float off_x = x + to_unit(hash) - p.x();
    const float off_y = y + to_unit(hash << 12U) - p.y();
    const float squared = off_x * off_x + off_y * off_y;
    if (squared < first) stone.hash = hash;
    second = std::min(second, std::max(first, squared));
    first = std::min(first, squared);
  }
  stone.gap = std::sqrt(second) - std::sqrt(first);
  return stone;
}

/// Stones of random brightness with dark gaps between them.
Shade shade_gravel(const SurfacePoint& point, float cell, std::uint32_t seed) {
  constexpr Grain kStone{0.003F, 0.10F, 0.04F};
  const float surface = 1.0F + sum_octaves(point, kStone, seed);
  const float seen = visibility(cell, point.footprint);
  if (seen <= 0.0F) return {0.5F, surface};
  const Stone stone = find_stone(flatten(point) / cell, seed);
  // 0.66 is the mean of smooth(gap / 0.3), so that the brightness keeps its mean where stones blur.
  const float lit = 0.35F + 0.65F / 0.66F * smooth(stone.gap / 0.3F) + 0.5F * (to_unit(stone.hash * 0x9e3779b9U) - 0.5F);
  return {0.5F + seen * (to_unit(stone.hash << 7U) - 0.5F), surface * (1.0F + seen * (lit - 1.0F))};
}

/// Fallen leaves: on half of the cells an ellipse of second_color, turned and shaded at random.
Shade shade_leaves(const SurfacePoint& point, float cell, std::uint32_t seed) {
  constexpr Grain kLitter{0.01F, 0.16F, 0.08F};
  Shade shade{0.3F, 1.0F + sum_octaves(point, kLitter, seed)};
  const float seen = visibility(cell, point.footprint);
  if (seen <= 0.0F) return shade;
  const Eigen::Vector2f p = flatten(point) / cell;
  const float cx = std::floor(p.x());
  const float cy = std::floor(p.y());
  float cover = 0.0F;
  std::uint32_t top = 0U;
  for (int i = 0; i < 9; ++i) {
    const int dx = i % 3 - 1;
    const int dy = i / 3 - 1;
    const float x = cx + static_cast<float>(dx);
    const float y = cy + static_cast<float>(dy);
    const std::uint32_t hash = hash_cell(x, y, seed);
    if ((hash & 1U) != 0U || hash < top) continue;
    const Eigen::Vector2f to_center = p - Eigen::Vector2f(x + to_unit(hash), y + to_unit(hash << 12U));
    const Eigen::Vector2f axis = Eigen::Vector2f(to_unit(hash << 5U) - 0.5F, to_unit(hash << 17U) - 0.5F + 1e-3F).normalized();
    const float along = to_center.dot(axis) / 0.55F;
    const float across = (to_center.x() * axis.y() - to_center.y() * axis.x()) / 0.28F;
    const float inside = smooth(4.0F * (1.0F - along * along - across * across));
    if (inside <= 0.0F) continue;
    cover = inside;
    top = hash;
  }
  shade.mix += seen * (cover - shade.mix);
  if (cover > 0.0F) shade.brightness *= 1.0F + seen * 0.7F * (to_unit(top * 0x9e3779b9U) - 0.5F);
  return shade;
}

/// Share of a line of the given width that the footprint covers, centre at the given distance.
float cover_line(float distance, float width, float footprint) {
  const float soft = std::max(footprint, 0.2F * width);
  return std::clamp((0.5F * width - std::abs(distance)) / soft + 0.5F, 0.0F, 1.0F) * std::min(1.0F, width / soft);
}

/// Square slabs with joints of second_color; no two slabs are equally bright.
Shade shade_tiles(const SurfacePoint& point, float cell, std::uint32_t seed) {
  constexpr Grain kSlab{0.003F, 0.07F, 0.03F};
  const float width = std::clamp(0.02F * cell, 0.003F, 0.01F);
  const float mean_cover = 2.0F * width / cell;
  Shade shade{mean_cover, 1.0F + sum_octaves(point, kSlab, seed)};
  const float seen = visibility(cell, point.footprint);
  if (seen <= 0.0F) return shade;
  const Eigen::Vector2f p = flatten(point) / cell;
  const Eigen::Vector2f tile(std::floor(p.x()), std::floor(p.y()));
  const Eigen::Vector2f to_joint = (p - tile - Eigen::Vector2f(0.5F, 0.5F)).cwiseAbs();
  const float distance = (0.5F - to_joint.maxCoeff()) * cell;
  shade.mix += seen * (cover_line(distance, width, point.footprint) - mean_cover);
  shade.brightness *= 1.0F + seen * 0.2F * (to_unit(hash_cell(tile.x(), tile.y(), seed)) - 0.5F);
  return shade;
}

/// Slabs with domes of second_color in a square grid, each with a lit and a shaded flank.
Shade shade_tactile(const SurfacePoint& point, float slab, std::uint32_t seed) {
  constexpr float kDomes = 6.0F;  // along a slab: 50 mm apart on the usual 300 mm
  constexpr Grain kSlab{0.003F, 0.06F, 0.03F};
  constexpr float kRadius = 0.33F;    // cells
  constexpr float kMeanCover = 0.3F;  // about pi kRadius^2, with the soft edge
  Shade shade{kMeanCover, 1.0F + sum_octaves(point, kSlab, seed)};
  const float cell = slab / kDomes;
  const float seen = visibility(cell, point.footprint);
  if (seen <= 0.0F) return shade;
  const Eigen::Vector2f p = flatten(point) / cell;
  const Eigen::Vector2f from_center(p.x() - std::floor(p.x()) - 0.5F, p.y() - std::floor(p.y()) - 0.5F);
  const float cover = smooth((kRadius - from_center.norm()) / 0.1F + 0.5F);
  shade.mix += seen * (cover - kMeanCover);
  shade.brightness *= 1.0F + seen * cover * 0.5F * (from_center.x() + from_center.y()) / kRadius;
  return shade;
}

/// Grain everywhere, and second_color on a third of the surface: stones of the given size.
Shade shade_stones(const SurfacePoint& point, float stone, const Grain& grain, std::uint32_t seed) {
  return {cover_spots(point, stone, 0.0F, seed ^ 0x5bd1e995U), 1.0F + sum_octaves(point, grain, seed)};
}

/// The same with stains, the edges of which follow the grain: dirt sits in the dark hollows.
Shade shade_stains(const SurfacePoint& point, float stain, const Grain& grain, std::uint32_t seed) {
  constexpr float kRaggedness = 3.0F;
  const float uneven = sum_octaves(point, grain, seed);
  return {cover_spots(point, stain, -kRaggedness * uneven, seed ^ 0x5bd1e995U), 1.0F + uneven};
}

/// Stones and grain that are long along x: brushed metal, blades of grass.
Shade shade_streaked(SurfacePoint point, float spot, float stretch, const Grain& grain, std::uint32_t seed) {
  point.position.x() /= stretch;
  return shade_stones(point, spot, grain, seed);
}

Shade compute_shade(const Material& material, const SurfacePoint& point, std::uint32_t seed) {
  const float cell = material.cell_m;
  switch (material.pattern) {
    case Pattern::plain:
      return {0.0F, 1.0F};
    case Pattern::asphalt:
      return shade_stones(point, 0.2F * cell, {0.25F * cell, 0.10F, 0.03F}, seed);
    case Pattern::concrete:
      return shade_stains(point, cell, {0.003F, 0.08F, 0.04F}, seed);
    case Pattern::plaster:
      return shade_stains(point, cell, {0.002F, 0.05F, 0.025F}, seed);
    case Pattern::rubber:
      return shade_stains(point, cell, {0.003F, 0.06F, 0.01F}, seed);
    case Pattern::cloth:
      return shade_stones(point, cell, {0.003F, 0.08F, 0.08F}, seed);
    case Pattern::metal:
      return shade_streaked(point, cell, 12.0F, {0.1F * cell, 0.06F, 0.03F}, seed);
    case Pattern::grass:
      return shade_streaked(point, cell, 1.6F, {0.5F * cell, 0.30F, 0.09F}, seed);
    case Pattern::tiles:
      return shade_tiles(point, cell, seed);
    case Pattern::gravel:
      return shade_gravel(point, cell, seed);
    case Pattern::tactile:
      return shade_tactile(point, cell, seed);
    case Pattern::leaves:
      return shade_leaves(point, cell, seed);
  }
  return {0.0F, 1.0F};
}

}  // namespace

Eigen::Vector3f compute_reflectance(const Material& material, const SurfacePoint& point, std::uint32_t seed) {
  const Shade shade = compute_shade(material, point, mix_bits(seed + 1U));
  const float mix = std::clamp(shade.mix, 0.0F, 1.0F) * material.contrast;
  const float brightness = std::clamp(1.0F + material.contrast * (shade.brightness - 1.0F), 0.1F, 3.0F);
  const Eigen::Vector3f color = (material.color + mix * (material.second_color - material.color)) * brightness;
  return color.cwiseMin(kLargestReflectance).cwiseMax(0.0F);
}

Eigen::Vector3f compute_mean_reflectance(const Material& material) {
  constexpr float kEverything = 1e9F;
  return compute_reflectance(material, {Eigen::Vector3f::Zero(), Eigen::Vector3f::UnitZ(), kEverything}, 0U);
}

}  // namespace brink::sim
