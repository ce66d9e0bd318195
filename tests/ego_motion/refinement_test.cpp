#include "ego_motion/refinement.hpp"

#include <cmath>
#include <optional>

#include <gtest/gtest.h>

#include "ego_motion/synthetic_room.hpp"

namespace brink {
namespace {

/// A texture that may be looked at anywhere, also between pixels: pixel (u, v) shows the place warp * (u, v) + shift.
cv::Mat1b make_picture(const Eigen::Vector2d& shift, const Eigen::Matrix2d& warp = Eigen::Matrix2d::Identity()) {
  cv::Mat1b picture(61, 75);
  for (int v = 0; v < picture.rows; ++v) {
    for (int u = 0; u < picture.cols; ++u) {
      const Eigen::Vector2d place = 0.02 * (warp * Eigen::Vector2d(u, v) + shift);  // cells of 4 px and more
      picture(v, u) = cv::saturate_cast<uchar>(test::room_texture(place.x(), place.y(), 1));
    }
  }
  return smooth_for_patches(picture);
}

const cv::Mat1b& reference() {
  static const cv::Mat1b picture = make_picture({0.0, 0.0});
  return picture;
}

std::optional<Alignment> align_patch(const Patch& patch, const cv::Mat1b& smooth, const Eigen::Vector2d& start,
                                     const Eigen::Matrix2d& warp, double reach) {
  return align_patches({{&patch, start, warp}}, smooth, reach).front();
}

TEST(AlignPatches, FindsAPatchToAFewHundredthsOfAPixel) {
  const auto patch = make_patch(reference(), {37, 30});
  ASSERT_TRUE(patch);
  for (const Eigen::Vector2d& shift : {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(0.3, -0.4), Eigen::Vector2d(-1.5, 0.7)}) {
    const auto aligned = align_patch(*patch, make_picture(shift), {37.0, 30.0}, Eigen::Matrix2d::Identity(), 3.0);
    ASSERT_TRUE(aligned) << shift.transpose();
    EXPECT_LT((aligned->position - (Eigen::Vector2d(37.0, 30.0) - shift)).norm(), 0.05) << shift.transpose();
    EXPECT_GT(aligned->covariance.determinant(), 0.0);
  }
}

TEST(AlignPatches, TakesAWarpIntoAccount) {
  Eigen::Matrix2d warp;
  warp << 1.1, 0.15, -0.1, 0.9;
  const Eigen::Matrix2d back = warp.inverse();
  const Eigen::Vector2d centre(37.0, 30.0);
  // Pixel q shows the place warp * q + shift, so that the centre stays where it is.
  const auto patch = make_patch(reference(), {37, 30});
  ASSERT_TRUE(patch);
  const auto aligned =
      align_patch(*patch, make_picture(centre - warp * centre, warp), centre + Eigen::Vector2d(0.6, -0.5), back, 3.0);
  ASSERT_TRUE(aligned);
  EXPECT_LT((aligned->position - centre).norm(), 0.05);
}

TEST(AlignPatches, IsEmptyWhereThePatchIsNot) {
  const auto patch = make_patch(reference(), {37, 30});
  ASSERT_TRUE(patch);
  const auto find = [&](const cv::Mat1b& picture, const Eigen::Vector2d& start, double reach) {
    return align_patch(*patch, picture, start, Eigen::Matrix2d::Identity(), reach);
  };
  EXPECT_TRUE(find(reference(), {38.0, 30.0}, 3.0));
  EXPECT_FALSE(find(reference(), {38.5, 30.0}, 1.0)) << "out of reach";
  EXPECT_FALSE(find(make_picture({500.0, 300.0}), {37.0, 30.0}, 3.0)) << "another texture";
  EXPECT_FALSE(find(cv::Mat1b(61, 75, uchar{80}), {37.0, 30.0}, 3.0)) << "no texture";
  EXPECT_FALSE(find(reference(), {3.0, 30.0}, 100.0)) << "over the border";
  EXPECT_FALSE(find(reference(), {-300.0, 1e9}, 100.0)) << "far outside";
}

TEST(AlignPatches, DoesNotCareForBrightness) {
  const auto patch = make_patch(reference(), {37, 30});
  ASSERT_TRUE(patch);
  cv::Mat1b darker;
  reference().convertTo(darker, CV_8U, 0.9, -20.0);
  const auto aligned = align_patch(*patch, darker, {37.4, 30.0}, Eigen::Matrix2d::Identity(), 3.0);
  ASSERT_TRUE(aligned);
  EXPECT_LT((aligned->position - Eigen::Vector2d(37.0, 30.0)).norm(), 0.03);
}

TEST(MakePatch, IsEmptyAtTheBorderAndWithoutTextureInBothDirections) {
  EXPECT_FALSE(make_patch(reference(), {5, 30}));
  EXPECT_FALSE(make_patch(reference(), {37, 55}));
  EXPECT_TRUE(make_patch(reference(), {6, 30}));
  EXPECT_FALSE(make_patch(cv::Mat1b(1, 1, uchar{0}), {0, 0}));
  EXPECT_FALSE(make_patch(cv::Mat1b(61, 75, uchar{80}), {37, 30}));
  cv::Mat1b stripes(61, 75);
  for (int u = 0; u < stripes.cols; ++u) stripes.col(u) = static_cast<uchar>(u % 8 < 4 ? 40 : 200);
  EXPECT_FALSE(make_patch(stripes, {37, 30})) << "may slide along its stripes";
}

}  // namespace
}  // namespace brink
