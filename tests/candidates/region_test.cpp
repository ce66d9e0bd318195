#include "candidates/region.hpp"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "candidates/grow.hpp"
#include "candidates/rim_slope.hpp"
#include "reference/rim_slope.hpp"
#include "reference/ring_pixels.hpp"
#include "scan.hpp"

namespace brink {
namespace {

/// 255 at a share of the pixels, in patches of a few pixels.
cv::Mat1b make_patches(const cv::Size& size, double share, int patch_px, cv::RNG& random) {
  cv::Mat1f noise(size);
  random.fill(noise, cv::RNG::UNIFORM, 0.0, 1.0);
  cv::Mat1b mask(noise < share / (patch_px * patch_px));
  cv::dilate(mask, mask, cv::Mat1b(patch_px, patch_px, uchar{1}));
  return mask;
}

bool equal(const cv::Mat1b& a, const cv::Mat1b& b) { return a.size() == b.size() && cv::norm(a, b, cv::NORM_INF) == 0.0; }

TEST(Regions, AreThoseOfOpenCvWithTheirDilationInThePicture) {
  cv::RNG random(11);
  for (const cv::Size& size : {cv::Size(1, 1), cv::Size(9, 1), cv::Size(67, 41), cv::Size(200, 133)}) {
    for (const double share : {0.1, 0.35, 0.6, 1.0}) {
      const cv::Mat1b mask = make_patches(size, share, 2, random);
      cv::Mat1i labels;
      const int count = cv::connectedComponents(mask, labels, 8, CV_32S);
      const std::vector<Region> regions = find_regions(mask, 1);
      EXPECT_EQ(regions.size(), static_cast<std::size_t>(count - 1));
      for (const Region& region : regions) {
        const cv::Rect tight(region.box.tl() + cv::Point(1, 1), region.box.br() - cv::Point(1, 1));
        cv::Mat1b whole(size, uchar{0});
        region.mask(cv::Rect(cv::Point(1, 1), tight.size())).copyTo(whole(tight));
        std::vector<cv::Point> pixels;
        cv::findNonZero(whole, pixels);
        ASSERT_FALSE(pixels.empty());
        EXPECT_TRUE(equal(whole, cv::Mat1b(labels == labels(pixels[0]))));
        EXPECT_EQ(find_box(whole), tight);
        EXPECT_EQ(region.area_px, cv::countNonZero(whole));
        cv::Mat1b dilated;
        cv::dilate(whole, dilated, cv::Mat());
        const cv::Rect in_picture = region.box & cv::Rect(cv::Point(0, 0), size);
        EXPECT_TRUE(equal(region.dilated(in_picture - region.box.tl()), dilated(in_picture)));
        EXPECT_EQ(cv::countNonZero(region.dilated), cv::countNonZero(dilated));
      }
    }
  }
}

TEST(Boxes, HoldAllThatIsSet) {
  cv::RNG random(12);
  for (const int width : {1, 8, 13, 40}) {
    for (int i = 0; i < 500; ++i) {
      cv::Mat1b mask(5, width, uchar{0});
      cv::Rect box;
      for (int k = i % 4; k > 0; --k) {
        const cv::Point p(random.uniform(0, width), random.uniform(0, mask.rows));
        mask(p) = 1;
        box |= cv::Rect(p, cv::Size(1, 1));
      }
      EXPECT_EQ(find_box(mask), box);
    }
  }
  EXPECT_EQ(find_box(cv::Mat1b()), cv::Rect());
}

TEST(Regions, ThoseThatMeetLateAreOne) {
  // A comb with its teeth up: branches that turn out to be one only rows below.
  cv::Mat1b mask(20, 41, uchar{0});
  for (int u = 0; u < 41; u += 2) mask(cv::Rect(u, 0, 1, 19)) = 255;
  mask.row(19) = 255;
  const std::vector<Region> regions = find_regions(mask, 1);
  ASSERT_EQ(regions.size(), 1U);
  EXPECT_EQ(regions[0].area_px, 21 * 19 + 41);
}

TEST(Regions, SmallerOnesAreLeftOut) {
  cv::Mat1b mask(10, 20, uchar{0});
  mask(cv::Rect(1, 1, 3, 3)) = 255;
  mask(cv::Rect(8, 0, 4, 3)) = 255;
  const std::vector<Region> regions = find_regions(mask, 10);
  ASSERT_EQ(regions.size(), 1U);
  EXPECT_EQ(regions[0].box, cv::Rect(7, -1, 6, 5));
}

TEST(Growing, EqualsItsTwin) {
  cv::RNG random(3);
  for (const cv::Size& size : {cv::Size(1, 1), cv::Size(2, 7), cv::Size(61, 47)}) {
    for (const int steps : {0, 1, 2, 7, 100}) {
      const cv::Mat1b start = make_patches(size, 0.02, 3, random);
      const cv::Mat1b passable = make_patches(size, 0.5, 2, random);
      const reference::NaiveGrowth expected = reference::naive_grow(start, passable, steps);
      const cv::Mat1b growth = grow(start, passable, steps);
      EXPECT_TRUE(equal(cv::Mat1b(growth == static_cast<uchar>(Growth::grown)), expected.grown)) << size << ' ' << steps;
      EXPECT_TRUE(equal(cv::Mat1b(growth == static_cast<uchar>(Growth::ring)), expected.ring)) << size << ' ' << steps;
    }
  }
}

TEST(Regions, RingsEqualTheirTwinsInTheirOrder) {
  cv::RNG random(4);
  const cv::Mat1b mask = make_patches({83, 57}, 0.2, 4, random);
  const cv::Mat1b passable(make_patches(mask.size(), 0.6, 3, random) & ~mask);
  for (const Region& region : find_regions(mask, 1)) {
    for (const int gap_px : {0, 1, 6}) {
      EXPECT_EQ(ring_pixels(region, passable, gap_px), reference::naive_ring_pixels(region, passable, gap_px));
    }
  }
}

// Level ground that is near, that is far, on one side only, and none.
TEST(RimSlope, EqualsItsTwin) {
  cv::RNG random(8);
  const StereoCamera camera{.focal = 350.0, .cx = 160.0, .cy = 90.0, .baseline = 0.15};
  const GroundPose pose = compute_ground_pose(make_ground_plane(1.5, 25.0, 3.0, camera), camera);
  const cv::Size size(320, 180);
  cv::Mat1f disparity(size);
  random.fill(disparity, cv::RNG::UNIFORM, 5.0, 40.0);
  int steep = 0;
  for (const double level_share : {0.0, 0.0001, 0.001, 0.5}) {
    for (int i = 0; i < 5; ++i) {
      const cv::Mat1b low = make_patches(size, 0.02, 11, random);
      const cv::Mat1b deep(low & make_patches(size, 0.8, 2, random));
      const cv::Mat1b level(make_patches(size, level_share, 2, random) & ~low);
      for (const Region& region : find_regions(low, 1)) {
        const double slope_deg = compute_rim_slope_deg(region, deep, level, disparity, camera, pose);
        EXPECT_EQ(slope_deg, reference::naive_rim_slope_deg(region, deep, level, disparity, camera, pose));
        steep += slope_deg > 0.0 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(steep, 20);
}

}  // namespace
}  // namespace brink
