#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "brink/sim/render.hpp"
#include "sim/patterns.hpp"
#include "sim/small_scenes.hpp"
#include "test_data.hpp"

// What surfaces look like: patterns by themselves, and as the renderer shows them.
namespace brink::sim {
namespace {

using test::make_camera;
using test::make_pose;
using test::standing;

Scene make_asphalt() {
  Scene scene;
  scene.materials = {{Pattern::asphalt, {0.10F, 0.10F, 0.10F}, {0.25F, 0.25F, 0.25F}, 0.012F}};
  scene.light.to_sun = Eigen::Vector3f::UnitZ();
  scene.meshes.push_back(test::make_floor(-100.0F, 100.0F, -100.0F, 100.0F, 0.0F));
  return scene;
}

cv::Mat3f render_left(const Scene& scene, const StereoCamera& camera, const cv::Size& size, const Eigen::Isometry3d& pose) {
  return Renderer(scene).render(camera, size, standing(pose), 0.0, 0, {}, 1);
}

constexpr int kBands = 6;

/// Contrast of the nearer ground in octaves: robust deviation of linear light from its surroundings, as a share of them, at 1,
/// 2, 4, ... px.
std::array<double, kBands> measure_bands(const cv::Mat1b& grey) {
  cv::Mat1d light;
  grey.rowRange(grey.rows * 11 / 20, grey.rows).convertTo(light, CV_64F, 1.0 / 255.0);
  light.forEach(
      [](double& value, const int*) { value = value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4); });
  std::array<double, kBands> bands{};
  for (double& band : bands) {
    cv::Mat1d near;
    cv::Mat1d around;
    cv::GaussianBlur(light, near, {0, 0}, 1.0);
    cv::GaussianBlur(light, around, {0, 0}, 4.0);
    std::vector<double> off;
    for (int row = 0; row < light.rows; ++row) {
      for (int column = 0; column < light.cols; ++column) {
        off.push_back(std::abs(light(row, column) - near(row, column)) / std::max(around(row, column), 1e-3));
      }
    }
    const auto middle = off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2);
    std::nth_element(off.begin(), middle, off.end());
    band = 1.4826 * *middle;
    cv::resize(light, light, {}, 0.5, 0.5, cv::INTER_AREA);
  }
  return bands;
}

TEST(Pattern, NoiseHasZeroMeanAndUnitVariance) {
  double sum = 0.0;
  double squares = 0.0;
  constexpr int kCount = 100000;
  for (int i = 0; i < kCount; ++i) {
    const auto x = static_cast<float>(i);
    const double value = compute_noise({0.37F * x, -0.61F * x, 0.23F * x}, 1.0F, 5);
    sum += value;
    squares += value * value;
  }
  EXPECT_NEAR(sum / kCount, 0.0, 0.02);
  EXPECT_NEAR(squares / kCount, 1.0, 0.03);
}

TEST(Pattern, NoiseIsContinuousAcrossTheBordersOfItsCells) {
  for (int i = 0; i < 5000; ++i) {
    const Eigen::Vector3f p(-3.0F + 0.0012F * static_cast<float>(i), 1.1F, -0.4F);
    const Eigen::Vector3f step(1e-3F, 0.0F, 0.0F);
    ASSERT_LT(std::abs(compute_noise(p + step, 1.0F, 9) - compute_noise(p, 1.0F, 9)), 0.02F) << p.transpose();
  }
}

