#include "picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>

#include "patterns.hpp"

namespace brink::sim {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr std::uint32_t kNext = 0x9e3779b9U;

/// Where the eye is when a sample is taken.
struct Moment {
  float time;  ///< 0..1 over the shutter
  Eigen::Matrix3f world_from_camera;
  Eigen::Vector3f origin;  ///< m, world
};

Moment make_moment(float time, const Eigen::Isometry3d& world_from_camera, double eye_x) {
  const Eigen::Vector3d origin = world_from_camera * Eigen::Vector3d(eye_x, 0.0, 0.0);
  return {time, world_from_camera.linear().cast<float>(), origin.cast<float>()};
}

/// The ranks of the first numbers of the van der Corput sequence of a base: a permutation that spreads neighbours.
std::vector<float> make_order(int count, int base) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) {
    double value = 0.0;
    double digit = 1.0;
    for (int rest = i; rest > 0; rest /= base) value += (digit /= base) * (rest % base);
    values.push_back(value);
  }
  std::vector<float> ranks;
  ranks.reserve(values.size());
  for (const double value : values) {
    ranks.push_back(
        static_cast<float>(std::count_if(values.begin(), values.end(), [&](double other) { return other < value; })));
  }
  return ranks;
}

/// One sample of a pixel: a ray and what it finds.
struct Sample {
  int column, row;
  std::uint32_t random;
  const Moment* moment;
  Eigen::Vector3f direction;  ///< unit length
  bool hit;
  Place place;
  Eigen::Vector3f to_sun;
  float sun;  ///< share of the sun's disc that is seen
};

class Painter {
 public:
  Painter(const Scene& scene, const Tracer& tracer, const Lighting& lighting, const StereoCamera& camera,
          std::vector<Moment> moments, const SkyLight& sky_light, unsigned seed)
      : scene_(scene),
        tracer_(tracer),
        lighting_(lighting),
        focal_(static_cast<float>(camera.focal)),
        cx_(static_cast<float>(camera.cx)),
        cy_(static_cast<float>(camera.cy)),
        samples_(static_cast<int>(moments.size())),
        row_order_(make_order(samples_, 2)),
        moments_(std::move(moments)),
        sky_light_(sky_light),
        seed_(mix_bits(seed)) {}

  /// Paints a part of a picture, in packets of rays that may hold several pixels or part of one.
  void paint(cv::Mat3f& picture, const cv::Range& rows, const cv::Range& columns) const {
    const int width = columns.size();
    const int count = width * rows.size() * samples_;
    const float share = 1.0F / static_cast<float>(samples_);
    std::array<Sample, kPacket> packet;
    for (int first = 0; first < count; first += kPacket) {
      const int used = std::min(kPacket, count - first);
      for (int i = 0; i < used; ++i) {
        const int pixel = (first + i) / samples_;
        packet[static_cast<std::size_t>(i)] =
            aim(columns.start + pixel % width, rows.start + pixel / width, (first + i) % samples_, picture.cols);
      }
      find_places(packet, used);
      find_sun(packet, used);
      for (int i = 0; i < used; ++i) {
        const Sample& sample = packet[static_cast<std::size_t>(i)];
        const Eigen::Vector3f light = sample.hit ? shade(sample) : lighting_.sky(sample.direction);
        picture(sample.row, sample.column) += share * cv::Vec3f(light.z(), light.y(), light.x());
      }
    }
  }

 private:
  [[nodiscard]] Sample aim(int column, int row, int index, int width) const;
  void find_places(std::array<Sample, kPacket>& packet, int used) const;
  void find_sun(std::array<Sample, kPacket>& packet, int used) const;
  [[nodiscard]] Eigen::Vector3f shade(const Sample& sample) const;
  [[nodiscard]] Eigen::Vector3f add_gloss(const Sample& sample, const Material& material, float footprint,
                                          const Eigen::Vector3f& diffuse) const;

  const Scene& scene_;
  const Tracer& tracer_;
  const Lighting& lighting_;
  float focal_, cx_, cy_;
  int samples_;
  std::vector<float> row_order_;
  std::vector<Moment> moments_;
  const SkyLight& sky_light_;
  std::uint32_t seed_;
};

/// Jittered in as many columns and rows of the pixel as there are samples. Each has its own moment, the same in all pixels:
/// blur of few samples is then a multiple exposure, in which both eyes see the same, instead of noise, in which they do not.
Sample Painter::aim(int column, int row, int index, int width) const {
  Sample sample{};
  sample.column = column;
  sample.row = row;
  sample.random =
      mix_bits(mix_bits(seed_ + static_cast<std::uint32_t>(row * width + column)) + static_cast<std::uint32_t>(index) * kNext);
  const auto i = static_cast<std::size_t>(index);
  const float stratum = 1.0F / static_cast<float>(samples_);
  const float u = static_cast<float>(column) - 0.5F + stratum * (static_cast<float>(index) + to_unit(sample.random)) - cx_;
  const float v = static_cast<float>(row) - 0.5F + stratum * (row_order_[i] + to_unit(sample.random << 12U)) - cy_;
  sample.moment = &moments_[i];
  sample.direction = sample.moment->world_from_camera * Eigen::Vector3f(u, v, focal_).normalized();
  return sample;
}

