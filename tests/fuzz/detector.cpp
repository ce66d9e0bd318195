// The whole of section III.C on odd sizes, cameras, pictures and parameters, several frames through one detector.
#include "brink/detector.hpp"

#include <array>
#include <cmath>
#include <limits>

#include <fuzzer/FuzzedDataProvider.h>
#include <tbb/global_control.h>

#include "brink/detections.hpp"
#include "brink/parameters.hpp"
#include "input_files.hpp"

namespace {

using brink::Frame;

/// A picture from few bytes: one grey, noise of a seed, stripes, or the bytes themselves over and over.
cv::Mat1b make_picture(FuzzedDataProvider& bytes, cv::Size size) {
  cv::Mat1b picture(size, bytes.ConsumeIntegral<std::uint8_t>());
  switch (bytes.ConsumeIntegralInRange(0, 3)) {
    case 0:
      break;
    case 1: {
      cv::RNG random(bytes.ConsumeIntegral<std::uint32_t>());
      random.fill(picture, cv::RNG::UNIFORM, 0, bytes.ConsumeIntegralInRange(1, 256));
      break;
    }
    case 2: {
      const int period = bytes.ConsumeIntegralInRange(1, 40);
      const int slant = bytes.ConsumeIntegralInRange(-3, 3);
      for (int v = 0; v < size.height; ++v) {
        for (int u = 0; u < size.width; ++u)
          picture(v, u) = cv::saturate_cast<uchar>(255 * (std::abs(u + slant * v) / period % 2));
      }
      break;
    }
    default: {
      const std::vector<std::uint8_t> values =
          bytes.ConsumeBytes<std::uint8_t>(bytes.ConsumeIntegralInRange<std::size_t>(1, 200));
      if (values.empty()) break;
      for (std::size_t i = 0; i < picture.total(); ++i) picture.data[i] = values[i % values.size()];
    }
  }
  return picture;
}

/// A disparity image from few bytes: the slope of a ground, one disparity, or odd numbers over and over.
cv::Mat1f make_disparity(FuzzedDataProvider& bytes, cv::Size size) {
  constexpr std::array kOdd = {0.0F,
                               -1.0F,
                               1e-30F,
                               0.01F,
                               0.5F,
                               30.0F,
                               31.0F,
                               60.0F,
                               1e4F,
                               3e38F,
                               std::numeric_limits<float>::infinity(),
                               std::numeric_limits<float>::quiet_NaN()};
  const float slope = bytes.ConsumeFloatingPointInRange(-0.5F, 1.5F);
  const float offset = bytes.ConsumeFloatingPointInRange(-20.0F, 80.0F);
  cv::Mat1f disparity(size);
  for (int v = 0; v < size.height; ++v) disparity.row(v) = offset + slope * static_cast<float>(v);
  for (int patches = bytes.ConsumeIntegralInRange(0, 3); patches > 0; --patches) {
    const cv::Rect patch(bytes.ConsumeIntegralInRange(0, 150), bytes.ConsumeIntegralInRange(0, 110),
                         bytes.ConsumeIntegralInRange(1, 160), bytes.ConsumeIntegralInRange(1, 120));
    disparity(patch & cv::Rect(cv::Point(), size)) = kOdd[bytes.ConsumeIntegralInRange<std::size_t>(0, kOdd.size() - 1)];
  }
  return disparity;
}

/// The right picture: another one, or the left one moved by a disparity that grows downwards, as the ground's does.
cv::Mat1b make_right(FuzzedDataProvider& bytes, const cv::Mat1b& left) {
  if (bytes.ConsumeBool()) return make_picture(bytes, left.size());
  const double slope = bytes.ConsumeFloatingPointInRange(-0.5, 1.5);
  const int offset = bytes.ConsumeIntegralInRange(-20, 80);
  cv::Mat1b right(left.size(), uchar{0});
  for (int v = 0; v < left.rows; ++v) {
    const int disparity = offset + static_cast<int>(slope * v);
    for (int u = 0; u < left.cols; ++u) right(v, u) = left(v, std::clamp(u + disparity, 0, left.cols - 1));
  }
  return right;
}

brink::DetectorParams make_params(FuzzedDataProvider& bytes) {
  using namespace brink;
  DetectorParams params = bytes.ConsumeBool() ? DetectorParams::brink() : DetectorParams::paper();
  params.stills = bytes.ConsumeBool();
  params.disparity.matcher =
      std::array{Matcher::elas, Matcher::elas, Matcher::elas, Matcher::bm, Matcher::sgbm, Matcher::sgbm_wls}
          [bytes.ConsumeIntegralInRange<std::size_t>(0, 5)];
  if (bytes.ConsumeIntegralInRange(0, 3) == 0) params.disparity.elas = ElasParams::middlebury();
  const std::vector<Parameter> known = list_parameters(params);
  constexpr std::array kValues = {"0", "1", "-1", "2", "0.5", "3", "7", "16", "33", "100", "255", "1000", "true", "false"};
  for (int changes = bytes.ConsumeIntegralInRange(0, 3); changes > 0; --changes) {
    const Parameter& changed = known[bytes.ConsumeIntegralInRange<std::size_t>(0, known.size() - 1)];
    const char* value = kValues[bytes.ConsumeIntegralInRange<std::size_t>(0, kValues.size() - 1)];
    params = fuzz::result_of([&] { return with_settings(params, {{changed.key, value}}); }).value_or(params);
  }
  return params;
}

std::optional<Frame> make_frame(FuzzedDataProvider& bytes, cv::Size size, const brink::StereoCamera& camera, int index,
                                double time) {
  const cv::Mat1b left = make_picture(bytes, size);
  auto frame = brink::fuzz::result_of([&] {
    if (bytes.ConsumeIntegralInRange(0, 3) > 0) return brink::make_frame(left, make_right(bytes, left), camera, index, time);
    const cv::Mat1b picture = bytes.ConsumeBool() ? left : cv::Mat1b();
    return brink::make_frame_with_disparity(picture, make_disparity(bytes, size), camera, index, time);
  });
  if (!frame) return frame;
  const bool colored = bytes.ConsumeIntegralInRange(0, 3) == 0;
  if (colored && !frame->left.empty()) frame->left_color = cv::Mat3b(size, cv::Vec3b(left(0, 0), 0, 255));
  if (bytes.ConsumeIntegralInRange(0, 3) == 0) {
    frame->gravity = Eigen::Vector3d(bytes.ConsumeFloatingPointInRange(-1.0, 1.0), 1.0, 0.3).normalized();
    const double turn = bytes.ConsumeFloatingPointInRange(-0.3, 0.3);
    frame->current_from_previous_rotation = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitY()).toRotationMatrix();
  }
  if (bytes.ConsumeIntegralInRange(0, 3) == 0) {
    frame->world_from_camera = Eigen::Translation3d(0.0, 0.0, 0.1 * index) * Eigen::Isometry3d::Identity();
  }
  return frame;
}

