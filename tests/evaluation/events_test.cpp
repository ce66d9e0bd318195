#include <algorithm>

#include <gtest/gtest.h>

#include "evaluation/hand_made.hpp"

namespace brink {
namespace {

using test::at;
using test::make_detection;
using test::make_instance;
using test::make_truth;
using test::off;
using test::on;

// An approach with the true distance of each frame; the detector reports it in the frames told.
SequenceScore approach(const std::vector<double>& distances, const std::vector<int>& reported, double claimed_m = 2.0) {
  SequenceEvaluator evaluator("approach");
  for (int frame = 0; frame < static_cast<int>(distances.size()); ++frame) {
    const bool is_reported = std::ranges::find(reported, frame) != reported.end();
    evaluator.add(make_truth(frame, {make_instance(1, distances[static_cast<std::size_t>(frame)])}),
                  make_detection(frame, is_reported ? std::vector{on(1, claimed_m)} : std::vector<NegativeObstacle>{}));
  }
  return evaluator.finish();
}

TEST(Events, AreWarnedInTimeFromTwoMetres) {
  const SequenceScore score = approach({3.5, 3.0, 2.5, 2.0, 1.5, 1.0, 1.2}, {3, 5});
  ASSERT_EQ(score.events.size(), 1U);
  const ApproachEvent& event = score.events[0];
  EXPECT_EQ(event.id, 1);
  EXPECT_EQ(event.first_frame, 0);
  EXPECT_EQ(event.first_distance_m, 3.5);
  EXPECT_EQ(event.nearest_m, 1.0);
  EXPECT_EQ(event.warned_frame, 3);
  EXPECT_EQ(event.warned_distance_m, 2.0);
  EXPECT_DOUBLE_EQ(*event.lead_time_s, 2.0 / 15.0);  // nearest in frame 5
  EXPECT_TRUE(event.in_time);
}

TEST(Events, AreWarnedLateBelowTwoMetres) {
  const SequenceScore score = approach({3.5, 3.0, 2.5, 1.99, 1.5}, {3});
  EXPECT_EQ(score.events.at(0).warned_frame, 3);
  EXPECT_FALSE(score.events.at(0).in_time);
}

TEST(Events, AreMissedWithoutAnyDetection) {
  const ApproachEvent event = approach({3.5, 2.0, 1.0}, {}).events.at(0);
  EXPECT_FALSE(event.warned_frame.has_value());
  EXPECT_FALSE(event.warned_distance_m.has_value());
  EXPECT_FALSE(event.lead_time_s.has_value());
  EXPECT_FALSE(event.in_time);
}

TEST(Events, ThatBeginNearAreWarnedInTimeWithinHalfASecond) {
  // At 15 frames per second frame 7 comes after 0.467 s, frame 8 after 0.533 s.
  const std::vector<double> near(12, 1.9);
  EXPECT_TRUE(approach(near, {7}).events.at(0).in_time);
  EXPECT_FALSE(approach(near, {8}).events.at(0).in_time);
  std::vector<double> from_two_metres = near;
  from_two_metres[0] = 2.0;
  EXPECT_FALSE(approach(from_two_metres, {7}).events.at(0).in_time);
}

TEST(Events, CountHalfASecondItselfAsInTime) {
  ASSERT_GT(1.1 - 0.6, 0.5);  // in floating point
  SequenceEvaluator evaluator("10 frames per second, from 0.6 s");
  for (int frame = 6; frame <= 11; ++frame) {
    evaluator.add(make_truth(frame, {make_instance(1, 1.0)}, 10.0),
                  make_detection(frame, frame == 11 ? std::vector{on(1)} : std::vector<NegativeObstacle>{}));
  }
  EXPECT_TRUE(evaluator.finish().events.at(0).in_time);
}

TEST(Events, NeedADistanceBelowThreeMetres) {
  EXPECT_TRUE(approach({4.0, 3.0, 3.5}, {0}).events.empty());
  EXPECT_EQ(approach({4.0, 2.99, 3.5}, {0}).events.size(), 1U);
}

TEST(Events, AreWarnedByDetectionsBeyondTheRangeOfTheRates) {
  const SequenceScore score = approach({5.4, 4.0, 2.5}, {0}, 4.9);
  EXPECT_EQ(score.events.at(0).warned_distance_m, 5.4);
  EXPECT_TRUE(score.events.at(0).in_time);
  EXPECT_FALSE(approach({5.4, 4.0, 2.5}, {0}, 5.1).events.at(0).warned_frame.has_value());  // claims to be out of range
}

TEST(Events, HaveNoLeadTimeWhenWarnedAfterTheNearestPoint) {
  EXPECT_EQ(approach({1.9, 1.0, 1.5}, {2}).events.at(0).lead_time_s, 0.0);
  EXPECT_EQ(approach({1.9, 1.0, 1.5}, {1}).events.at(0).lead_time_s, 0.0);
}

TEST(Events, AreOneForEachApproach) {
  // Seen in frames 0 and 1, and again 15 frames (1 s) after.
  SequenceEvaluator evaluator("twice");
  for (const int frame : {0, 1, 16, 17}) {
    const std::vector<NegativeObstacle> reported = frame == 16 ? std::vector{on(1)} : std::vector<NegativeObstacle>{};
    evaluator.add(make_truth(frame, {make_instance(1, 2.5)}), make_detection(frame, reported));
  }
  const std::vector<ApproachEvent> events = evaluator.finish().events;
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].first_frame, 0);
  EXPECT_FALSE(events[0].warned_frame.has_value());
  EXPECT_EQ(events[1].first_frame, 16);
  EXPECT_EQ(events[1].warned_frame, 16);
}

