#include "ground/v_disparity.hpp"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "reference/ground_equations.hpp"
#include "reference/v_disparity.hpp"
#include "simd_targets.hpp"

namespace brink {
namespace {

constexpr double kRelative = 0.02;
constexpr double kPixels = 0.75;

/// A ground of disparity 0.1 v, and noise.
std::vector<DisparitySample> make_samples(cv::RNG& random) {
  std::vector<DisparitySample> samples;
  for (int v = 1; v < 180; v += 3) {
    for (int u = -150; u < 150; u += 7) {
      const float noise = random.uniform(0, 3) == 0 ? random.uniform(1.0F, 60.0F) : random.uniform(-0.5F, 0.5F);
      const float d = 0.1F * static_cast<float>(v) + noise;
      if (d > 0.0F) samples.push_back({static_cast<float>(u) + 0.3F, static_cast<float>(v), d});
    }
  }
  return samples;
}

TEST(VDisparity, SupportEqualsItsTwinOnEveryTarget) {
  cv::RNG random(7);
  const std::vector<DisparitySample> samples = make_samples(random);
  for (const double tan_roll : {-0.4, 0.0, 0.1}) {
    const reference::NaiveVDisparity naive(samples, tan_roll, 180);
    VDisparity histogram{BinnedSamples(samples), tan_roll, 180};
    for (int i = 0; i < 30; ++i) {
      const double slope = i == 0 ? 0.1 : random.uniform(-0.1, 0.4);
      const double offset = i == 0 ? 0.0 : random.uniform(-30.0, 30.0);
      const double expected = naive.support(slope, offset, kRelative, kPixels);
      test::for_each_target([&] { EXPECT_EQ(histogram.support(slope, offset, kRelative, kPixels, 0.0), expected); });
    }
  }
}

TEST(VDisparity, LinesOfLessSupportThanAskedForAreNotCountedOut) {
  cv::RNG random(8);
  const std::vector<DisparitySample> samples = make_samples(random);
  const reference::NaiveVDisparity naive(samples, 0.1, 180);
  VDisparity histogram{BinnedSamples(samples), 0.1, 180};
  const double ground = naive.support(0.1, 0.0, kRelative, kPixels);
  EXPECT_EQ(histogram.support(0.1, 0.0, kRelative, kPixels, ground), ground) << "as much is enough";
  for (int i = 0; i < 30; ++i) {
    const double offset = 0.5 * i;
    const double expected = naive.support(0.1, offset, kRelative, kPixels);
    const std::optional<double> support = histogram.support(0.1, offset, kRelative, kPixels, ground);
    EXPECT_TRUE(support ? *support == expected : expected < ground) << offset;
  }
  EXPECT_FALSE(histogram.support(0.1, 0.0, kRelative, kPixels, 2.0 * ground));
}

TEST(NormalEquations, EqualTheirTwinOnEveryTarget) {
  cv::RNG random(9);
  std::vector<DisparitySample> samples = make_samples(random);
  for (int i = 0; i < 9; ++i) {
    for (const GroundPlane& plane :
         {GroundPlane{0.0, 0.1, 0.0}, GroundPlane{0.001, 0.11, -0.5}, GroundPlane{0.0, 1e-3, -10.0}}) {
      for (const double widen : {1.0, 3.0}) {
        const SampleBand band{kRelative, kPixels, widen};
        const NormalEquations expected = reference::naive_normal_equations(samples, 150.4, plane, band);
        test::for_each_target([&] { EXPECT_EQ(add_up_normal_equations(samples, 150.4, plane, band), expected); });
      }
    }
    samples.pop_back();
  }
  EXPECT_EQ(add_up_normal_equations({}, 150.4, {}, {kRelative, kPixels, 1.0}), NormalEquations{});
}

}  // namespace
}  // namespace brink
