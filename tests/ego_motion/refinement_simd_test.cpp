#include "ego_motion/refinement_simd.hpp"

#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "reference/refinement.hpp"
#include "simd_targets.hpp"

namespace brink {
namespace {

/// Not wider in memory than it is, so that a check of addresses sees what is read beyond it.
cv::Mat1b make_random_picture(const cv::Size& size, int seed) {
  cv::Mat1b picture(size);
  cv::RNG random(static_cast<std::uint64_t>(seed));
  random.fill(picture, cv::RNG::UNIFORM, 0, 256);
  return picture;
}

TEST(ComparePatches, EqualsThePlainTwinOnEveryTarget) {
  cv::RNG random(6);
  const auto any = [&random](double least, double most) { return static_cast<float>(random.uniform(least, most)); };
  for (const cv::Size size : {cv::Size(2, 2), cv::Size(13, 12), cv::Size(75, 61)}) {
    const cv::Mat1b picture = make_random_picture(size, 1);
    std::array<PatchPixels, kPatchPixels> patches;
    PatchPlaces places;
    for (std::size_t lane = 0; lane < kPatchLanes; ++lane) {
      for (PatchPixels& pixel : patches) {
        pixel.level[lane] = any(-100, 100);
        pixel.gradient_u[lane] = any(-50, 50);
        pixel.gradient_v[lane] = any(-50, 50);
      }
      places.u[lane] = any(-2, size.width + 2);  // also beyond the border, where the last pixels go on
      places.v[lane] = any(-2, size.height + 2);
      places.u_by_x[lane] = any(0.7, 1.3);
      places.u_by_y[lane] = any(-0.3, 0.3);
      places.v_by_x[lane] = any(-0.3, 0.3);
      places.v_by_y[lane] = any(0.7, 1.3);
    }
    const PatchComparison expected = reference::naive_comparison(patches, places, picture);
    test::for_each_target([&] {
      const auto stride = static_cast<int>(picture.step1());
      const PatchComparison comparison =
          compare_patches(patches.data(), places, {picture.data, size.width, size.height, stride});
      EXPECT_EQ(comparison.gradient_u, expected.gradient_u) << size;
      EXPECT_EQ(comparison.gradient_v, expected.gradient_v) << size;
      EXPECT_EQ(comparison.squares, expected.squares) << size;
      EXPECT_EQ(comparison.correlation, expected.correlation) << size;
      EXPECT_EQ(comparison.contrast, expected.contrast) << size;
    });
  }
}

TEST(AlignPatches, EqualsThePlainTwinOnEveryTarget) {
  cv::Mat1b picture;
  cv::GaussianBlur(make_random_picture({160, 120}, 2), picture, {9, 9}, 2.5);
  cv::normalize(picture, picture, 0, 255, cv::NORM_MINMAX);
  cv::RNG random(8);
  std::vector<Patch> patches;
  for (int v = 0; v < picture.rows; v += 7) {
    for (int u = 0; u < picture.cols; u += 7) {
      if (const auto patch = make_patch(picture, {u, v})) patches.push_back(*patch);
    }
  }
  std::vector<PatchSearch> searches;
  for (const Patch& patch : patches) {
    const Eigen::Vector2d off(random.gaussian(1.2), random.gaussian(1.2));
    Eigen::Matrix2d warp;
    warp << 1.0 + random.gaussian(0.05), random.gaussian(0.05), random.gaussian(0.05), 1.0 + random.gaussian(0.05);
    searches.push_back({&patch, Eigen::Vector2d(patch.centre.x, patch.centre.y) + off, warp});
  }
  ASSERT_GT(searches.size(), 200U);  // more than are aligned in one piece
  test::for_each_target([&] {
    std::size_t found = 0;
    const auto alignments = align_patches(searches, picture, 3.0);
    ASSERT_EQ(alignments.size(), searches.size());
    for (std::size_t i = 0; i < searches.size(); ++i) {
      const auto expected = reference::naive_alignment(searches[i], picture, 3.0);
      ASSERT_EQ(alignments[i].has_value(), expected.has_value()) << i;
      if (!expected) continue;
      ++found;
      EXPECT_EQ(alignments[i]->position, expected->position) << i;
      EXPECT_EQ(alignments[i]->covariance, expected->covariance) << i;
    }
    EXPECT_GT(found, searches.size() / 2);
    EXPECT_LT(found, searches.size());
  });
  EXPECT_TRUE(align_patches({}, picture, 3.0).empty());
}

}  // namespace
}  // namespace brink