void Painter::find_places(std::array<Sample, kPacket>& packet, int used) const {
  PacketMask mask;
  RTCRayHit16 rays;
  for (int i = 0; i < kPacket; ++i) {
    const auto lane = static_cast<std::size_t>(i);
    const Sample& sample = packet[i < used ? lane : 0];
    mask.lanes[lane] = i < used ? -1 : 0;
    set_lane(rays.ray, i, sample.moment->origin, sample.direction, sample.moment->time);
    rays.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    rays.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  }
  tracer_.intersect(mask, rays);
  for (int i = 0; i < used; ++i) {
    Sample& sample = packet[static_cast<std::size_t>(i)];
    sample.hit = rays.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
    if (!sample.hit) continue;
    const Eigen::Vector3f normal(rays.hit.Ng_x[i], rays.hit.Ng_y[i], rays.hit.Ng_z[i]);
    sample.place = tracer_.locate(sample.moment->origin, sample.direction, rays.ray.tfar[i], sample.moment->time, normal,
                                  rays.hit.geomID[i], rays.hit.primID[i]);
  }
}

/// One ray to the sun each; where they disagree, in the soft edge of a shadow, a few more.
void Painter::find_sun(std::array<Sample, kPacket>& packet, int used) const {
  constexpr int kMore = 3;
  if (!lighting_.has_sun()) return;
  PacketMask mask;
  RTCRay16 rays;
  int tried = 0;
  for (int i = 0; i < kPacket; ++i) {
    const auto lane = static_cast<std::size_t>(i);
    Sample& sample = packet[i < used ? lane : 0];
    const std::uint32_t random = mix_bits(sample.random + kNext);
    const Eigen::Vector3f to_sun = lighting_.to_sun(to_unit(random), to_unit(random << 12U));
    const bool faces = i < used && sample.hit && sample.place.normal.dot(to_sun) > 0.0F;
    mask.lanes[lane] = faces ? -1 : 0;
    set_lane(rays, i, faces ? lift(sample.place) : sample.moment->origin, to_sun, sample.moment->time);
    if (i < used) sample.to_sun = to_sun;
    tried += faces ? 1 : 0;
  }
  if (tried == 0) return;
  tracer_.occlude(mask, rays);
  int seen = 0;
  for (int i = 0; i < used; ++i) {
    const bool lit = mask.lanes[static_cast<std::size_t>(i)] != 0 && rays.tfar[i] >= 0.0F;
    packet[static_cast<std::size_t>(i)].sun = lit ? 1.0F : 0.0F;
    seen += lit ? 1 : 0;
  }
  if (seen == 0 || seen == tried) return;
  for (int i = 0; i < used; ++i) {
    if (mask.lanes[static_cast<std::size_t>(i)] == 0) continue;
    Sample& sample = packet[static_cast<std::size_t>(i)];
    std::uint32_t random = sample.random;
    for (int more = 0; more < kMore; ++more) {
      random = mix_bits(random + 2U * kNext);
      const Eigen::Vector3f to_sun = lighting_.to_sun(to_unit(random), to_unit(random << 12U));
      sample.sun += tracer_.is_blocked(lift(sample.place), to_sun, sample.moment->time) ? 0.0F : 1.0F;
    }
    sample.sun /= static_cast<float>(1 + kMore);
  }
}

/// Where a ray really meets a surface with relief: what stands h above the triangle is met h / facing earlier, so the pattern
/// is that of another place (first order). Real roads owe their disparity noise to this. Relief far below the footprint is not
/// seen.
Eigen::Vector3f place_on_relief(const Place& place, const Eigen::Vector3f& direction, float facing, const Material& material,
                                float footprint) {
  constexpr float kStones = 0.02F;  // m
  constexpr float kDents = 0.08F;
  constexpr float kUnseen = 8.0F;
  if (material.relief_m <= 0.0F || footprint > kUnseen * material.relief_m) return place.body_position;
  const float height = material.relief_m * std::numbers::sqrt2_v<float> / 2.0F *
                       (compute_noise(place.body_position, kStones, 4U) + compute_noise(place.body_position, kDents, 5U));
  return place.body_position - (direction + facing * place.normal) * (height / facing);
}