TEST(Events, AreNoneForShallowOrUnmeasuredInstances) {
  SequenceEvaluator evaluator("none");
  VisibleInstance unmeasured = make_instance(2, 1.0);
  unmeasured.distance_m.reset();
  evaluator.add(make_truth(0, {make_instance(1, 1.0, 400, 0.1), unmeasured, make_instance(3, 1.0, 149)}),
                make_detection(0, {}));
  EXPECT_TRUE(evaluator.finish().events.empty());
}

// False alarms, each in a frame at a place in the world; the camera moves forward by 0.1 m a frame.
std::vector<Episode> episodes(const std::vector<std::pair<int, Eigen::Vector3d>>& alarms, int frames) {
  SequenceEvaluator evaluator("false alarms");
  for (int frame = 0; frame < frames; ++frame) {
    const Eigen::Vector3d camera(0.0, 0.0, 0.1 * frame);
    std::vector<NegativeObstacle> obstacles;
    for (const auto& [alarm_frame, place] : alarms) {
      if (alarm_frame == frame) obstacles.push_back(off(place - camera, frame));  // another id each time
    }
    evaluator.add(at(make_truth(frame, {}), camera), make_detection(frame, obstacles));
  }
  return evaluator.finish().episodes;
}

TEST(Episodes, JoinFalseAlarmsAtOnePlaceInTheWorldWhateverTheirIds) {
  const auto found = episodes({{0, {0, 1, 3}}, {1, {0, 1, 3}}, {2, {0.2, 1, 3}}}, 4);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].first_frame, 0);
  EXPECT_EQ(found[0].last_frame, 2);
  EXPECT_EQ(found[0].detections, 3);
  EXPECT_TRUE(found[0].place.isApprox(Eigen::Vector3d(0.2, 1, 3)));
}

TEST(Episodes, SplitBeyondHalfAMetre) {
  EXPECT_EQ(episodes({{0, {0, 1, 3}}, {1, {0.49, 1, 3}}}, 2).size(), 1U);
  EXPECT_EQ(episodes({{0, {0, 1, 3}}, {1, {0.51, 1, 3}}}, 2).size(), 2U);
}

TEST(Episodes, FollowAPlaceThatDrifts) {
  EXPECT_EQ(episodes({{0, {0, 1, 3}}, {1, {0.4, 1, 3}}, {2, {0.8, 1, 3}}}, 3).size(), 1U);
}

TEST(Episodes, GoOnAfterGapsOfUpToHalfASecond) {
  EXPECT_EQ(episodes({{0, {0, 1, 3}}, {7, {0, 1, 3}}}, 9).size(), 1U);  // 0.467 s
  EXPECT_EQ(episodes({{0, {0, 1, 3}}, {8, {0, 1, 3}}}, 9).size(), 2U);  // 0.533 s
}

TEST(Episodes, TakeTheNearestOfThoseThatAreOpen) {
  // Two of them, 0.9 m apart; the third alarm lies 0.48 m from one and 0.42 m from the other, both within 0.5 m.
  const auto second = episodes({{0, {0, 1, 3}}, {0, {0.9, 1, 3}}, {1, {0.48, 1, 3}}}, 2);
  ASSERT_EQ(second.size(), 2U);
  EXPECT_EQ(second[1].detections, 2);
  const auto first = episodes({{0, {0, 1, 3}}, {0, {0.9, 1, 3}}, {1, {0.42, 1, 3}}}, 2);
  ASSERT_EQ(first.size(), 2U);
  EXPECT_EQ(first[0].detections, 2);
}

TEST(Episodes, AreUnknownWithoutPoses) {
  SequenceEvaluator evaluator("no poses");
  evaluator.add(make_truth(0, {}), make_detection(0, {off()}));
  const SequenceScore score = evaluator.finish();
  EXPECT_TRUE(score.frames[0].detections[0].settled_false);
  EXPECT_FALSE(score.frames[0].detections[0].episode.has_value());
  EXPECT_TRUE(score.episodes.empty());
  EXPECT_FALSE(score.walked_m.has_value());
}

TEST(Episodes, AreNamedByTheirDetections) {
  SequenceEvaluator evaluator("episode index");
  evaluator.add(at(make_truth(0, {make_instance(1, 2.0)}), {0, 0, 0}),
                make_detection(0, {on(1), off({0, 1, 2}), off({2, 1, 2})}));
  const auto detections = evaluator.finish().frames[0].detections;
  EXPECT_FALSE(detections[0].episode.has_value());  // on what has just appeared: don't care, no false alarm
  EXPECT_EQ(detections[1].episode, 0);
  EXPECT_EQ(detections[2].episode, 1);
}

}  // namespace
}  // namespace brink
