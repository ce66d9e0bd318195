#include "brink/candidates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "brink/disparity.hpp"
#include "candidates/agreement.hpp"
#include "candidates/region.hpp"
#include "ground/roughness.hpp"
#include "synthetic_scene.hpp"

namespace brink {
namespace {

/// Flat ground seen by a camera 1.6 m up, pitched down by 30 degrees, with openings; the pictures are uniformly bright.
class Candidates : public testing::Test {
 protected:
  void see(const std::vector<test::Opening>& openings, double roll_deg = 0.0) {
    plane_ = make_ground_plane(1.6, 30.0, roll_deg, camera_);
    disparity_ = test::make_disparity(camera_, test::half_size(), plane_, openings);
    elevation_ = compute_elevation(disparity_, plane_, camera_);
    frame_ = make_frame(cv::Mat3b(test::half_size(), cv::Vec3b(100, 110, 120)), cv::Mat1b(test::half_size(), 110), camera_);
  }
  /// Takes disparity away and paints the left picture.
  void blacken(const cv::Rect& box, const cv::Vec3b& color) {
    disparity_(box).setTo(kInvalidDisparity);
    elevation_(box).setTo(std::numeric_limits<float>::quiet_NaN());
    frame_.left_color(box).setTo(color);
  }
  [[nodiscard]] GroundSurface surface() const {
    GroundSurface surface;
    surface.plane = plane_;
    surface.pose = compute_ground_pose(plane_, camera_);
    surface.disparity_sd_px = noise_px_;
    surface.roughness_px = noise_px_ / kNoiseOverRoughness;
    return surface;
  }
  [[nodiscard]] std::vector<Candidate> below_ground() const {
    return select_below_ground(frame_, disparity_, elevation_, surface(), params_);
  }
  [[nodiscard]] std::vector<Candidate> no_disparity() const {
    return select_no_disparity(frame_, disparity_, elevation_, surface(), params_);
  }