void check(const brink::Detection& detection) {
  using namespace brink;
  for (const float disparity : detection.disparity) {
    fuzz::require(disparity == kInvalidDisparity || (disparity >= 0.0F && std::isfinite(disparity)), "disparity out of range");
  }
  const std::string path = fuzz::put("detection.jsonl", to_json_line(detection));
  const std::vector<Detection> again = read_detections(path);  // throws for a number that is none
  fuzz::require(again.size() == 1 && again[0].obstacles.size() == detection.obstacles.size(), "a line that loses something");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace brink;
  static const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  FuzzedDataProvider bytes(data, size);
  const DetectorParams params = make_params(bytes);
  std::optional<Detector> detector;
  if (!fuzz::result_of([&] { return detector.emplace(params), true; })) return 0;
  cv::Size picture_size(bytes.ConsumeIntegralInRange(32, 160), bytes.ConsumeIntegralInRange(32, 120));
  const StereoCamera camera{bytes.ConsumeFloatingPointInRange(1.0, 2000.0), bytes.ConsumeFloatingPointInRange(-100.0, 300.0),
                            bytes.ConsumeFloatingPointInRange(-100.0, 300.0), bytes.ConsumeFloatingPointInRange(0.001, 2.0)};
  double time = 0.0;
  for (int index = 0; index < 4 && bytes.remaining_bytes() > 0; ++index) {
    time += bytes.ConsumeFloatingPointInRange(1e-6, 2.0);
    const int what = bytes.ConsumeIntegralInRange(0, 7);
    if (what == 0) {
      check(detector->process_failed(index, time, FrameStatus::no_picture, "fuzzed"));
      continue;
    }
    if (what == 1) picture_size = {bytes.ConsumeIntegralInRange(32, 160), bytes.ConsumeIntegralInRange(32, 120)};
    if (const auto frame = make_frame(bytes, picture_size, camera, index, time)) check(detector->process(*frame));
  }
  return 0;
}
