#include "ego_motion/features_simd.hpp"

#include <array>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "reference/features.hpp"
#include "simd_targets.hpp"

namespace brink {
namespace {

TEST(FilterRow, EqualsThePlainTwinOnEveryTarget) {
  cv::RNG random(3);
  for (const int width : {1, 3, 15, 16, 17, 61, 130}) {
    cv::Mat1b picture(9, width + 2 * kFilterRadius);
    random.fill(picture, cv::RNG::UNIFORM, 0, 256);
    picture(cv::Rect(0, 0, picture.cols / 2, 9)).setTo(random.uniform(0, 2) * 255);  // steps of full height
    test::for_each_target([&] {
      for (int v = 2; v < 7; ++v) {
        const auto size = static_cast<std::size_t>(width);
        std::vector<std::int16_t> scratch(filter_scratch(width));
        std::vector<std::int16_t> blobs(size);
        std::vector<std::int16_t> corners(size);
        std::vector<std::uint16_t> gradients(size);
        filter_row({picture[v - 2], picture[v - 1], picture[v], picture[v + 1], picture[v + 2]}, width, scratch.data(),
                   {blobs.data(), corners.data(), gradients.data()});
        for (std::size_t u = 0; u < size; ++u) {
          const auto expected = reference::naive_filters(picture, {static_cast<int>(u) + kFilterRadius, v});
          EXPECT_EQ(blobs[u], expected.blob) << width << " " << u;
          EXPECT_EQ(corners[u], expected.corner) << width << " " << u;
          EXPECT_EQ(gradients[u], expected.gradient_u + 256 * expected.gradient_v) << width << " " << u;
        }
      }
    });
  }
}

TEST(FindRowExtrema, EqualsThePlainTwinOnEveryTarget) {
  cv::RNG random(4);
  for (const int radius : {1, 3, 20}) {
    for (const int width : {2 * radius + 1, 2 * radius + 18, 2 * radius + 70}) {
      cv::Mat1s response(2 * radius + 3, width);
      random.fill(response, cv::RNG::UNIFORM, -32, 32);  // so few values that many neighbours are equal
      for (const int begin : {radius, radius + 5}) {
        const int end = width - radius;
        if (begin >= end) continue;
        test::for_each_target([&] {
          std::size_t found = 0;
          for (int v = radius; v < response.rows - radius; ++v) {
            std::vector<const std::int16_t*> rows;
            for (int y = v - radius; y <= v + radius; ++y) rows.push_back(response[y]);
            std::vector<std::int16_t> scratch(extrema_scratch(begin, end, radius));
            std::vector<std::int32_t> columns(static_cast<std::size_t>(end - begin) + kSpareColumns);
            columns.resize(find_row_extrema(rows.data(), radius, begin, end, 30, scratch.data(), columns.data()));
            std::vector<std::int32_t> expected;
            for (int u = begin; u < end; ++u) {
              if (reference::naive_is_extremum(response, {u, v}, radius, 30)) expected.push_back(u);
            }
            EXPECT_EQ(columns, expected) << radius << " " << width << " " << begin;
            found += expected.size();
          }
          EXPECT_TRUE(found > 0 || width < 2 * radius + 70);
        });
      }
    }
  }
}

}  // namespace
}  // namespace brink