TEST(Pattern, EveryPatternKeepsItsMeanWhenItBlurs) {
  for (int index = static_cast<int>(Pattern::plain); index <= static_cast<int>(Pattern::cloth); ++index) {
    const Material material{static_cast<Pattern>(index), {0.30F, 0.25F, 0.20F}, {0.20F, 0.22F, 0.10F}, 0.05F};
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    constexpr int kSide = 200;
    for (int i = 0; i < kSide * kSide; ++i) {
      const int row = i / kSide;
      const Eigen::Vector3f p(0.0931F * static_cast<float>(i % kSide), 0.0871F * static_cast<float>(row), 0.3F);
      sum += compute_reflectance(material, {p, Eigen::Vector3f::UnitZ(), 1e-4F}, 3).cast<double>();
    }
    const Eigen::Vector3d mean = sum / (kSide * kSide);
    const Eigen::Vector3d far = compute_mean_reflectance(material).cast<double>();
    EXPECT_TRUE(mean.isApprox(far, 0.06)) << "pattern " << index << ": " << mean.transpose() << ", far " << far.transpose();
  }
}

TEST(Pattern, NoContrastIsTheColorAlone) {
  const Material material{Pattern::gravel, {0.30F, 0.25F, 0.20F}, {0.1F, 0.1F, 0.1F}, 0.02F, 0.0F};
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3f p(0.013F * static_cast<float>(i), 0.2F, 0.0F);
    ASSERT_TRUE(compute_reflectance(material, {p, Eigen::Vector3f::UnitZ(), 0.001F}, 0).isApprox(material.color));
  }
}

TEST(Surface, AsphaltHasTheContrastOfARealRoadAtEveryScale) {
  // pothole_a: the same camera over a real road. Every octave within a factor of 1.6.
  BRINK_REQUIRE_DATA(folder, "pothole_a");
  std::array<double, kBands> real{};
  constexpr int kPictures = 8;
  for (int i = 0; i < kPictures; ++i) {
    const auto bands = measure_bands(cv::imread(folder + "/image_2/00000" + std::to_string(i) + ".png", cv::IMREAD_GRAYSCALE));
    for (std::size_t k = 0; k < kBands; ++k) real[k] += bands[k] / kPictures;
  }
  const StereoCamera camera{690.8755, 532.65, 286.65, 0.1194};
  const cv::Mat3f radiance = render_left(make_asphalt(), camera, {1039, 520}, make_pose(0.48, 47.0));
  cv::Mat1b grey;
  cv::cvtColor(expose(radiance, 2.4 * compute_auto_gain(radiance), 0, {}, 1), grey, cv::COLOR_BGR2GRAY);
  const auto ours = measure_bands(grey);
  for (std::size_t k = 0; k < kBands; ++k) {
    EXPECT_GT(ours[k], real[k] / 1.6) << (1 << k) << " px";
    EXPECT_LT(ours[k], real[k] * 1.6) << (1 << k) << " px";
    RecordProperty("contrast_at_" + std::to_string(1 << k) + "_px",
                   std::to_string(ours[k]) + ", real " + std::to_string(real[k]));
  }
}

TEST(Surface, TextureFadesWithDistance) {
  const StereoCamera camera = make_camera(128, 128, 700.0);
  double previous = 1.0;
  for (const double height : {2.0, 6.0, 20.0, 300.0}) {
    const cv::Mat3f picture = render_left(make_asphalt(), camera, {128, 128}, make_pose(height, 90.0));
    cv::Mat1f green;
    cv::extractChannel(picture, green, 1);
    cv::Mat1f smooth;
    cv::GaussianBlur(green, smooth, {0, 0}, 2.0);
    cv::Scalar mean;
    cv::Scalar deviation;
    cv::meanStdDev(green - smooth, mean, deviation);
    const double contrast = deviation[0] / cv::mean(green)[0];
    EXPECT_LT(contrast, 0.9 * previous) << "from " << height << " m";
    EXPECT_NEAR(cv::mean(green)[0], 0.15, 0.03) << "the mean stays, from " << height << " m";
    previous = contrast;
  }
}

