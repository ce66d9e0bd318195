#include <numbers>
#include <stdexcept>
#include <utility>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "brink/tracking.hpp"
#include "expect_error.hpp"

namespace brink {
namespace {

constexpr double kStep = 1.0 / 15.0;  // s

Candidate at(double x, double z, CandidateType type = CandidateType::below_ground) {
  Candidate candidate;
  candidate.type = type;
  candidate.centroid = {x, 1.6, z};
  candidate.rim_nearest = candidate.centroid;
  return candidate;
}

// The camera walks ahead, so that everything comes nearer.
Eigen::Isometry3d step_of(double metres) { return Eigen::Isometry3d(Eigen::Translation3d(0.0, 0.0, -metres)); }

const Eigen::Isometry3d kRest = Eigen::Isometry3d::Identity();

/// Follows one candidate at rest over so many frames; the tracks of the last one.
std::vector<Track> follow(Tracker& tracker, int frames, double step_s) {
  std::vector<Track> tracks;
  for (int i = 0; i < frames; ++i) tracks = tracker.update({at(0.0, 3.0)}, kRest, i * step_s);
  return tracks;
}

TEST(Tracker, ValidatesAtTheFifthSightingAt15FramesPerSecond) {
  Tracker tracker(TrackingParams::paper());
  for (int i = 0; i < 7; ++i) {
    const std::vector<Track> tracks = tracker.update({at(0.0, 3.0)}, kRest, i * kStep);
    ASSERT_EQ(tracks.size(), 1U);
    EXPECT_EQ(tracks[0].length, i + 1);
    EXPECT_EQ(tracks[0].validated, i >= 4) << i;
    EXPECT_EQ(tracks[0].id, 1);
  }
}

// max(3, round(fps / 3)): 30 fps 10, 20 fps 7, 10 fps 3, 7.8 fps 3, 2 fps 3.
TEST(Tracker, NeedsSightingsInProportionToTheFrameRate) {
  for (const auto& [fps, sightings] : {std::pair{30.0, 10}, {20.0, 7}, {10.0, 3}, {7.8, 3}, {2.0, 3}}) {
    Tracker before(TrackingParams::paper());
    EXPECT_FALSE(follow(before, sightings - 1, 1.0 / fps)[0].validated) << fps;
    Tracker there(TrackingParams::paper());
    EXPECT_TRUE(follow(there, sightings, 1.0 / fps)[0].validated) << fps;
  }
}

/// A strip of a long drop, seen from one place aside to another.
Candidate strip(double from_x, double to_x) {
  Candidate candidate = at(0.5 * (from_x + to_x), 3.0);
  candidate.rim_nearest = {from_x, 1.6, 2.5};
  candidate.rim = {{from_x, 1.6, 2.5}, {to_x, 1.6, 2.5}, {to_x, 1.6, 3.5}, {from_x, 1.6, 3.5}};
  return candidate;
}

TEST(Tracker, FollowsALongDropOfWhichOtherPartsShow) {
  Tracker tracker;
  (void)tracker.update({strip(-3.0, 3.0)}, std::nullopt, 0.0);
  const std::vector<Track> tracks = tracker.update({strip(-2.0, 2.0), strip(5.0, 7.0)}, kRest, kStep);
  EXPECT_EQ(tracks[0].length, 2) << "within the last one";
  EXPECT_EQ(tracks[1].length, 1) << "beside it";
  Tracker paper(TrackingParams::paper());
  (void)paper.update({strip(-3.0, 1.0)}, std::nullopt, 0.0);
  EXPECT_EQ(paper.update({strip(-2.0, 2.0)}, kRest, kStep)[0].length, 1);
}

TEST(Tracker, MovesCentroidsByTheMotionOfTheCamera) {
  Tracker tracker(TrackingParams::paper());
  (void)tracker.update({at(0.0, 5.0)}, std::nullopt, 0.0);
  // 1.2 m nearer: far outside of the radius unless the motion is applied.
  EXPECT_EQ(tracker.update({at(0.0, 3.8)}, step_of(1.2), 0.1)[0].length, 2);
  EXPECT_EQ(tracker.update({at(0.0, 2.6)}, kRest, 0.2)[0].length, 1);
}

TEST(Tracker, TurnsCentroidsWithTheCamera) {
  Tracker tracker(TrackingParams::paper());
  (void)tracker.update({at(0.0, 3.0)}, std::nullopt, 0.0);
  // A turn by 90 degrees to the right: what was ahead is now to the left.
  const Eigen::Isometry3d turned(Eigen::AngleAxisd(-std::numbers::pi / 2.0, Eigen::Vector3d::UnitY()));
  EXPECT_EQ(tracker.update({at(-3.0, 0.0)}, turned, 0.1)[0].length, 2);
}

TEST(Tracker, TakesTheNearestWithinHalfAMetre) {
  Tracker tracker(TrackingParams::paper());
  (void)tracker.update({at(0.0, 3.0), at(0.9, 3.0)}, kRest, 0.0);
  const std::vector<Track> tracks = tracker.update({at(0.5, 3.0), at(0.0, 3.51)}, kRest, 0.1);
  EXPECT_EQ(tracks[0].id, 2);  // 0.4 m from the second, 0.5 m from the first
  EXPECT_EQ(tracks[1].id, 3);  // 0.51 m from the first
  EXPECT_EQ(tracks[1].length, 1);
}

TEST(Tracker, DoesNotDistinguishTypes) {
  Tracker tracker(TrackingParams::paper());
  (void)tracker.update({at(0.0, 3.0)}, kRest, 0.0);
  const Track track = tracker.update({at(0.1, 3.0, CandidateType::no_disparity)}, kRest, 0.1)[0];
  EXPECT_EQ(track.length, 2);
  EXPECT_EQ(track.candidate.type, CandidateType::no_disparity);
}

TEST(Tracker, LetsAllPartsOfASplitRegionInherit) {
  Tracker tracker(TrackingParams::paper());
  (void)tracker.update({at(0.0, 3.0)}, kRest, 0.0);
  const std::vector<Track> tracks = tracker.update({at(-0.3, 3.0), at(0.2, 3.0)}, kRest, 0.1);
  EXPECT_EQ(tracks[0].length, 2);
  EXPECT_EQ(tracks[1].length, 2);
  EXPECT_EQ(tracks[1].id, 1);  // the nearer part keeps the id
  EXPECT_EQ(tracks[0].id, 2);
}

TEST(Tracker, EndsATrackThatIsMissedInOneFrame) {
  Tracker tracker(TrackingParams::paper());
  (void)follow(tracker, 5, kStep);
  EXPECT_TRUE(tracker.update({}, kRest, 5 * kStep).empty());
  const Track again = tracker.update({at(0.0, 3.0)}, kRest, 6 * kStep)[0];
  EXPECT_EQ(again.length, 1);
  EXPECT_NE(again.id, 1);
}

TEST(Tracker, EndsAllTracksWhenTheMotionIsNotKnown) {
  Tracker tracker(TrackingParams::paper());
  (void)follow(tracker, 5, kStep);
  EXPECT_EQ(tracker.update({at(0.0, 3.0)}, std::nullopt, 5 * kStep)[0].length, 1);
}

TEST(Tracker, EndsAllTracksWithAFrameThatCouldNotBeProcessed) {
  Tracker tracker(TrackingParams::paper());
  (void)follow(tracker, 5, kStep);
  tracker.miss(5 * kStep);
  EXPECT_EQ(tracker.update({at(0.0, 3.0)}, kRest, 6 * kStep)[0].length, 1);
}

/// Walks 0.1 m a frame towards a candidate that is seen for five frames.
void walk_to(Tracker& tracker) {
  for (int i = 0; i < 5; ++i) (void)tracker.update({at(0.0, 3.0 - 0.1 * i)}, step_of(0.1), i * kStep);
}

// Without the motion the candidate would jump by a metre.
TEST(Tracker, TakesAMotionThatIsNotKnownToGoOn) {
  for (const int blind : {1, 3, 4}) {
    TrackingParams params;
    params.association_radius_m = 0.05;
    Tracker tracker(params);
    walk_to(tracker);
    for (int i = 0; i < blind; ++i) (void)tracker.update({at(0.0, 2.5 - 0.1 * i)}, std::nullopt, (5 + i) * kStep);
    const double z = 2.5 - 0.1 * blind;
    EXPECT_EQ(tracker.update({at(0.0, z)}, step_of(0.1), (5 + blind) * kStep)[0].length, blind <= 3 ? 6 + blind : 2) << blind;
  }
}

TEST(Tracker, ScalesTheMotionThatGoesOnByTheTime) {
  TrackingParams params;
  params.association_radius_m = 0.05;
  Tracker tracker(params);
  walk_to(tracker);
  EXPECT_EQ(tracker.update({at(0.0, 2.4)}, std::nullopt, 6 * kStep)[0].length, 6) << "0.2 m in two steps";
}

TEST(Tracker, OutlivesAFewFramesThatCouldNotBeProcessed) {
  for (const int failed : {1, 3, 4}) {
    Tracker tracker;
    walk_to(tracker);
    for (int i = 0; i < failed; ++i) tracker.miss((5 + i) * kStep);
    // The motion since the last frame that was processed.
    const Eigen::Isometry3d motion = step_of(0.1 * (failed + 1));
    const Track track = tracker.update({at(0.0, 2.6 - 0.1 * (failed + 1))}, motion, (5 + failed) * kStep)[0];
    EXPECT_EQ(track.length, failed <= 3 ? 6 : 1) << failed;
  }
}

// At 15 frames per second the third missed frame is 0.2 s after the last sighting: max_unseen_s = 0.2 bridges three, not four.
TEST(Tracker, BridgesShortGapsUnlessToldNotTo) {
  for (const int missed : {1, 3, 4}) {
    Tracker tracker;
    (void)follow(tracker, 5, kStep);
    for (int i = 0; i < missed; ++i) EXPECT_TRUE(tracker.update({}, step_of(0.1), (5 + i) * kStep).empty());
    const Track again = tracker.update({at(0.0, 3.0 - 0.1 * missed)}, kRest, (5 + missed) * kStep)[0];
    EXPECT_EQ(again.length, missed <= 3 ? 6 : 1) << missed;
    EXPECT_EQ(again.id == 1, missed <= 3) << missed;
  }
}

TEST(Tracker, FollowsARegionThatGrowsByItsRim) {
  Candidate small = at(0.0, 3.0);
  Candidate grown = at(0.0, 4.0);  // its far end came into view
  small.rim_nearest = grown.rim_nearest = {0.0, 1.6, 2.5};
  Tracker tracker;
  (void)tracker.update({small}, kRest, 0.0);
  EXPECT_EQ(tracker.update({grown}, kRest, 0.1)[0].length, 2);
  Tracker paper(TrackingParams::paper());
  (void)paper.update({small}, kRest, 0.0);
  EXPECT_EQ(paper.update({grown}, kRest, 0.1)[0].length, 1);
}

TEST(Tracker, TellsTheKindOfMostSightings) {
  constexpr ObstacleKind kHole = ObstacleKind::hole;
  constexpr ObstacleKind kEdge = ObstacleKind::edge;
  constexpr ObstacleKind kUnknown = ObstacleKind::unknown;
  const std::vector<ObstacleKind> seen{kUnknown, kEdge, kHole, kHole, kUnknown, kUnknown, kUnknown, kEdge, kEdge};
  // Not to know is no vote; of equally many the first in ObstacleKind.
  const std::vector<ObstacleKind> told{kUnknown, kEdge, kEdge, kHole, kHole, kHole, kHole, kEdge, kEdge};
  Tracker tracker;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    Candidate candidate = at(0.0, 3.0);
    candidate.kind = seen[i];
    const std::vector<Track> tracks = tracker.update({candidate}, kRest, static_cast<double>(i) * kStep);
    EXPECT_EQ(tracks[0].candidate.kind, told[i]) << i;
  }
}

/// A camera at 1.6 m that looks 40 degrees down, a hole of 1 x 1 m whose near rim is at that distance, and what is known of it.
struct HoleAhead {
  explicit HoleAhead(double distance_m) {
    view.camera = {.focal = 350.0, .cx = 319.5, .cy = 179.5, .baseline = 0.15};
    view.ground = compute_ground_pose(make_ground_plane(1.6, 40.0, 0.0, view.camera), view.camera);
    view.level = cv::Mat1b(360, 640, uchar{0});
    for (const auto& [x, z] : {std::pair{-0.5, 0.0}, {0.5, 0.0}, {0.5, 1.0}, {-0.5, 1.0}}) {
      hole.rim.emplace_back(view.ground.down * 1.6 + view.ground.right * x + view.ground.forward * (distance_m + z));
    }
    hole.rim_nearest = hole.centroid = 0.5 * (hole.rim[0] + hole.rim[1]);
    hole.depth_m = 1.0;
    hole.area_px = 8000;
    hole.measures = {.solid_angle_msr = 65.0, .sigmas = 20.0, .ground_misfit = 0.6, .roughness = 1.0};
  }
  /// The camera walks ahead along the ground.
  [[nodiscard]] Eigen::Isometry3d step(double metres) const {
    return Eigen::Isometry3d(Eigen::Translation3d(-metres * view.ground.forward));
  }
  FrameView view;
  Candidate hole;
};

/// Follows the hole over so many frames of a camera at rest.
void see(Tracker& tracker, const HoleAhead& ahead, int frames) {
  for (int i = 0; i < frames; ++i) (void)tracker.update({ahead.hole}, kRest, i * kStep, ahead.view);
}

TEST(Tracker, TellsAValidatedHoleWhileItIsHidden) {
  const HoleAhead ahead(2.0);
  Tracker tracker;
  see(tracker, ahead, 6);
  const std::vector<Track> hidden = tracker.update({}, ahead.step(0.1), 6 * kStep, ahead.view);
  ASSERT_EQ(hidden.size(), 1U);
  EXPECT_EQ(hidden[0].id, 1);
  EXPECT_TRUE(hidden[0].validated);
  EXPECT_NEAR(hidden[0].unseen_s, kStep, 1e-9);
  EXPECT_NEAR(hidden[0].candidate.distance_m, 1.9, 1e-6);
  EXPECT_NEAR(hidden[0].candidate.bearing_deg, 0.0, 0.1);
  EXPECT_NEAR(hidden[0].candidate.width_m, 1.0, 1e-6);
  // The middle of the opening lies within the contour.
  const Eigen::Vector3d middle = HoleAhead(1.9).hole.centroid + 0.5 * ahead.view.ground.forward;
  const Eigen::Vector3d pixel = ahead.view.camera.project(middle);
  const cv::Point2f at_middle(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
  EXPECT_GT(cv::pointPolygonTest(hidden[0].candidate.contour, at_middle, false), 0.0);
}

TEST(Tracker, ForgetsAHoleWhereTheGroundIsSeen) {
  const HoleAhead ahead(2.0);
  Tracker tracker;
  see(tracker, ahead, 6);
  FrameView level = ahead.view;
  level.level.setTo(255);
  EXPECT_TRUE(tracker.update({}, kRest, 6 * kStep, level).empty());
  for (int i = 7; i < 12; ++i) EXPECT_TRUE(tracker.update({}, kRest, i * kStep, level).empty());
  EXPECT_TRUE(tracker.update({}, kRest, 12 * kStep, ahead.view).empty()) << "forgotten, not only hidden";
}

// What is left of an opening at the lower border of the picture is the wall below its far rim, hardly lower than the ground.
TEST(Tracker, IsNotContradictedByTheFarWallOfAHoleThatLeavesThePicture) {
  const HoleAhead ahead(0.6);
  Tracker tracker;
  see(tracker, ahead, 6);
  FrameView level = ahead.view;
  level.level.setTo(255);
  const std::vector<Track> leaving = tracker.update({}, ahead.step(0.88), 6 * kStep, level);
  ASSERT_EQ(leaving.size(), 1U);
  EXPECT_GT(leaving[0].unseen_s, 0.0);
}

TEST(Tracker, TellsNothingOfAHoleThatIsOutOfView) {
  const HoleAhead ahead(1.0);
  Tracker tracker;
  see(tracker, ahead, 6);
  EXPECT_TRUE(tracker.update({}, ahead.step(2.5), 6 * kStep, ahead.view).empty());
  EXPECT_EQ(tracker.update({}, ahead.step(-2.5), 7 * kStep, ahead.view).size(), 1U) << "back in view";
}

TEST(Tracker, CoastsNoLongerThanItIsLikely) {
  HoleAhead ahead(2.0);
  ahead.hole.measures.solid_angle_msr = 12.0;
  ahead.hole.measures.sigmas = 13.1;
  const auto count_frames = [&](int sightings) {
    Tracker tracker;
    see(tracker, ahead, sightings);
    int frames = 0;
    while (frames < 100 && !tracker.update({}, kRest, (sightings + frames) * kStep, ahead.view).empty()) ++frames;
    return frames;
  };
  EXPECT_GT(count_frames(3), 0);
  EXPECT_GT(count_frames(6), count_frames(3));
  EXPECT_EQ(count_frames(60), 15) << "max_coast_s";
}

TEST(Tracker, CoastsNoLongerThanItWasSeen) {
  const HoleAhead ahead(2.0);
  for (const int sightings : {4, 7}) {
    Tracker tracker;
    see(tracker, ahead, sightings);
    int frames = 0;
    while (frames < 100 && !tracker.update({}, kRest, (sightings + frames) * kStep, ahead.view).empty()) ++frames;
    EXPECT_EQ(frames, sightings);
  }
}

TEST(Tracker, TellsOneOfTwoTracksOfOneOpening) {
  HoleAhead ahead(2.0);
  HoleAhead part = ahead;  // a fragment, near enough to be followed as its own
  part.hole.rim.resize(3);
  part.hole.rim_nearest = part.hole.centroid = ahead.hole.centroid + 0.6 * ahead.view.ground.forward;
  Tracker tracker;
  for (int i = 0; i < 6; ++i) (void)tracker.update({ahead.hole, part.hole}, kRest, i * kStep, ahead.view);
  EXPECT_EQ(tracker.update({ahead.hole}, kRest, 6 * kStep, ahead.view).size(), 1U);
}

TEST(Tracker, IsSurerOfALongTrackAndOfStrongEvidence) {
  const HoleAhead ahead(2.0);
  Tracker tracker;
  const double first = *tracker.update({ahead.hole}, kRest, 0.0, ahead.view)[0].probability;
  (void)tracker.update({ahead.hole}, kRest, kStep, ahead.view);
  const Track third = tracker.update({ahead.hole}, kRest, 2 * kStep, ahead.view)[0];
  EXPECT_GT(*third.probability, first);
  EXPECT_TRUE(third.validated) << "3 sightings";
  HoleAhead weak(2.0);
  weak.hole.measures = {.solid_angle_msr = 1.3, .sigmas = 6.0, .ground_misfit = 0.1, .roughness = 2.5};
  Tracker other;
  see(other, weak, 9);
  const Track tenth = other.update({weak.hole}, kRest, 9 * kStep, weak.view)[0];
  EXPECT_LT(*tenth.probability, 0.7);
  EXPECT_FALSE(tenth.validated);
}

TEST(Tracker, TellsNoProbabilityInThePapersMethod) {
  Tracker tracker(TrackingParams::paper());
  for (const Track& track : follow(tracker, 5, kStep)) EXPECT_FALSE(track.probability.has_value());
}

TEST(Tracker, KeepsTheRateWhenOneFrameIsLate) {
  Tracker tracker(TrackingParams::paper());
  (void)follow(tracker, 4, kStep);
  EXPECT_TRUE(tracker.update({at(0.0, 3.0)}, kRest, 3 * kStep + 1.0)[0].validated);
}

TEST(Tracker, RefusesTimesThatDoNotIncrease) {
  Tracker tracker(TrackingParams::paper());
  (void)tracker.update({}, kRest, 1.0);
  test::expect_line_with(test::error_of<std::invalid_argument>([&] { (void)tracker.update({}, kRest, 1.0); }),
                         "time = 1, must be after the last one, 1");
  test::expect_line_with(test::error_of<std::invalid_argument>([&] { tracker.miss(0.5); }),
                         "time = 0.5, must be after the last one, 1");
}

TEST(Tracker, RefusesParametersOutOfRange) {
  TrackingParams params;
  params.min_sightings = 0;
  test::expect_line_with(test::error_of<std::invalid_argument>([&] { const Tracker tracker(params); }),
                         "tracking.min_sightings = 0, must be 1 to 1000");
}

TEST(Tracker, HasNoTracksWithoutCandidates) {
  Tracker tracker(TrackingParams::paper());
  EXPECT_TRUE(tracker.update({}, std::nullopt, 0.0).empty());
}

}  // namespace
}  // namespace brink
