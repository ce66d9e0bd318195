#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <tbb/parallel_for.h>

#include "brink/sim/render.hpp"
#include "patterns.hpp"

namespace brink::sim {
namespace {

void require(bool valid, const char* name, double value, const char* expected) {
  if (!valid) throw std::invalid_argument(fmt::format("sensor.{} = {}, must be {}", name, value, expected));
}

/// The display curve of sRGB (IEC 61966-2-1).
double to_display(double light) { return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1.0 / 2.4) - 0.055; }

/// Light 0..1 in steps fine enough for every 8-bit value: in the dark, where the curve is steepest, a step is 1/20 of a grey
/// value.
constexpr int kCurveSteps = 65536;

const std::vector<std::uint8_t>& display_curve() {
  static const std::vector<std::uint8_t> curve = [] {
    std::vector<std::uint8_t> table(kCurveSteps);
    for (int i = 0; i < kCurveSteps; ++i) {
      table[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(std::lround(255.0 * to_display((i + 0.5) / kCurveSteps)));
    }
    return table;
  }();
  return curve;
}

std::uint8_t to_grey(float light) {
  const auto step = static_cast<int>(std::clamp(light, 0.0F, 1.0F) * static_cast<float>(kCurveSteps));
  return display_curve()[static_cast<std::size_t>(std::min(step, kCurveSteps - 1))];
}

/// Nearly normal, mean 0, variance 1: the sum of four uniform numbers, so never beyond 3.5.
float draw_normal(std::uint32_t random) {
  const std::uint32_t first = mix_bits(random);
  const std::uint32_t second = mix_bits(first + 0x9e3779b9U);
  const auto sum = static_cast<float>((first & 0xffffU) + (first >> 16U) + (second & 0xffffU) + (second >> 16U));
  constexpr float kMean = 2.0F * 65535.0F;
  constexpr float kScale = 1.7320508F / 65536.0F;  // sqrt(12 / 4)
  return (sum - kMean) * kScale;
}

/// The right picture as a camera sees it whose rectification is a little wrong.
cv::Mat3f misalign(const cv::Mat3f& radiance, const SensorParams& params) {
  const cv::Point2f center(0.5F * static_cast<float>(radiance.cols - 1), 0.5F * static_cast<float>(radiance.rows - 1));
  cv::Mat1d transform = cv::getRotationMatrix2D(center, params.rotation_deg, 1.0);
  transform(1, 2) += params.vertical_offset_px;
  cv::Mat3f moved;
  cv::warpAffine(radiance, moved, transform, radiance.size(), cv::INTER_CUBIC, cv::BORDER_REPLICATE);
  return moved;
}

/// Lens, pixel area and colour interpolation: no real camera is sharp to the pixel.
cv::Mat3f blur(const cv::Mat3f& radiance, double blur_px) {
  constexpr int kTaps = 5;
  if (blur_px <= 0.0) return radiance;
  cv::Mat3f blurred;
  cv::GaussianBlur(radiance, blurred, {kTaps, kTaps}, blur_px, blur_px, cv::BORDER_REPLICATE);
  return blurred;
}

}  // namespace

void SensorParams::validate() const {
  require(exposure > 0.0 && exposure <= 100.0, "exposure", exposure, "above 0, to 100");
  require(std::abs(gain_difference) <= 0.5, "gain_difference", gain_difference, "-0.5 to 0.5");
  require(noise >= 0.0 && noise <= 100.0, "noise", noise, "0 to 100");
  require(vignetting >= 0.0 && vignetting <= 1.0, "vignetting", vignetting, "0 to 1");
  require(blur_px >= 0.0 && blur_px <= 1.0, "blur_px", blur_px, "0 to 1 px");
  require(jpeg_quality >= 0 && jpeg_quality <= 100, "jpeg_quality", jpeg_quality, "0 to 100");
  require(std::abs(vertical_offset_px) <= 20.0, "vertical_offset_px", vertical_offset_px, "-20 to 20 px");
  require(std::abs(rotation_deg) <= 5.0, "rotation_deg", rotation_deg, "-5 to 5 degrees");
}

cv::Mat3b expose(const cv::Mat3f& radiance, double gain, int eye, const SensorParams& params, unsigned seed) {
  constexpr double kFullWell = 10000.0;  // electrons of a saturated pixel at base gain
  constexpr double kReadNoise = 3.0;     // electrons
  constexpr double kLongest = 10.0;      // the gain at which the exposure time ends and amplification begins
  params.validate();
  if (!(gain > 0.0) || !std::isfinite(gain)) throw std::invalid_argument(fmt::format("gain = {}, must be above 0", gain));
  if (eye != 0 && eye != 1) throw std::invalid_argument(fmt::format("eye = {}, must be 0 (left) or 1 (right)", eye));
  if (radiance.empty()) return {};
  const bool moved = eye == 1 && (params.vertical_offset_px != 0.0 || params.rotation_deg != 0.0);
  const cv::Mat3f light = blur(moved ? misalign(radiance, params) : radiance, params.blur_px);

  const auto total = static_cast<float>(gain * params.exposure * (eye == 1 ? 1.0 + params.gain_difference : 1.0));
  const auto full = static_cast<float>(kFullWell / std::max(1.0, gain * params.exposure / kLongest));
  const auto read = static_cast<float>(kReadNoise);
  const auto noise = static_cast<float>(params.noise);
  const auto vignetting = static_cast<float>(params.vignetting);
  const float cx = 0.5F * static_cast<float>(light.cols - 1);
  const float cy = 0.5F * static_cast<float>(light.rows - 1);
  const float corner = std::max(1.0F, cx * cx + cy * cy);
  const std::uint32_t stream = mix_bits(2U * seed + static_cast<std::uint32_t>(eye));
  cv::Mat3b picture(light.size());
  tbb::parallel_for(0, light.rows, [&](int row) {
    const float y = static_cast<float>(row) - cy;
    for (int column = 0; column < light.cols; ++column) {
      const float x = static_cast<float>(column) - cx;
      const float factor = total * full * (1.0F - vignetting * (x * x + y * y) / corner);
      const auto pixel = 3U * static_cast<std::uint32_t>(row * light.cols + column);
      for (int channel = 0; channel < 3; ++channel) {
        const float electrons = factor * std::max(0.0F, light(row, column)[channel]);
        const float sigma = noise * std::sqrt(electrons + read * read);
        const float normal = draw_normal(stream + (pixel + static_cast<std::uint32_t>(channel)) * 0x9e3779b1U);
        picture(row, column)[channel] = to_grey((electrons + sigma * normal) / full);
      }
    }
  });
  if (params.jpeg_quality == 0) return picture;
  std::vector<std::uint8_t> file;
  cv::imencode(".jpg", picture, file, {cv::IMWRITE_JPEG_QUALITY, params.jpeg_quality});
  return cv::imdecode(file, cv::IMREAD_COLOR);
}

double compute_auto_gain(const cv::Mat3f& radiance) {
  constexpr double kTarget = 110.0;
  constexpr double kLargestGain = 1e4;
  constexpr int kHalvings = 30;
  if (radiance.empty()) return 1.0;
  // Every fifth pixel of every fifth row tells the mean well enough.
  constexpr int kStep = 5;
  std::vector<cv::Vec3f> sample;
  for (int row = 0; row < radiance.rows; row += kStep) {
    for (int column = 0; column < radiance.cols; column += kStep) sample.push_back(radiance(row, column));
  }
  const auto mean_grey = [&](double gain) {
    const auto factor = static_cast<float>(gain);
    double sum = 0.0;
    for (const cv::Vec3f& light : sample) {
      sum += 0.114 * to_grey(factor * light[0]) + 0.587 * to_grey(factor * light[1]) + 0.299 * to_grey(factor * light[2]);
    }
    return sum / static_cast<double>(sample.size());
  };
  double low = std::log(1.0 / kLargestGain);
  double high = std::log(kLargestGain);
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (mean_grey(std::exp(middle)) < kTarget ? low : high) = middle;
  }
  return std::exp(0.5 * (low + high));
}

}  // namespace brink::sim