Eigen::Vector3f Painter::shade(const Sample& sample) const {
  const Place& place = sample.place;
  const auto material_index = static_cast<std::size_t>(scene_.meshes[place.mesh].material);
  const Material& material = scene_.materials[material_index];
  // A sample stands for its share of the pixel; on a slanted surface that is longer than wide, so the geometric mean.
  const float distance = (place.position - sample.moment->origin).norm();
  const float facing = std::max(0.02F, -place.normal.dot(sample.direction));
  const float footprint = distance / focal_ / std::sqrt(facing * static_cast<float>(samples_));
  const Eigen::Vector3f reflectance = compute_reflectance(
      material, {place_on_relief(place, sample.direction, facing, material, footprint), place.normal, footprint},
      static_cast<std::uint32_t>(material_index));
  Eigen::Vector3f irradiance = sky_light_.irradiance(place, sample.moment->time, sample.random);
  if (sample.sun > 0.0F) irradiance += sample.sun * std::max(0.0F, place.normal.dot(sample.to_sun)) * scene_.light.sun;
  const Eigen::Vector3f diffuse = reflectance.cwiseProduct(irradiance) / kPi;
  return material.gloss > 0.0F ? add_gloss(sample, material, footprint, diffuse) : diffuse;
}

/// Mirrored light, more at grazing angles (Schlick 1994), on a slightly wavy surface (plain ones are
/// flat: glass); the sun as a lobe around its mirror
/// image.
Eigen::Vector3f Painter::add_gloss(const Sample& sample, const Material& material, float footprint,
                                   const Eigen::Vector3f& diffuse) const {
  constexpr float kWave = 0.10F;    // size, m
  constexpr float kSlope = 0.015F;  // standard deviation
  constexpr float kLobe = 129.0F;   // (n + 1) of the lobe cos^n with n = 128, about 7 degrees wide
  const Place& place = sample.place;
  Eigen::Vector3f normal = place.normal;
  if (material.pattern != Pattern::plain && footprint < kWave) {
    const Eigen::Vector3f wave(compute_noise(place.body_position, kWave, 1U), compute_noise(place.body_position, kWave, 2U),
                               compute_noise(place.body_position, kWave, 3U));
    normal = (normal + kSlope * (1.0F - footprint / kWave) * wave).normalized();
  }
  const float facing = std::clamp(-normal.dot(sample.direction), 0.0F, 1.0F);
  Eigen::Vector3f mirrored = sample.direction + 2.0F * facing * normal;
  const float below = mirrored.dot(place.normal);
  if (below < 0.0F) mirrored -= 2.0F * below * place.normal;
  const float away = 1.0F - facing;
  const float fresnel =
      material.gloss + (1.0F - material.gloss) * std::min(1.0F, 4.0F * material.gloss) * away * away * away * away * away;
  Eigen::Vector3f mirror = lighting_.look(lift(place), mirrored.normalized(), sample.moment->time, sample.random);
  if (sample.sun > 0.0F) {
    float lobe = std::max(0.0F, mirrored.dot(sample.to_sun));
    for (int doubling = 0; doubling < 7; ++doubling) lobe *= lobe;
    mirror += scene_.light.sun * (sample.sun * lobe * kLobe / (2.0F * kPi));
  }
  return (1.0F - fresnel) * diffuse + fresnel * mirror;
}

}  // namespace

cv::Mat3f render_picture(const Scene& scene, const Tracer& tracer, const Lighting& lighting, const StereoCamera& camera,
                         const cv::Size& size, const CameraMotion& world_from_camera, double time, int eye,
                         const RenderParams& params, unsigned seed) {
  const double eye_x = eye * camera.baseline;
  std::vector<Moment> moments;
  for (const float rank : make_order(params.samples, 3)) {
    const float share = (rank + 0.5F) / static_cast<float>(params.samples);
    moments.push_back(
        make_moment(share, world_from_camera(time + params.shutter_s * (static_cast<double>(share) - 0.5)), eye_x));
  }
  const Moment middle = make_moment(0.5F, world_from_camera(time), eye_x);
  const SkyLight sky_light(tracer, lighting,
                           {middle.world_from_camera, middle.origin, static_cast<float>(camera.focal),
                            static_cast<float>(camera.cx), static_cast<float>(camera.cy), size.width, size.height},
                           params.sky_rays, seed);
  const Painter painter(scene, tracer, lighting, camera, std::move(moments), sky_light, seed);
  cv::Mat3f picture(size, cv::Vec3f(0.0F, 0.0F, 0.0F));
  // Fixed tiles: packets, and with them every bit of the result, are the same for any number of threads.
  constexpr int kTileRows = 4;
  constexpr int kTileColumns = 64;
  const int tile_rows = (size.height + kTileRows - 1) / kTileRows;
  const int tile_columns = (size.width + kTileColumns - 1) / kTileColumns;
  tbb::parallel_for(0, tile_rows * tile_columns, [&](int tile) {
    const int row = tile / tile_columns * kTileRows;
    const int column = tile % tile_columns * kTileColumns;
    painter.paint(picture, {row, std::min(row + kTileRows, size.height)},
                  {column, std::min(column + kTileColumns, size.width)});
  });
  return picture;
}

}  // namespace brink::sim