TEST(Surface, FarGroundDoesNotShimmer) {
  // The same ground, the camera moved sideways by half a pixel: what is left after moving the picture back is a small part of
  // the texture there is.
  const Scene scene = make_asphalt();
  const StereoCamera camera = make_camera(256, 256, 700.0);
  const Eigen::Isometry3d pose = make_pose(20.0, 90.0);
  Eigen::Isometry3d moved = pose;
  moved.translation() += pose.linear() * Eigen::Vector3d(0.5 * 20.0 / 700.0, 0.0, 0.0);
  const cv::Mat3f a = render_left(scene, camera, {256, 256}, pose);
  const cv::Mat3f b = render_left(scene, camera, {256, 256}, moved);
  // Half a pixel on both: a moved right by 1/4 and b moved left by 1/4 see the same.
  const auto shift = [](const cv::Mat3f& picture, double pixels) {
    const cv::Mat1d transform = (cv::Mat1d(2, 3) << 1, 0, pixels, 0, 1, 0);
    cv::Mat3f result;
    cv::warpAffine(picture, result, transform, picture.size(), cv::INTER_CUBIC, cv::BORDER_REPLICATE);
    return cv::Mat3f(result(cv::Rect(8, 8, 240, 240)));
  };
  const cv::Mat3f left = shift(a, -0.25);
  cv::Mat3f difference;
  cv::subtract(left, shift(b, 0.25), difference);
  cv::Scalar mean;
  cv::Scalar texture;
  cv::Scalar shimmer;
  cv::meanStdDev(left, mean, texture);
  cv::meanStdDev(difference, mean, shimmer);
  EXPECT_GT(texture[1], 0.002);
  EXPECT_LT(shimmer[1], 0.35 * texture[1]);
}

TEST(Surface, BothEyesSeeTheSameSurface) {
  // A wall straight ahead at 2 m with a disparity of 16 px: the right picture is the left one moved by 16 px.
  Scene scene = make_asphalt();
  scene.meshes = {test::make_quad({2.0F, -5.0F, -5.0F}, {0, 10, 0}, {0, 0, 10})};
  StereoCamera camera = make_camera(200, 100, 400.0);
  camera.baseline = 16.0 * 2.0 / 400.0;
  Renderer renderer(scene);
  const CameraMotion pose = standing(make_pose(0.0, 0.0));
  const RenderParams params{.samples = 16};
  const cv::Mat3f left = renderer.render(camera, {200, 100}, pose, 0.0, 0, params, 1);
  const cv::Mat3f right = renderer.render(camera, {200, 100}, pose, 0.0, 1, params, 2);
  const cv::Rect inside(20, 0, 160, 100);
  cv::Scalar mean;
  cv::Scalar texture;
  cv::Scalar difference;
  cv::meanStdDev(left(inside), mean, texture);
  cv::meanStdDev(left(inside) - right(inside - cv::Point(16, 0)), mean, difference);
  EXPECT_LT(difference[1], 0.2 * texture[1]);
}

TEST(Surface, TextureMovesWithItsBody) {
  Scene scene = make_asphalt();
  scene.bodies = {{{0.0F, 0.4F, 0.0F}}};
  scene.meshes = {test::make_quad({2.0F, -5.0F, -5.0F}, {0, 10, 0}, {0, 0, 10})};
  scene.meshes[0].body = 0;
  const StereoCamera camera = make_camera(200, 100, 400.0);
  Renderer renderer(scene);
  const CameraMotion pose = standing(make_pose(0.0, 0.0));
  const RenderParams params{.samples = 16};
  const cv::Mat3f before = renderer.render(camera, {200, 100}, pose, 0.0, 0, params, 1);
  const cv::Mat3f after = renderer.render(camera, {200, 100}, pose, 0.25, 0, params, 2);  // 0.1 m = 20 px to the left
  const cv::Rect inside(30, 0, 160, 100);
  cv::Scalar mean;
  cv::Scalar texture;
  cv::Scalar difference;
  cv::meanStdDev(before(inside), mean, texture);
  cv::meanStdDev(before(inside) - after(inside - cv::Point(20, 0)), mean, difference);
  EXPECT_LT(difference[1], 0.2 * texture[1]);
}

}  // namespace
}  // namespace brink::sim
