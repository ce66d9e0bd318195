#include "ego_motion/features.hpp"

#include <algorithm>
#include <set>
#include <tuple>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "reference/features.hpp"

namespace brink {
namespace {

EgoMotionParams all_features() {
  EgoMotionParams params;
  params.features_per_bucket = 10000;
  return params;
}

cv::Mat1b make_random_picture(const cv::Size& size) {
  cv::Mat1b picture(size);
  cv::RNG random(7);
  random.fill(picture, cv::RNG::UNIFORM, 0, 256);
  return picture;
}

/// The response of one of the 5x5 filters.
int naive_response(const cv::Mat1b& picture, int u, int v, bool blob) {
  const auto filtered = reference::naive_filters(picture, {u, v});
  return blob ? filtered.blob : filtered.corner;
}

TEST(FindFeatures, FindsNoneWithoutTextureAndInPicturesThatAreTooSmall) {
  EXPECT_TRUE(find_features(cv::Mat1b(200, 300, uchar{90}), {}).empty());
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(3, 1), cv::Size(5, 200), cv::Size(17, 17)}) {
    EXPECT_TRUE(find_features(make_random_picture(size), {}).empty()) << size;
  }
}

TEST(FindFeatures, FindsAWhiteDotAndACheckerCornerWhereTheyAre) {
  cv::Mat1b picture(61, 75, uchar{50});
  picture(20, 30) = 250;
  picture(cv::Rect(50, 40, 10, 10)) = 200;
  picture(cv::Rect(40, 30, 10, 10)) = 200;  // meets the other one at the corner (50, 40)
  const auto features = find_features(picture, all_features());
  const auto has = [&](FeatureClass kind, float u, float v, float tolerance) {
    return std::ranges::any_of(features, [&](const Feature& feature) {
      return feature.kind == kind && std::abs(feature.position.x - u) <= tolerance &&
             std::abs(feature.position.y - v) <= tolerance;
    });
  };
  EXPECT_TRUE(has(FeatureClass::blob_maximum, 30.0F, 20.0F, 0.0F));
  EXPECT_TRUE(has(FeatureClass::corner_maximum, 49.5F, 39.5F, 0.5F));
}

TEST(FindFeatures, FindsEveryExtremumThatTheNaiveSearchFinds) {
  const cv::Mat1b picture = make_random_picture({83, 67});
  EgoMotionParams params = all_features();
  std::set<std::tuple<int, int, FeatureClass>> found;
  for (const Feature& feature : find_features(picture, params)) {
    found.emplace(static_cast<int>(feature.position.x), static_cast<int>(feature.position.y), feature.kind);
  }
  const int radius = params.feature_radius_px;
  int expected = 0;
  // Away from the border, where the last block need not be whole.
  for (int v = 8; v < picture.rows - 12; ++v) {
    for (int u = 8; u < picture.cols - 12; ++u) {
      for (const bool blob : {true, false}) {
        const int value = naive_response(picture, u, v, blob);
        bool greatest = value >= params.min_response;
        for (int y = v - radius; y <= v + radius; ++y) {
          for (int x = u - radius; x <= u + radius; ++x) {
            greatest = greatest && ((x == u && y == v) || naive_response(picture, x, y, blob) < value);
          }
        }
        const FeatureClass kind = blob ? FeatureClass::blob_maximum : FeatureClass::corner_maximum;
        EXPECT_FALSE(greatest && !found.contains({u, v, kind})) << u << " " << v << " blob " << blob;
        expected += greatest ? 1 : 0;
      }
    }
  }
  EXPECT_GT(expected, 50);
}

TEST(FindFeatures, TakesTheFirstOfEqualValuesOfABlock) {
  cv::Mat1b picture = make_random_picture({83, 67});
  for (uchar& level : picture) level = level < 128 ? 0 : 30;  // so few levels that many responses are equal
  const EgoMotionParams params = all_features();
  std::set<std::tuple<int, int, FeatureClass>> found;
  for (const Feature& feature : find_features(picture, params)) {
    found.emplace(static_cast<int>(feature.position.x), static_cast<int>(feature.position.y), feature.kind);
  }
  std::set<std::tuple<int, int, FeatureClass>> expected;
  const int radius = params.feature_radius_px;
  const int side = radius + 1;
  const auto search_block = [&](int left, int top, bool blob, int sign, FeatureClass kind) {
    const auto strength = [&](int u, int v) { return sign * naive_response(picture, u, v, blob); };
    cv::Point best(left, top);
    for (int v = top; v < top + side; ++v) {
      for (int u = left; u < left + side; ++u) {
        if (strength(u, v) > strength(best.x, best.y)) best = {u, v};
      }
    }
    for (int v = best.y - radius; v <= best.y + radius; ++v) {
      for (int u = best.x - radius; u <= best.x + radius; ++u) {
        if (strength(u, v) > strength(best.x, best.y)) return;
      }
    }
    if (strength(best.x, best.y) >= params.min_response) expected.emplace(best.x, best.y, kind);
  };
  for (int top = 8; top + side + 8 <= picture.rows; top += side) {
    for (int left = 8; left + side + 8 <= picture.cols; left += side) {
      search_block(left, top, true, -1, FeatureClass::blob_minimum);
      search_block(left, top, true, 1, FeatureClass::blob_maximum);
      search_block(left, top, false, -1, FeatureClass::corner_minimum);
      search_block(left, top, false, 1, FeatureClass::corner_maximum);
    }
  }
  EXPECT_EQ(found, expected);
  EXPECT_GT(expected.size(), 50U);
}

TEST(FindFeatures, KeepsTheStrongestOfEachBucketOnly) {
  const cv::Mat1b picture = make_random_picture({160, 120});
  EgoMotionParams params;
  params.feature_bucket_px = 40;
  params.features_per_bucket = 3;
  const auto features = find_features(picture, params);
  EXPECT_EQ(features.size(), 3U * 4U * 3U);
  const auto all = find_features(picture, all_features());
  for (const Feature& kept : features) {
    const auto same_bucket = [&kept](const Feature& other) {
      return static_cast<int>(other.position.x) / 40 == static_cast<int>(kept.position.x) / 40 &&
             static_cast<int>(other.position.y) / 40 == static_cast<int>(kept.position.y) / 40;
    };
    const auto stronger =
        std::ranges::count_if(all, [&](const Feature& other) { return same_bucket(other) && other.strength > kept.strength; });
    EXPECT_LT(stronger, 3);
  }
}

TEST(FindFeatures, TellsPlacesInTheFullPictureWhenItSearchesTheHalvedOne) {
  cv::Mat1b picture(80, 100, uchar{50});
  picture(cv::Rect(40, 30, 2, 2)) = 250;  // one pixel of the halved picture; its centre is (40.5, 30.5)
  EgoMotionParams params;
  params.half_resolution_from_px = 1000;
  const auto features = find_features(picture, params);
  ASSERT_FALSE(features.empty());
  const auto strongest = std::ranges::max_element(features, {}, &Feature::strength);
  EXPECT_EQ(strongest->position, cv::Point2f(40.5F, 30.5F));
}

TEST(ComputeCost, IsTheSumOfAbsoluteDifferences) {
  FeatureDescriptor a{};
  FeatureDescriptor b{};
  EXPECT_EQ(compute_cost(a, b), 0);
  a.fill(255);
  EXPECT_EQ(compute_cost(a, b), 32 * 255);
  b[3] = 250;
  EXPECT_EQ(compute_cost(a, b), 31 * 255 + 5);
}

}  // namespace
}  // namespace brink
