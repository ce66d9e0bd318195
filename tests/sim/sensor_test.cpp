#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>
#include <tbb/global_control.h>

#include "brink/sim/render.hpp"
#include "expect_error.hpp"

namespace brink::sim {
namespace {

/// A sensor that only exposes.
SensorParams make_ideal() {
  SensorParams params;
  params.noise = 0.0;
  params.vignetting = 0.0;
  params.gain_difference = 0.0;
  params.blur_px = 0.0;
  return params;
}

cv::Mat3f make_even(float light, const cv::Size& size = {400, 300}) { return {size, cv::Vec3f::all(light)}; }

cv::Mat3f make_ramp() {
  cv::Mat3f ramp(240, 320);
  for (int row = 0; row < ramp.rows; ++row) {
    for (int column = 0; column < ramp.cols; ++column) {
      ramp(row, column) = cv::Vec3f::all(0.05F + 0.4F * static_cast<float>(column + row) / 560.0F);
    }
  }
  return ramp;
}

double mean_grey(const cv::Mat3b& picture) {
  cv::Mat1b grey;
  cv::cvtColor(picture, grey, cv::COLOR_BGR2GRAY);
  return cv::mean(grey)[0];
}

double deviation_of(const cv::Mat3b& picture) {
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(picture, mean, deviation);
  return deviation[1];
}

bool are_equal(const cv::Mat3b& a, const cv::Mat3b& b) { return cv::norm(a, b, cv::NORM_INF) == 0.0; }

TEST(Expose, DisplayCurveIsThatOfSrgb) {
  // IEC 61966-2-1: 0.18 -> 0.4614 -> 118 of 255; 0.5 -> 188; linear part: 0.002 -> 12.92 x 0.002 x 255 = 6.6.
  const auto grey = [](float light) { return expose(make_even(light, {1, 1}), 1.0, 0, make_ideal(), 1)(0, 0)[1]; };
  EXPECT_EQ(grey(0.0F), 0);
  EXPECT_EQ(grey(0.002F), 7);
  EXPECT_EQ(grey(0.18F), 118);
  EXPECT_EQ(grey(0.5F), 188);
  EXPECT_EQ(grey(1.0F), 255);
  EXPECT_EQ(grey(7.0F), 255);
}

TEST(Expose, AutomaticGainPutsTheMeanAt110) {
  for (const float level : {0.02F, 1.0F, 30.0F}) {
    cv::Mat3f picture = make_ramp();
    picture *= level;
    const cv::Mat3b exposed = expose(picture, compute_auto_gain(picture), 0, make_ideal(), 1);
    EXPECT_NEAR(mean_grey(exposed), 110.0, 1.0) << level;
  }
}

TEST(Expose, NoiseIsUnbiasedAndAsLargeAsPhotonsAndReadNoiseMakeIt) {
  // 0.2 of 10,000 electrons: 2,000, deviation sqrt(2,000 + 3^2) = 44.8 electrons = 0.00448 of full scale. The curve's slope
  // there is 255 x 1.055 / 2.4 x 0.2^(1 / 2.4 - 1) = 286.6 grey values per unit of light: 1.28, and rounding adds 1 / 12 to the
  // variance.
  SensorParams params = make_ideal();
  params.noise = 1.0;
  const cv::Mat3b picture = expose(make_even(0.2F), 1.0, 0, params, 7);
  const double curve = 255.0 * (1.055 * std::pow(0.2, 1.0 / 2.4) - 0.055);
  EXPECT_NEAR(cv::mean(picture)[1], curve, 0.03);
  EXPECT_NEAR(deviation_of(picture), std::sqrt(1.28 * 1.28 + 1.0 / 12.0), 0.04);
}

TEST(Expose, DuskIsNoisierThanDayAtTheSameBrightness) {
  SensorParams params = make_ideal();
  params.noise = 1.0;
  const double day = deviation_of(expose(make_even(0.2F), 1.0, 0, params, 7));
  const double dusk = deviation_of(expose(make_even(0.002F), 100.0, 0, params, 7));
  EXPECT_GT(dusk, 2.5 * day);
  EXPECT_LT(dusk, 5.0 * day);
}

TEST(Expose, BlackStaysNearlyBlackWithNoise) {
  SensorParams params;
  const cv::Mat3b picture = expose(make_even(0.0F), 1.0, 0, params, 3);
  EXPECT_LT(mean_grey(picture), 1.0);
  double highest = 0.0;
  cv::minMaxLoc(picture.reshape(1), nullptr, &highest);
  EXPECT_LE(highest, 5.0);
}

TEST(Expose, NoiseOfTheEyesIsIndependent) {
  SensorParams params = make_ideal();
  params.noise = 1.0;
  const cv::Mat3b left = expose(make_even(0.2F), 1.0, 0, params, 7);
  const cv::Mat3b right = expose(make_even(0.2F), 1.0, 1, params, 7);
  cv::Mat3s difference;
  cv::subtract(left, right, difference, cv::noArray(), CV_16S);
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(difference, mean, deviation);
  EXPECT_NEAR(deviation[1], std::sqrt(2.0) * deviation_of(left), 0.05);
}

TEST(Expose, NoiseOfNeighboursIsIndependent) {
  SensorParams params = make_ideal();
  params.noise = 1.0;
  cv::Mat3f noise;
  expose(make_even(0.2F), 1.0, 0, params, 7).convertTo(noise, CV_32F);
  noise -= cv::mean(noise);
  const double variance = noise.dot(noise);
  for (const cv::Point step : {cv::Point(1, 0), cv::Point(0, 1), cv::Point(4, 0)}) {
    const cv::Rect first(0, 0, noise.cols - step.x, noise.rows - step.y);
    const double covariance = noise(first).clone().dot(noise(first + step).clone());
    EXPECT_LT(std::abs(covariance), 0.01 * variance) << step;
  }
}

TEST(Expose, RightEyeIsBrighterByTheGainDifference) {
  SensorParams params = make_ideal();
  params.gain_difference = 0.1;
  EXPECT_EQ(expose(make_even(0.2F), 1.0, 0, params, 1)(5, 5), expose(make_even(0.2F), 1.0, 0, make_ideal(), 1)(5, 5));
  EXPECT_EQ(expose(make_even(0.2F), 1.0, 1, params, 1)(5, 5), expose(make_even(0.22F), 1.0, 0, make_ideal(), 1)(5, 5));
}

TEST(Expose, VignettingDarkensTheCornersByItsShare) {
  SensorParams params = make_ideal();
  params.vignetting = 0.25;
  const cv::Mat3b picture = expose(make_even(0.2F, {401, 301}), 1.0, 0, params, 1);
  EXPECT_EQ(picture(150, 200)[1], expose(make_even(0.2F, {1, 1}), 1.0, 0, make_ideal(), 1)(0, 0)[1]);
  EXPECT_EQ(picture(0, 0)[1], expose(make_even(0.15F, {1, 1}), 1.0, 0, make_ideal(), 1)(0, 0)[1]);
}

TEST(Expose, MisalignmentMovesTheRightPictureOnly) {
  cv::Mat3f stripes(101, 101, cv::Vec3f::all(0.05F));
  stripes.row(50).setTo(cv::Scalar::all(0.9));
  SensorParams params = make_ideal();
  params.vertical_offset_px = 2.0;
  EXPECT_TRUE(are_equal(expose(stripes, 1.0, 0, params, 1), expose(stripes, 1.0, 0, make_ideal(), 1)));
  const cv::Mat3b moved = expose(stripes, 1.0, 1, params, 1);
  EXPECT_GT(moved(52, 50)[1], 200) << "a positive offset moves the picture down";
  EXPECT_LT(moved(50, 50)[1], 100);
  params.vertical_offset_px = 0.0;
  params.rotation_deg = 2.0;  // counterclockwise: 40 px to the right of the middle goes up by 1.4
  const cv::Mat3b turned = expose(stripes, 1.0, 1, params, 1);
  EXPECT_GT(turned(50, 50)[1], 200);
  EXPECT_GT(turned(49, 90)[1], turned(51, 90)[1]);
}

TEST(Expose, JpegChangesThePictureALittle) {
  SensorParams params;
  const cv::Mat3b raw = expose(make_ramp(), 1.0, 0, params, 1);
  params.jpeg_quality = 80;
  const cv::Mat3b compressed = expose(make_ramp(), 1.0, 0, params, 1);
  EXPECT_FALSE(are_equal(raw, compressed));
  EXPECT_LT(cv::norm(raw, compressed, cv::NORM_L1) / static_cast<double>(3 * raw.total()), 3.0);
}

TEST(Expose, BytesAreEqualForAnyNumberOfThreads) {
  const auto expose_with = [](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return expose(make_ramp(), 1.0, 1, {}, 11);
  };
  EXPECT_TRUE(are_equal(expose_with(1), expose_with(2)));
  EXPECT_FALSE(are_equal(expose_with(1), expose(make_ramp(), 1.0, 1, {}, 12))) << "another seed, another noise";
}

TEST(Expose, EmptyOnePixelAndBlackPicturesWork) {
  EXPECT_TRUE(expose({}, 1.0, 0, {}, 1).empty());
  EXPECT_EQ(expose(make_even(0.2F, {1, 1}), 1.0, 1, {}, 1).size(), cv::Size(1, 1));
  EXPECT_EQ(compute_auto_gain({}), 1.0);
  EXPECT_TRUE(std::isfinite(compute_auto_gain(make_even(0.0F))));
}

TEST(Expose, BadArgumentsThrow) {
  const cv::Mat3f picture = make_even(0.2F, {4, 4});
  const auto message = [&](const SensorParams& params) {
    return brink::test::error_of<std::invalid_argument>([&] { (void)expose(picture, 1.0, 0, params, 1); });
  };
  brink::test::expect_line_with(message({.exposure = 0.0}), "sensor.exposure = 0");
  brink::test::expect_line_with(message({.gain_difference = 0.6}), "sensor.gain_difference = 0.6");
  brink::test::expect_line_with(message({.noise = -1.0}), "sensor.noise = -1");
  brink::test::expect_line_with(message({.vignetting = 1.5}), "sensor.vignetting = 1.5");
  brink::test::expect_line_with(message({.blur_px = 2.0}), "sensor.blur_px = 2");
  brink::test::expect_line_with(message({.jpeg_quality = 101}), "sensor.jpeg_quality = 101");
  brink::test::expect_line_with(message({.vertical_offset_px = 21.0}), "sensor.vertical_offset_px = 21");
  brink::test::expect_line_with(message({.rotation_deg = std::numeric_limits<double>::quiet_NaN()}),
                                "sensor.rotation_deg = nan");
  EXPECT_THROW((void)expose(picture, 0.0, 0, {}, 1), std::invalid_argument);
  EXPECT_THROW((void)expose(picture, 1.0, 2, {}, 1), std::invalid_argument);
}

}  // namespace
}  // namespace brink::sim
