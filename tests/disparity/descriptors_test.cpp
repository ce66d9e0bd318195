#include "disparity/descriptors.hpp"

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "disparity/descriptors_simd.hpp"
#include "disparity/synthetic.hpp"
#include "reference/naive_disparity.hpp"
#include "simd_targets.hpp"

namespace brink {
namespace {

TEST(Descriptors, EmptyPictureHasNone) {
  const DescriptorImage descriptors{cv::Mat1b()};
  EXPECT_EQ(descriptors.width(), 0);
  EXPECT_EQ(descriptors.height(), 0);
}

TEST(Descriptors, OnePixelHasNoTexture) {
  const DescriptorImage descriptors(cv::Mat1b(1, 1, std::uint8_t{200}));
  EXPECT_EQ(compute_texture(descriptors.at(0, 0)), 0);
}

TEST(Descriptors, RampHasItsSlopeInEverySampleAlongIt) {
  cv::Mat1b ramp(9, 11);
  for (int v = 0; v < ramp.rows; ++v) {
    for (int u = 0; u < ramp.cols; ++u) ramp(v, u) = static_cast<std::uint8_t>(4 * u);
  }
  // Sobel: (1 + 2 + 1) * (4 * (u + 1) - 4 * (u - 1)) = 32, / 4 = 8 in each of the 12 horizontal samples.
  const Descriptor descriptor = DescriptorImage(ramp).at(5, 4);
  EXPECT_EQ(descriptor, (Descriptor{136, 136, 136, 136, 136, 136, 136, 136, 136, 136, 136, 136, 128, 128, 128, 128}));
  EXPECT_EQ(compute_texture(descriptor), 96);
}

TEST(Descriptors, OppositeDescriptorsAreFarthestApart) {
  Descriptor black{};
  Descriptor white{};
  white.fill(255);
  EXPECT_EQ(compute_cost(black, black), 0);
  EXPECT_EQ(compute_cost(black, white), 16 * 255);
  EXPECT_EQ(compute_cost(white, black), 16 * 255);
}

TEST(Descriptors, EqualTheDefinitionOnOddSizes) {
  for (const cv::Size size :
       {cv::Size(1, 1), cv::Size(2, 1), cv::Size(3, 5), cv::Size(17, 13), cv::Size(33, 7), cv::Size(79, 4)}) {
    cv::Mat1b image(size);
    cv::RNG(7).fill(image, cv::RNG::UNIFORM, 0, 256);
    test::for_each_target([&] {
      const DescriptorImage descriptors(image);
      DescriptorRow memory;
      ASSERT_EQ(descriptors.width(), size.width);
      ASSERT_EQ(descriptors.height(), size.height);
      for (int v = 0; v < size.height; ++v) {
        std::vector<std::int16_t> texture(static_cast<std::size_t>(size.width));
        const Descriptor* const row = memory.gather(descriptors, v);
        compute_texture_row(descriptors.samples(v), size.width, texture.data());
        for (int u = 0; u < size.width; ++u) {
          ASSERT_EQ(row[u], reference::describe(image, u, v)) << u << "," << v;
          ASSERT_EQ(row[u], descriptors.at(u, v)) << u << "," << v;
          ASSERT_EQ(texture[static_cast<std::size_t>(u)], compute_texture(row[u])) << u << "," << v;
        }
      }
    });
  }
}

TEST(Descriptors, SameMemoryDescribesAnotherPicture) {
  cv::Mat1b image(12, 31);
  cv::RNG(9).fill(image, cv::RNG::UNIFORM, 0, 256);
  DescriptorImage descriptors(make_texture({50, 40}, 1));
  descriptors.assign(image);
  ASSERT_EQ(descriptors.width(), 31);
  ASSERT_EQ(descriptors.height(), 12);
  EXPECT_EQ(descriptors.at(30, 11), reference::describe(image, 30, 11));
}

}  // namespace
}  // namespace brink