  StereoCamera camera_ = test::half_size_camera();
  GroundPlane plane_;
  cv::Mat1f disparity_;
  cv::Mat1f elevation_;
  Frame frame_;
  CandidateParams params_;
  double noise_px_ = 0.1;
};

TEST_F(Candidates, FlatGroundHasNone) {
  see({});
  EXPECT_TRUE(below_ground().empty());
  EXPECT_TRUE(no_disparity().empty());
}

TEST_F(Candidates, AHoleIsMeasuredAtItsRim) {
  for (const double roll : {0.0, 10.0}) {
    SCOPED_TRACE(roll);
    see({{2.0, 3.0, -0.4, 0.6, 0.5}}, roll);
    const auto found = below_ground();
    ASSERT_EQ(found.size(), 1U);
    const Candidate& hole = found[0];
    EXPECT_FALSE(hole.rejection);
    EXPECT_EQ(hole.type, CandidateType::below_ground);
    EXPECT_NEAR(hole.distance_m, 2.0, 0.03);
    EXPECT_NEAR(hole.width_m, 1.0, 0.06);
    ASSERT_TRUE(hole.depth_m);
    EXPECT_NEAR(*hole.depth_m, 0.5, 0.01);
    // The nearest point is on a side wall, as far down as the region is drawn out (0.4 x 0.15 m), so behind the rim.
    const GroundPose pose = compute_ground_pose(plane_, camera_);
    EXPECT_GE(pose.distance(hole.nearest), 2.0 * (1.0 + 0.06 / 1.6) - 0.02);
    EXPECT_LT(pose.distance(hole.nearest), 2.0 * (1.0 + 0.50 / 1.6) + 0.02);
    EXPECT_NEAR(pose.elevation(hole.rim_nearest), 0.0, 1e-9);
    EXPECT_NEAR(hole.bearing_deg, pose.bearing_deg(hole.rim_nearest), 1e-9);
    EXPECT_NEAR(hole.mean_color[0], 100.0, 1e-9);
    EXPECT_NEAR(hole.mean_color[2], 120.0, 1e-9);
  }
}

TEST_F(Candidates, APlatformEdgeIsAsFarAsItsRim) {
  see({{3.0, 100.0, -100.0, 100.0, 1.0}});
  const auto found = below_ground();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_FALSE(found[0].rejection);
  EXPECT_NEAR(found[0].distance_m, 3.0, 0.03);
  const GroundPose pose = compute_ground_pose(plane_, camera_);
  EXPECT_NEAR(pose.distance(found[0].nearest), 3.0 * (1.0 + 1.0 / 1.6), 0.1);  // as in the specification: 4.8 m
}

// 0.15 m to the letter; a drop of 0.15 m may measure 10 % less.
TEST_F(Candidates, DepthMustReachTheThreshold) {
  for (const auto& [ratio, too_little, enough] : {std::array{1.0, 0.14, 0.16}, {0.9, 0.12, 0.14}}) {
    params_.measured_depth_ratio = ratio;
    see({{2.0, 2.6, -0.4, 0.4, too_little}});
    EXPECT_TRUE(below_ground().empty()) << ratio;
    see({{2.0, 2.6, -0.4, 0.4, enough}});
    ASSERT_EQ(below_ground().size(), 1U) << ratio;
    EXPECT_FALSE(below_ground()[0].rejection) << ratio;
  }
}

TEST_F(Candidates, SmallRegionsAreKeptWithTheRuleThatTheyFail) {
  params_ = CandidateParams::paper();
  see({});
  elevation_(cv::Rect(300, 200, 15, 10)).setTo(-0.3F);  // 150 px: not greater than the limit
  const auto found = below_ground();
  ASSERT_EQ(found.size(), 1U);
  ASSERT_TRUE(found[0].rejection);
  EXPECT_EQ(found[0].rejection->rule, "area");
  EXPECT_EQ(found[0].rejection->value, 150.0);
  EXPECT_EQ(found[0].rejection->limit, 150.0);
  elevation_(210, 300) = -0.3F;  // the 151st pixel, below the box
  EXPECT_FALSE(below_ground()[0].rejection);
}

TEST_F(Candidates, RegionsApartFromTheGroundAreRejected) {
  see({});
  elevation_(cv::Rect(290, 190, 40, 40)).setTo(0.5F);   // the top of a box,
  elevation_(cv::Rect(300, 200, 20, 20)).setTo(-0.3F);  // and something seen below through it
  const auto found = below_ground();
  ASSERT_EQ(found.size(), 1U);
  ASSERT_TRUE(found[0].rejection);
  EXPECT_EQ(found[0].rejection->rule, "touches_ground");
  EXPECT_EQ(found[0].rejection->value, 0.0);
  EXPECT_EQ(found[0].rejection->limit, 5.0);
}

TEST_F(Candidates, FarRegionsAreNotLookedFor) {
  see({{8.2, 12.0, -3.0, 3.0, 1.0}});
  EXPECT_TRUE(below_ground().empty());
}

TEST_F(Candidates, ABlackHoleWithoutDisparityIsType2) {
  see({});
  blacken({300, 200, 30, 20}, {10, 12, 19});
  const auto found = no_disparity();
  ASSERT_EQ(found.size(), 1U);
  const Candidate& hole = found[0];
  EXPECT_FALSE(hole.rejection);
  EXPECT_EQ(hole.area_px, 600);
  EXPECT_FALSE(hole.depth_m);
  EXPECT_NEAR(hole.mean_color[2], 19.0, 1e-9);
  // The contour is that of the dilated mask: one pixel outside, on valid pixels, so all of it has 3D positions.
  EXPECT_EQ(cv::boundingRect(hole.contour), cv::Rect(299, 199, 32, 22));
  EXPECT_EQ(hole.contour_3d.size(), hole.contour.size());
  const GroundPose pose = compute_ground_pose(plane_, camera_);
  EXPECT_NEAR(hole.distance_m, pose.distance(*pose.intersect(319, 220, camera_)), 0.01);
}

// The ground has a grey value of 112: a third of it is 36.96.
TEST_F(Candidates, BlackIsAThirdOfTheGroundsBrightness) {
  see({});
  blacken({300, 200, 30, 20}, {30, 32, 36});
  EXPECT_FALSE(no_disparity().at(0).rejection);
  blacken({300, 200, 30, 20}, {30, 32, 37});
  const Candidate grey = no_disparity().at(0);
  ASSERT_TRUE(grey.rejection);
  EXPECT_EQ(grey.rejection->rule, "black");
  EXPECT_NEAR(grey.rejection->limit, 0.33 * 112.0, 1e-9);
}

TEST_F(Candidates, GreyAboveTheLevelIsNotBlack) {
  params_.black_share = 0.0;
  see({});
  blacken({300, 200, 30, 20}, {10, 12, 21});
  const auto found = no_disparity();
  ASSERT_EQ(found.size(), 1U);
  ASSERT_TRUE(found[0].rejection);
  EXPECT_EQ(found[0].rejection->rule, "black");
  EXPECT_NEAR(found[0].rejection->value, 21.0, 1e-9);
  EXPECT_EQ(found[0].rejection->limit, 20.0);
}

TEST_F(Candidates, InvalidPixelsAboveTheHorizonOrFarAwayAreNotCandidates) {
  see({});
  blacken({0, 0, 640, 1}, {0, 0, 0});
  EXPECT_TRUE(no_disparity().empty());
}

TEST_F(Candidates, WhatOnlyTheLeftCameraSeesIsNotACandidate) {
  see({});
  const int shared = static_cast<int>(plane_.disparity(0, 300));  // the right camera sees nothing left of this in row 300
  blacken({0, 280, shared - 2, 40}, {0, 0, 0});
  EXPECT_TRUE(no_disparity().empty());
  blacken({0, 280, shared + 40, 40}, {0, 0, 0});
  EXPECT_EQ(no_disparity().size(), 1U);
}

TEST_F(Candidates, ARampIsNotADropButAStepOfTheSameDepthIs) {
  // Level for 2 m, then down by 8 degrees: what is 15 cm down there is no drop. A step down to 0.3 m is.
  see({});
  const GroundPose pose = compute_ground_pose(plane_, camera_);
  for (int v = 0; v < disparity_.rows; ++v) {
    for (int u = 0; u < disparity_.cols; ++u) {
      const auto point = pose.intersect(u, v, camera_);
      if (!point) continue;
      // On the ray at stretch s: elevation h (1 - s), distance s x; on the ramp h (s - 1) = tan(8) (s x - 2).
      const double x = pose.forward.dot(*point);
      const double tangent = std::tan(8.0 * 3.14159265 / 180.0);
      if (x < 2.0) continue;
      const double stretch = (pose.height_m - 2.0 * tangent) / (pose.height_m - tangent * x);
      disparity_(v, u) = static_cast<float>(plane_.disparity(u, v) / stretch);
    }
  }
  elevation_ = compute_elevation(disparity_, plane_, camera_);
  const auto ramp = below_ground();
  ASSERT_EQ(ramp.size(), 1U);
  ASSERT_TRUE(ramp[0].rejection);
  EXPECT_EQ(ramp[0].rejection->rule, "slope");
  EXPECT_LE(ramp[0].rejection->value, 8.01);  // along the line of fall; less where the rim is crossed aslant
  EXPECT_GE(ramp[0].rejection->value, 7.0);
  EXPECT_EQ(ramp[0].rejection->limit, 10.0);

  see({{2.0, 100.0, -100.0, 100.0, 0.3}});
  ASSERT_EQ(below_ground().size(), 1U);
  EXPECT_FALSE(below_ground()[0].rejection);
}

TEST_F(Candidates, ARegionIsDrawnOutToItsRim) {
  see({});
  elevation_(cv::Rect(300, 190, 40, 60)).setTo(-0.10F);  // a slope of which only the middle is 15 cm deep
  elevation_(cv::Rect(310, 200, 20, 30)).setTo(-0.20F);
  ASSERT_EQ(below_ground().size(), 1U);
  EXPECT_EQ(below_ground()[0].area_px, 40 * 60);
  params_ = CandidateParams::paper();
  ASSERT_EQ(below_ground().size(), 1U);
  EXPECT_EQ(below_ground()[0].area_px, 20 * 30);
}

TEST_F(Candidates, AllInvalidTouchesNothing) {
  see({});
  blacken({0, 0, 640, 360}, {0, 0, 0});
  const auto found = no_disparity();
  ASSERT_EQ(found.size(), 1U);
  ASSERT_TRUE(found[0].rejection);
  EXPECT_EQ(found[0].rejection->rule, "touches_valid");
  EXPECT_TRUE(below_ground().empty());
}

TEST_F(Candidates, TouchingMeansFivePixels) {
  see({});
  params_.max_share_standing = 1.0;
  blacken({300, 200, 30, 20}, {0, 0, 0});
  elevation_(cv::Rect(290, 190, 50, 10)).setTo(1.0F);  // a post above
  elevation_(cv::Rect(290, 200, 10, 20)).setTo(1.0F);
  elevation_(cv::Rect(330, 200, 10, 20)).setTo(1.0F);
  elevation_(cv::Rect(290, 220, 50, 10)).setTo(1.0F);
  const auto paint = [&](int count) { elevation_(cv::Rect(305, 220, count, 1)).setTo(0.0F); };
  paint(4);
  ASSERT_TRUE(no_disparity()[0].rejection);
  EXPECT_EQ(no_disparity()[0].rejection->rule, "touches_ground");
  EXPECT_EQ(no_disparity()[0].rejection->value, 4.0);
  paint(5);
  EXPECT_FALSE(no_disparity()[0].rejection);
}

TEST_F(Candidates, TouchingReachesAcrossAGapWithoutDisparity) {
  see({{2.0, 3.0, -0.4, 0.6, 0.5}});
  cv::Mat1b hole(test::half_size(), uchar{0});
  cv::fillPoly(hole, std::vector<std::vector<cv::Point>>{below_ground()[0].contour}, cv::Scalar(255));
  cv::Mat1b band;
  cv::dilate(hole, band, cv::Mat(), {-1, -1}, 10);
  band -= hole;
  disparity_.setTo(kInvalidDisparity, band);
  elevation_.setTo(std::numeric_limits<float>::quiet_NaN(), band);
  EXPECT_FALSE(below_ground()[0].rejection);
  params_.touching_gap_px = 0;
  ASSERT_TRUE(below_ground()[0].rejection);
  EXPECT_EQ(below_ground()[0].rejection->rule, "touches_ground");
}

TEST_F(Candidates, WhatAMirrorShowsLiesBeyondTheFarRim) {
  see({});
  const cv::Rect patch(280, 200, 80, 50);  // wet: things behind it show below the ground
  disparity_(patch) *= 0.6F;
  elevation_ = compute_elevation(disparity_, plane_, camera_);
  ASSERT_EQ(below_ground().size(), 1U);
  ASSERT_TRUE(below_ground()[0].rejection);
  EXPECT_EQ(below_ground()[0].rejection->rule, "beyond_rim");
  EXPECT_GT(below_ground()[0].rejection->value, 0.9);
  params_.max_share_beyond = 1.0;
  EXPECT_FALSE(below_ground()[0].rejection);
}

TEST_F(Candidates, ABlackPostStandsAboveTheGroundAroundIt) {
  see({});
  blacken({300, 200, 30, 40}, {10, 10, 10});
  EXPECT_FALSE(no_disparity()[0].rejection);
  elevation_(cv::Rect(290, 190, 50, 10)).setTo(0.4F);  // the seat of a bench, on the post
  elevation_(cv::Rect(290, 200, 10, 40)).setTo(0.2F);  // its sides, at its own distance
  elevation_(cv::Rect(330, 200, 10, 40)).setTo(0.2F);
  ASSERT_TRUE(no_disparity()[0].rejection);
  EXPECT_EQ(no_disparity()[0].rejection->rule, "standing");
  EXPECT_NEAR(no_disparity()[0].rejection->value, 0.78, 0.02);  // 40 + 40 + 32 of 144 pixels of the ring
}

/// The right picture of a scene, from its left picture and disparities; what is nearer hides what is farther.
cv::Mat1b warp_to_right(const cv::Mat1b& left, const cv::Mat1f& disparity) {
  cv::Mat1b right(left.size(), uchar{0});
  cv::Mat1f nearest(left.size(), 0.0F);
  for (int v = 0; v < left.rows; ++v) {
    for (int u = 0; u < left.cols; ++u) {
      const int column = u - static_cast<int>(std::lround(disparity(v, u)));
      if (column < 0 || disparity(v, u) <= nearest(v, column)) continue;
      nearest(v, column) = disparity(v, u);
      right(v, column) = left(v, u);
    }
  }
  return right;
}

TEST_F(Candidates, WhatTheGroundExplainsAsWellIsGround) {
  see({});
  const cv::Mat1f flat = disparity_.clone();
  see({{2.0, 3.0, -0.4, 0.6, 0.5}});
  cv::Mat1b texture(test::half_size());
  cv::RNG(3).fill(texture, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(texture, texture, {5, 5}, 1.5);
  frame_ = make_frame(texture, warp_to_right(texture, disparity_), camera_);
  EXPECT_FALSE(below_ground()[0].rejection) << "the pictures show a hole";
  frame_ = make_frame(texture, warp_to_right(texture, flat), camera_);
  params_.min_agreement = 0.0;
  ASSERT_TRUE(below_ground()[0].rejection) << "the pictures show ground, whatever the disparities say";
  EXPECT_EQ(below_ground()[0].rejection->rule, "like_ground");
  EXPECT_LT(below_ground()[0].rejection->value, 0.05);
}

TEST_F(Candidates, WhatNeitherPictureConfirmsIsNothing) {
  see({{2.0, 3.0, -0.4, 0.6, 0.5}});
  cv::Mat1b texture(test::half_size());
  cv::Mat1b another(test::half_size());
  cv::RNG random(3);
  random.fill(texture, cv::RNG::UNIFORM, 0, 255);
  random.fill(another, cv::RNG::UNIFORM, 0, 255);
  params_.min_ground_misfit = 0.0;
  frame_ = make_frame(texture, warp_to_right(texture, disparity_), camera_);
  EXPECT_FALSE(below_ground()[0].rejection);
  frame_ = make_frame(texture, another, camera_);
  ASSERT_TRUE(below_ground()[0].rejection);
  EXPECT_EQ(below_ground()[0].rejection->rule, "disagree");
  EXPECT_LT(below_ground()[0].rejection->value, 0.1);
}

TEST_F(Candidates, APaleCollarDoesNotMakeABlackOpeningBright) {
  see({});
  blacken({290, 190, 60, 50}, {100, 100, 100});
  blacken({290, 190, 60, 30}, {5, 5, 5});
  ASSERT_EQ(no_disparity().size(), 1U);
  EXPECT_FALSE(no_disparity()[0].rejection) << "three fifths of it are black";
  params_.black_by_median = false;
  ASSERT_TRUE(no_disparity()[0].rejection) << "its mean is 43";
  EXPECT_EQ(no_disparity()[0].rejection->rule, "black");
}

TEST_F(Candidates, NoiseHidesWhatIsShallowAndFar) {
  const auto reported = [this](double distance, double depth) {
    see({{distance, 20.0, -0.5, 0.5, depth}});
    return std::ranges::any_of(below_ground(), [](const Candidate& candidate) { return !candidate.rejection; });
  };
  // h = 1.6 m, f b = 52.5: six standard deviations of 0.3 px are 13 cm at 2 m and 28 cm at 5 m.
  noise_px_ = 0.3;
  EXPECT_TRUE(reported(2.0, 0.18));
  EXPECT_FALSE(reported(5.0, 0.18));
  EXPECT_TRUE(reported(5.0, 0.4));
  params_.min_sigmas = 0.0;
  EXPECT_TRUE(reported(5.0, 0.18));
}

TEST_F(Candidates, WhatScattersAndAgreesInNoPictureIsNoSurface) {
  see({{2.0, 3.0, -0.4, 0.6, 0.5}});
  cv::RNG random(7);
  const double height = compute_ground_pose(plane_, camera_).height_m;
  for (int v = 0; v < disparity_.rows; ++v) {
    for (int u = 0; u < disparity_.cols; ++u) {
      if (disparity_(v, u) <= 0.0F) continue;
      disparity_(v, u) += static_cast<float>(random.gaussian(elevation_(v, u) < -0.2F ? 0.4 : 0.1));
      elevation_(v, u) = static_cast<float>(height * (1.0 - plane_.disparity(u, v) / disparity_(v, u)));
    }
  }
  const auto largest = [this] { return std::ranges::max(below_ground(), {}, &Candidate::area_px); };
  cv::Mat1b texture(test::half_size());
  random.fill(texture, cv::RNG::UNIFORM, 0, 255);
  frame_ = make_frame(texture, cv::Mat1b(test::half_size(), 110), camera_);
  params_.min_ground_misfit = 0.0;
  params_.min_agreement = 0.0;
  noise_px_ = 0.1 * kNoiseOverRoughness;
  ASSERT_TRUE(largest().rejection);
  EXPECT_EQ(largest().rejection->rule, "rough");
  EXPECT_NEAR(largest().rejection->value, 4.0, 1.0);
  params_.max_roughness = 5.0;
  EXPECT_FALSE(largest().rejection);
}

TEST(Roughness, IsTheScatterAroundAPlane) {
  cv::Mat1f disparity(60, 80);
  for (int v = 0; v < disparity.rows; ++v) {
    for (int u = 0; u < disparity.cols; ++u)
      disparity(v, u) = 20.0F + 0.1F * static_cast<float>(v) - 0.05F * static_cast<float>(u);
  }
  cv::Mat1b deep(disparity.size(), uchar{0});
  deep(cv::Rect(10, 10, 50, 40)) = 255;
  EXPECT_NEAR(compute_roughness_px(deep, disparity), 0.0, 1e-4);
  cv::Mat1f noise(disparity.size());
  cv::RNG(5).fill(noise, cv::RNG::NORMAL, 0.0, 0.3);
  EXPECT_NEAR(compute_roughness_px(deep, cv::Mat1f(disparity + noise)), 0.3, 0.02);
  EXPECT_EQ(compute_roughness_px(cv::Mat1b(disparity.size(), uchar{0}), disparity), 0.0);
}

TEST(Agreement, IsTheCorrelationThatAQuarterDoesNotReach) {
  const cv::Size size = test::half_size();
  cv::Mat1b texture(size);
  cv::RNG(9).fill(texture, cv::RNG::UNIFORM, 0, 255);
  const cv::Mat1f disparity(size, 12.0F);
  const Frame frame = make_frame(texture, warp_to_right(texture, disparity), test::half_size_camera());
  std::vector<cv::Point> pixels;
  for (int i = 0; i < 600; ++i) pixels.emplace_back(300 + 2 * (i % 30), 200 + 2 * (i / 30));
  EXPECT_NEAR(compute_agreement(frame, pixels, disparity), 1.0, 1e-6);
  EXPECT_LT(compute_agreement(frame, pixels, cv::Mat1f(size, 17.0F)), 0.1);
  EXPECT_EQ(compute_agreement(make_frame(cv::Mat1b(size, 90), texture, test::half_size_camera()), pixels, disparity), 1.0);
}

TEST_F(Candidates, GreyPicturesUseTheMeanGrey) {
  see({});
  frame_ = make_frame(cv::Mat1b(test::half_size(), 110), cv::Mat1b(test::half_size(), 110), camera_);
  const cv::Rect box(300, 200, 30, 20);
  disparity_(box).setTo(kInvalidDisparity);
  frame_.left(box).setTo(15);
  ASSERT_EQ(no_disparity().size(), 1U);
  EXPECT_FALSE(no_disparity()[0].rejection);
  EXPECT_NEAR(no_disparity()[0].mean_color[0], 15.0, 1e-9);
}

TEST_F(Candidates, WrongArgumentsAreNamed) {
  see({});
  params_.black_level = -1.0;
  EXPECT_THROW(static_cast<void>(no_disparity()), std::invalid_argument);
  params_ = {};
  disparity_ = cv::Mat1f(3, 3, 1.0F);
  EXPECT_THROW(static_cast<void>(below_ground()), std::invalid_argument);
}

/// The naive twin of find_regions' labelling: flood fill over a queue.
std::vector<int> flood_fill_areas(const cv::Mat1b& picture) {
  cv::Mat1b mask = picture.clone();
  std::vector<int> areas;
  for (int v = 0; v < mask.rows; ++v) {
    for (int u = 0; u < mask.cols; ++u) {
      if (mask(v, u) == 0) continue;
      std::vector<cv::Point> open{{u, v}};
      mask(v, u) = 0;
      int area = 0;
      while (!open.empty()) {
        const cv::Point p = open.back();
        open.pop_back();
        ++area;
        for (int y = std::max(0, p.y - 1); y <= std::min(mask.rows - 1, p.y + 1); ++y) {
          for (int x = std::max(0, p.x - 1); x <= std::min(mask.cols - 1, p.x + 1); ++x) {
            if (mask(y, x) == 0) continue;
            mask(y, x) = 0;
            open.emplace_back(x, y);
          }
        }
      }
      areas.push_back(area);
    }
  }
  return areas;
}

TEST(Regions, AreThoseOfAFloodFillInRowOrder) {
  cv::RNG random(5);
  for (const cv::Size& size : {cv::Size(1, 1), cv::Size(1, 17), cv::Size(33, 21), cv::Size(101, 67)}) {
    cv::Mat1b mask(size);
    random.fill(mask, cv::RNG::UNIFORM, 0, 3);
    cv::threshold(mask, mask, 1, 255, cv::THRESH_BINARY);
    std::vector<int> areas;
    for (const Region& region : find_regions(mask, 1)) {
      areas.push_back(region.area_px);
      EXPECT_EQ(cv::countNonZero(region.mask), region.area_px);
    }
    EXPECT_EQ(areas, flood_fill_areas(mask));
  }
  EXPECT_TRUE(find_regions(cv::Mat1b(), 1).empty());
}

TEST(Regions, RingStaysInThePicture) {
  cv::Mat1b mask(5, 5, uchar{0});
  mask(0, 0) = 255;
  const auto regions = find_regions(mask, 1);
  ASSERT_EQ(regions.size(), 1U);
  EXPECT_EQ(ring_pixels(regions[0], cv::Mat1b(5, 5, uchar{0}), 0), (std::vector<cv::Point>{{1, 0}, {0, 1}, {1, 1}}));
}

TEST(Regions, HolesInsideDoNotSplitThem) {
  cv::Mat1b mask(9, 9, uchar{0});
  mask(cv::Rect(1, 1, 7, 7)).setTo(255);
  mask(cv::Rect(3, 3, 3, 3)).setTo(0);
  const auto regions = find_regions(mask, 1);
  ASSERT_EQ(regions.size(), 1U);
  EXPECT_EQ(regions[0].area_px, 40);
  EXPECT_EQ(trace_contour(regions[0].mask, regions[0].box).size(), 24U) << "the outer contour only";
}

TEST_F(Candidates, WithoutAPictureThereIsNoType2AndTheOtherHasNoColour) {
  see({{2.0, 3.0, -0.4, 0.6, 0.5}});
  blacken({300, 100, 40, 40}, {5, 5, 5});
  ASSERT_FALSE(no_disparity().empty());
  frame_ = make_frame_with_disparity({}, disparity_, camera_);
  EXPECT_TRUE(no_disparity().empty());
  ASSERT_EQ(below_ground().size(), 1U);
  EXPECT_EQ(below_ground()[0].mean_color, cv::Scalar());
}

}  // namespace
}  // namespace brink
