#include <numbers>
#include <stdexcept>
#include <utility>

#include <gtest/gtest.h>

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
