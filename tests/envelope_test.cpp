#include "brink/envelope.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "brink/disparity.hpp"
#include "expect_error.hpp"

namespace brink {
namespace {

const StereoCamera kCamera{350.0, 319.5, 179.5, 0.15};  // f b = 52.5 px m
const cv::Size kSize(640, 360);
const DropShape kEdge{kOpenEnded, kOpenEnded};

Viewpoint at(const ViewpointParams& params) { return make_viewpoint(kCamera, kSize, params); }

std::string rule_of(const DropSighting& sighting) { return sighting.rejection ? sighting.rejection->rule : "seen"; }

std::string rule_of(double distance_m, double depth_m, const DropShape& shape, const ViewpointParams& params,
                    const CandidateParams& rules = {}) {
  return rule_of(compute_sighting(make_drop(distance_m, depth_m, shape), at(params), rules));
}

// f = 300, b = 0.2, h = 1.5, level: row v sees the ground at x = 450 / (v - 100) m, with disparity 60 / x. The opening is from
// 2.5 to 6 m, its bottom 0.75 m down, where a ray that passes the ground at x is at 1.5 x.
TEST(DropDisparity, IsThatOfGroundBottomAndFarWall) {
  const Viewpoint viewpoint = make_viewpoint({300.0, 160.0, 100.0, 0.2}, {321, 301}, {.height_m = 1.5, .pitch_deg = 0.0});
  const cv::Mat1f disparity = compute_drop_disparity(make_drop(2.5, 0.75, {3.5, 100.0}), viewpoint);
  EXPECT_EQ(disparity(100, 160), kInvalidDisparity);          // the horizon
  EXPECT_NEAR(disparity(150, 160), 60.0 / 9.0, 1e-4);         // ground behind the opening
  EXPECT_NEAR(disparity(190, 160), 60.0 / 6.0, 1e-4);         // x = 5: the bottom would be at 7.5 m, the wall is at 6
  EXPECT_NEAR(disparity(250, 160), 60.0 / 4.5, 1e-4);         // x = 3: the bottom
  EXPECT_NEAR(disparity(285, 160), 185.0 * 0.2 / 1.5, 1e-4);  // x = 2.43: ground before the opening
}

TEST(DropDisparity, IsMissingWhereTheRightPictureEndsAndAboveTheLargestThatIsMatched) {
  Viewpoint viewpoint = make_viewpoint({300.0, 160.0, 100.0, 0.2}, {321, 301}, {.height_m = 1.5, .pitch_deg = 0.0});
  const Drop drop = make_drop(2.5, 0.75, {3.5, 1.0});
  EXPECT_EQ(compute_drop_disparity(drop, viewpoint)(285, 24), kInvalidDisparity);  // 24.67 px
  EXPECT_NEAR(compute_drop_disparity(drop, viewpoint)(285, 25), 24.667, 0.001);
  viewpoint.max_disparity = 24.0;
  EXPECT_EQ(compute_drop_disparity(drop, viewpoint)(285, 25), kInvalidDisparity);
}

// A rim of 1 m that is turned: whoever looks over its corner sees the walls beyond it.
TEST(DropDisparity, FollowsAnyPolygon) {
  const Viewpoint viewpoint = make_viewpoint({300.0, 160.0, 100.0, 0.2}, {321, 301}, {.height_m = 1.5, .pitch_deg = 0.0});
  const Drop drop{{{0.0, 2.5}, {0.5, 3.0}, {0.0, 3.5}, {-0.5, 3.0}}, 10.0};
  EXPECT_NEAR(compute_drop_disparity(drop, viewpoint)(250, 160), 60.0 / 3.5, 1e-3);  // through x = 3: the far corner
  // 0.45 m beside x = 3 the ray leaves at t times that, where 0.45 t + 3 (t - 1) = 0.5: t = 3.5 / 3.45.
  EXPECT_NEAR(compute_drop_disparity(drop, viewpoint)(250, 205), 20.0 * 3.45 / 3.5, 1e-3);
}

// Through an opening of length L at D one sees down to h L / D.
TEST(DropSighting, GoesDownToWhereTheFarWallEndsTheView) {
  const DropSighting sighting = compute_sighting(make_drop(3.0, 2.0, {1.0, 1.0}), at({.height_m = 1.5}));
  EXPECT_NEAR(sighting.deepest_m, 0.5, 0.02);
  EXPECT_EQ(rule_of(sighting), "seen");
}

// 1.6 * 0.3 / 4 = 0.12 m, however deep it is.
TEST(DropSighting, OfANarrowTrenchIsTooShallowFarAway) {
  const DropSighting far = compute_sighting(make_drop(4.0, 2.0, {0.3, 4.0}), at({}));
  EXPECT_EQ(rule_of(far), "depth");
  EXPECT_NEAR(far.deepest_m, 0.12, 0.015);
  EXPECT_NEAR(far.rejection->limit, 0.135, 1e-9);
  EXPECT_EQ(rule_of(2.0, 2.0, {0.3, 4.0}, {}), "seen");
}

TEST(DropSighting, AsksForTheDepthOfTheRules) {
  EXPECT_EQ(rule_of(2.0, 0.13, {}, {}), "depth");
  EXPECT_EQ(rule_of(2.0, 0.14, {}, {}), "seen");
  CandidateParams rules;
  rules.min_depth_m = 0.05;
  EXPECT_EQ(rule_of(2.0, 0.06, {}, {}, rules), "seen");
}

// Level camera: rows from 5 to 5.53 m, where the far wall is 0.135 m down, are 10.8; they are 350 * 0.05 / 5 = 3.5 px
// wide, less what ends higher up a side wall: 34 px.
TEST(DropSighting, OfASmallHoleHasTooFewPixels) {
  const DropSighting sighting = compute_sighting(make_drop(5.0, 2.0, {1.0, 0.05}), at({.pitch_deg = 0.0}));
  ASSERT_EQ(rule_of(sighting), "area");
  EXPECT_NEAR(sighting.rejection->value, 34.0, 12.0);
}

// Half the field of view is atan(180 / 350) = 27 degrees; the far rim at 2 m is 39 degrees down.
TEST(DropSighting, NeedsTheDropInThePicture) {
  EXPECT_EQ(rule_of(1.0, 1.0, {}, {.pitch_deg = 0.0}), "picture");
  EXPECT_EQ(rule_of(1.0, 1.0, {}, {.pitch_deg = 40.0}), "seen");
}

TEST(DropSighting, LeavesOutWhereSomethingStandsBefore) {
  const auto rule_with = [](const Shown& shown) {
    return rule_of(compute_sighting(make_drop(2.0, 1.0, kEdge), at({}), {}, shown));
  };
  const cv::Mat1b nowhere(kSize, uchar{0});
  const cv::Mat1b everywhere(kSize, uchar{255});
  EXPECT_EQ(rule_with({everywhere, everywhere}), "seen");
  EXPECT_EQ(rule_with({nowhere, everywhere}), "picture");
  EXPECT_EQ(rule_with({everywhere, nowhere}), "touches_ground");
}

TEST(DropSighting, EndsWhereCandidatesAreNoLongerLookedFor) {
  EXPECT_EQ(rule_of(7.5, 2.0, kEdge, {}), "seen");
  EXPECT_EQ(rule_of(8.5, 2.0, kEdge, {}), "range");
  EXPECT_EQ(rule_of(5.0, 0.05, kEdge, {}), "depth");
}

// Over an edge at D the first low point lies on the ray of the rim, which falls by atan(h / D).
TEST(DropSighting, OfAnEdgeFromALowCameraIsTakenForARamp) {
  EXPECT_EQ(rule_of(1.4, 1.0, kEdge, {.height_m = 0.3, .pitch_deg = 0.0}), "seen");   // 12.1 degrees
  EXPECT_EQ(rule_of(2.0, 1.0, kEdge, {.height_m = 0.3, .pitch_deg = 0.0}), "slope");  // 8.5 degrees
}

// Six deviations: e = 6 sd h / d with d = f b / (z (1 + e / h)), so e = h q / (1 - q), q = 6 sd z / (f b). At z = 5, sd = 0.3:
// q = 0.1714, e = 0.331 m. The first row behind the rim lies at most 4.5 cm farther. By day the 0.135 m of the rules are more.
TEST(SmallestDepth, OfAnEdgeIsWhatStandsOutOfTheNoise) {
  EXPECT_NEAR(*estimate_smallest_depth(5.0, kEdge, at({.pitch_deg = 0.0, .disparity_sd_px = 0.3})), 0.331, 0.01);
  EXPECT_NEAR(*estimate_smallest_depth(5.0, kEdge, at({.pitch_deg = 0.0, .disparity_sd_px = 0.1})), 0.135, 0.006);
}

TEST(SmallestDepth, IsNoneWhereTheOpeningIsTooShortOrOutOfThePicture) {
  EXPECT_FALSE(estimate_smallest_depth(4.0, {0.3, 4.0}, at({})).has_value());
  EXPECT_FALSE(estimate_smallest_depth(1.0, {1.0, 1.0}, at({.pitch_deg = 0.0})).has_value());
}

TEST(LargestDistance, IsWhereTheSmallestDepthReachesTheDepth) {
  const Viewpoint dusk = at({.disparity_sd_px = 0.3});
  const double distance = estimate_largest_distance(0.3, kEdge, dusk).value();
  EXPECT_LE(*estimate_smallest_depth(distance, kEdge, dusk), 0.3 + 0.005);
  EXPECT_GT(*estimate_smallest_depth(distance + 0.1, kEdge, dusk), 0.3);
  EXPECT_FALSE(estimate_largest_distance(0.05, kEdge, dusk).has_value());
  const double farthest = estimate_largest_distance(2.0, kEdge, dusk).value();
  EXPECT_LT(farthest, 8.0);  // some rows must lie within range
  EXPECT_GT(farthest, 7.5);
}

TEST(Envelope, HasEachDistanceInItsPlace) {
  const std::vector<EnvelopePoint> points = compute_envelope({5.0, 2.0}, kEdge, at({.disparity_sd_px = 0.3}));
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[0].distance_m, 5.0);
  EXPECT_EQ(points[0].smallest_depth_m, estimate_smallest_depth(5.0, kEdge, at({.disparity_sd_px = 0.3})));
  EXPECT_EQ(points[1].distance_m, 2.0);
}

TEST(Viewpoint, RefusesWhatIsNone) {
  const auto fault = [](const ViewpointParams& params) { return test::error_of<std::invalid_argument>([&] { at(params); }); };
  EXPECT_EQ(fault({.height_m = 0.0}), "height_m = 0, must be above 0 to 100");
  EXPECT_EQ(fault({.pitch_deg = 90.0}), "pitch_deg = 90, must be above -90 to below 90");
  EXPECT_EQ(fault({.roll_deg = -95.0}), "roll_deg = -95, must be above -90 to below 90");
  EXPECT_EQ(fault({.disparity_sd_px = 0.0}), "disparity_sd_px = 0, must be 0.001 to 100");
  EXPECT_THROW(make_viewpoint(kCamera, {0, 360}), std::invalid_argument);
}

TEST(Drop, RefusesWhatIsNone) {
  EXPECT_THROW(make_drop(0.0, 1.0, {}), std::invalid_argument);
  EXPECT_THROW(make_drop(1.0, -1.0, {}), std::invalid_argument);
  EXPECT_THROW(make_drop(1.0, 1.0, {0.0, 1.0}), std::invalid_argument);
  EXPECT_THROW(make_drop(1.0, 1.0, {1.0, 2000.0}), std::invalid_argument);
  EXPECT_THROW(compute_sighting({{{0.0, 1.0}, {1.0, 1.0}}, 1.0}, at({})), std::invalid_argument);
  EXPECT_THROW(compute_sighting(make_drop(1.0, 1.0, {}), at({}), {}, {cv::Mat1b(3, 3), {}}), std::invalid_argument);
}

}  // namespace
}  // namespace brink
