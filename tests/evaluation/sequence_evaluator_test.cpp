#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "evaluation/hand_made.hpp"
#include "expect_error.hpp"

namespace brink {
namespace {

using test::at;
using test::make_detection;
using test::make_instance;
using test::make_obstacle;
using test::make_truth;
using test::off;
using test::on;

using Instances = std::vector<VisibleInstance>;

FrameScore score_frame(const Instances& instances, const std::vector<NegativeObstacle>& obstacles) {
  SequenceEvaluator evaluator("one frame");
  evaluator.add(make_truth(0, instances), make_detection(0, obstacles));
  return evaluator.finish().frames.at(0);
}

void expect_counts(const Counts& counts, int tp, int fn, int fp) {
  EXPECT_EQ(counts.tp, tp);
  EXPECT_EQ(counts.fn, fn);
  EXPECT_EQ(counts.fp, fp);
}

TEST(RawRates, CountHitsMissesAndFalseAlarms) {
  const FrameScore score = score_frame({make_instance(1, 2.0), make_instance(2, 3.0)}, {on(1), off()});
  expect_counts(score.raw(), 1, 1, 1);
  EXPECT_TRUE(score.instances[0].hit);
  EXPECT_FALSE(score.instances[1].hit);
  EXPECT_EQ(score.detections[0].hits, std::vector<int>{1});
  EXPECT_TRUE(score.detections[1].raw_false);
}

TEST(RawRates, LeaveOutWhatIsSmallShallowOrFarAndDetectionsOnIt) {
  const double nearly_deep = 0.1499;
  for (const VisibleInstance& instance :
       {make_instance(1, 2.0, 149), make_instance(1, 2.0, 400, nearly_deep), make_instance(1, 5.0001)}) {
    const FrameScore score = score_frame({instance}, {on(1)});
    expect_counts(score.raw(), 0, 0, 0);
    EXPECT_EQ(score.detections.at(0).hits, std::vector<int>{1});  // told all the same
  }
}

TEST(RawRates, CountTheLimitsThemselves) {
  for (const VisibleInstance& instance :
       {make_instance(1, 2.0, 150), make_instance(1, 2.0, 400, 0.15), make_instance(1, 5.0)}) {
    expect_counts(score_frame({instance}, {}).raw(), 0, 1, 0);
  }
}

TEST(RawRates, TakeUnknownDepthAsDeepAndUnknownDistanceAsNear) {
  VisibleInstance instance = make_instance(1, 2.0);
  instance.depth_m.reset();
  instance.distance_m.reset();
  expect_counts(score_frame({instance}, {on(1)}).raw(), 1, 0, 0);
}

TEST(RawRates, LeaveOutDetectionsThatClaimToBeFartherThanTheRange) {
  const FrameScore score = score_frame({make_instance(1, 2.0)}, {on(1, 5.0001), make_obstacle({40, 50, 10, 10}, 6.0)});
  expect_counts(score.raw(), 0, 1, 0);
  EXPECT_TRUE(score.detections.empty());
  expect_counts(score_frame({make_instance(1, 2.0)}, {on(1, 5.0)}).raw(), 1, 0, 0);
}

TEST(RawRates, ReportFragmentsApart) {
  const FrameScore score = score_frame({make_instance(1, 2.0)}, {on(1), make_obstacle({0, 0, 5, 20}, 2.0, 2)});
  expect_counts(score.raw(), 1, 0, 0);
  EXPECT_EQ(score.fragments, 1);
}

// One instance per frame, seen or not; returns for each frame whether it counts in the settled rates.
std::string settled_frames(const std::vector<double>& distances, const std::vector<int>& frames) {
  SequenceEvaluator evaluator("settling");
  for (std::size_t i = 0; i < frames.size(); ++i) {
    evaluator.add(make_truth(frames[i], {make_instance(1, distances[i])}), make_detection(frames[i], {}));
  }
  std::string settled;
  for (const FrameScore& frame : evaluator.finish().frames) settled += frame.instances.at(0).settled ? 'y' : 'n';
  return settled;
}

std::string settled_frames(const std::vector<int>& frames) {
  return settled_frames(std::vector<double>(frames.size(), 3.0), frames);
}

TEST(SettledRates, LeaveOutTheFirstSixFramesAt15PerSecond) {
  // 0.35 s x 15 = 5.25: frames 0 to 5 lie within it (0.333 s), frame 6 does not (0.4 s).
  EXPECT_EQ(settled_frames({0, 1, 2, 3, 4, 5, 6, 7}), "nnnnnnyy");
}

TEST(SettledRates, CountFromExactlyTheSettlingTime) {
  SequenceEvaluator evaluator("20 frames per second");  // frame 7 comes after 0.35 s
  for (int frame = 0; frame <= 7; ++frame) {
    evaluator.add(make_truth(frame, {make_instance(1, 3.0)}, 20.0), make_detection(frame, {}));
  }
  const SequenceScore score = evaluator.finish();
  EXPECT_FALSE(score.frames[6].instances[0].settled);
  EXPECT_TRUE(score.frames[7].instances[0].settled);
}

TEST(SettledRates, BeginWhereTheInstanceComesWithinEightMetres) {
  // From frame 0 at 7.9 m; within 5 m, where it counts, it is settled at once. What is farther than 8 m has not appeared.
  EXPECT_EQ(settled_frames({7.9, 7.9, 7.9, 7.9, 7.9, 7.9, 5.0, 5.1}, {0, 1, 2, 3, 4, 5, 6, 7}), "nnnnnnyn");
  EXPECT_EQ(settled_frames({8.1, 8.1, 8.1, 8.1, 8.1, 8.1, 5.0, 5.0}, {0, 1, 2, 3, 4, 5, 6, 7}), "nnnnnnnn");
}

TEST(SettledRates, GoOnAfterLessThanOneSecondOutOfView) {
  EXPECT_EQ(settled_frames({0, 6, 6 + 14, 7 + 14}), "nyyy");  // 14 frames = 0.93 s
}

TEST(SettledRates, BeginAnewAfterOneSecondOutOfView) {
  EXPECT_EQ(settled_frames({0, 6, 6 + 15, 6 + 15 + 5, 6 + 15 + 6}), "nynny");  // 15 frames = 1.00 s
  EXPECT_EQ(settled_frames({0, 6, 6 + 16, 6 + 16 + 5, 6 + 16 + 6}), "nynny");  // 16 frames = 1.07 s
}

TEST(SettledRates, TakeWhatHasJustAppearedAsDoNotCare) {
  // Frame 0: neither a miss nor, with a detection on it, a hit. A detection elsewhere is as wrong as ever.
  const FrameScore score = score_frame({make_instance(1, 2.0), make_instance(2, 2.0)}, {on(1), off()});
  expect_counts(score.raw(), 1, 1, 1);
  expect_counts(score.settled(), 0, 0, 1);
}

TEST(SettledRates, ApplyTheRulesWithTheirOwnInstances) {
  // One region of columns 10..44 over instance 1 (columns 0..19, settled) and 2 (columns 25..44, just appeared): 10 and 20 of
  // its 35 columns. Raw: more than half on 2; the gap of 5 px is all in U, and 10 of the 20 columns of 1 are covered: both are
  // hit. Settled: 15 of 35 columns on 1 dilated, IoU = 10 / 45 < 0.25: missed. More than half lies on 2, "don't care": no FP.
  SequenceEvaluator evaluator("handrail");
  for (int frame = 0; frame < 6; ++frame) {
    evaluator.add(make_truth(frame, {make_instance(1, 2.0)}), make_detection(frame, {}));
  }
  evaluator.add(make_truth(6, {make_instance(1, 2.0), make_instance(2, 2.0)}),
                make_detection(6, {make_obstacle({10, 0, 35, 20}, 2.0)}));
  const FrameScore score = evaluator.finish().frames.back();
  expect_counts(score.raw(), 2, 0, 0);
  expect_counts(score.settled(), 0, 1, 0);
}

TEST(Reachable, IsAnInstanceFromItsFifthFrameInARow) {
  SequenceEvaluator evaluator("sightings");
  std::string reachable;
  for (const int frame : {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10}) {
    const bool is_seen = frame != 5;
    evaluator.add(make_truth(frame, is_seen ? Instances{make_instance(1, 2.0)} : Instances{}), make_detection(frame, {}));
  }
  for (const FrameScore& frame : evaluator.finish().frames) {
    reachable += frame.instances.empty() ? '-' : (frame.instances[0].reachable ? 'y' : 'n');
  }
  EXPECT_EQ(reachable, "nnnny-nnnny");  // a frame without it ends a track
}

TEST(Localisation, IsClaimedLessTrue) {
  VisibleInstance instance = make_instance(1, 2.0);
  instance.bearing_deg = -179.0;
  NegativeObstacle obstacle = on(1, 1.75);
  obstacle.candidate.bearing_deg = 179.0;
  const DetectionScore score = score_frame({instance}, {obstacle}).detections.at(0);
  EXPECT_EQ(score.distance_m, 1.75);
  EXPECT_EQ(score.distance_error_m, -0.25);
  EXPECT_EQ(score.bearing_error_deg, -2.0);  // from -179 to 179 degrees is 2 degrees to the left
}

TEST(Localisation, TakesTheHitInstanceWhoseDistanceFitsBest) {
  // One region over instances at 2 and 3 m, claimed at 2.75 m: 0.25 m before the second, with that one's bearing.
  Instances instances = {make_instance(1, 2.0), make_instance(2, 3.0)};
  instances[1].bearing_deg = 10.0;
  const DetectionScore score = score_frame(instances, {make_obstacle({0, 0, 45, 20}, 2.75)}).detections.at(0);
  EXPECT_EQ(score.hits, (std::vector<int>{1, 2}));
  EXPECT_EQ(score.distance_error_m, -0.25);
  EXPECT_EQ(score.bearing_error_deg, -10.0);
}

TEST(Localisation, IsUnknownWithoutAHitOrATrueDistance) {
  VisibleInstance unmeasured = make_instance(1, 2.0);
  unmeasured.distance_m.reset();
  const FrameScore score = score_frame({unmeasured}, {on(1), off()});
  for (const DetectionScore& detection : score.detections) {
    EXPECT_FALSE(detection.distance_error_m.has_value());
    EXPECT_FALSE(detection.bearing_error_deg.has_value());
  }
}

TEST(WalkedLength, LeavesOutTheBobbingOfTheHead) {
  // 10 frames per second, 0.12 m forward each; the head is 0.05 m up but in every fifth frame. Samples every 0.5 s see two
  // straight pieces of 0.6 m; frame 11 adds sqrt(0.12^2 + 0.05^2) = 0.13 m as the last piece.
  SequenceEvaluator evaluator("walk");
  for (int frame = 0; frame <= 11; ++frame) {
    const Eigen::Vector3d camera(0.0, frame % 5 == 0 ? 0.0 : -0.05, 0.12 * frame);
    evaluator.add(at(make_truth(frame, {}, 10.0), camera), make_detection(frame, {}));
    if (frame == 10) {
      EXPECT_NEAR(*evaluator.finish().walked_m, 1.2, 1e-12);
    }
  }
  EXPECT_NEAR(*evaluator.finish().walked_m, 1.33, 1e-12);
}

TEST(WalkedLength, IsNothingForOneFrame) {
  SequenceEvaluator evaluator("one");
  evaluator.add(at(make_truth(0, {}), {1, 2, 3}), make_detection(0, {}));
  EXPECT_EQ(evaluator.finish().walked_m, 0.0);
}

TEST(Duration, IsFramesTimesTheMedianStep) {
  SequenceEvaluator evaluator("with a gap");
  for (const int frame : {0, 1, 2, 3, 30}) evaluator.add(make_truth(frame, {}, 10.0), make_detection(frame, {}));
  EXPECT_NEAR(evaluator.finish().duration_s, 0.5, 1e-12);
}

TEST(SequenceEvaluator, HasNothingToTellBeforeTheFirstFrame) {
  const SequenceScore score = SequenceEvaluator("empty").finish();
  EXPECT_EQ(score.name, "empty");
  EXPECT_EQ(score.duration_s, 0.0);
  EXPECT_FALSE(score.walked_m.has_value());
  EXPECT_TRUE(score.frames.empty());
}

TEST(SequenceEvaluator, CountsFramesThatFailedAsMisses) {
  SequenceEvaluator evaluator("no picture");
  evaluator.add(make_truth(0, {make_instance(1, 2.0)}), make_failed_detection(0, 0.0, FrameStatus::no_picture, "missing"));
  const FrameScore score = evaluator.finish().frames[0];
  EXPECT_EQ(score.status, FrameStatus::no_picture);
  expect_counts(score.raw(), 0, 1, 0);
}

TEST(SequenceEvaluator, AcceptsAPictureOfOnePixel) {
  EvaluationParams params;
  params.min_visible_px = 1;
  SequenceEvaluator evaluator("small", params);
  FrameTruth truth;
  truth.negative = cv::Mat1b(1, 1, uchar{1});
  truth.instances = {make_instance(1, 2.0, 1)};
  evaluator.add(truth, make_detection(0, {make_obstacle({0, 0, 1, 1}, 2.0)}));
  expect_counts(evaluator.finish().frames[0].raw(), 1, 0, 0);
}

std::string refusal(const FrameTruth& truth, const Detection& detection) {
  SequenceEvaluator evaluator("walk");
  evaluator.add(make_truth(3, {}), make_detection(3, {}));
  return test::error_of<std::invalid_argument>([&] { evaluator.add(truth, detection); });
}

TEST(SequenceEvaluator, RefusesDetectionsOfAnotherFrame) {
  test::expect_line_with(refusal(make_truth(4, {}), make_detection(5, {})),
                         "walk: detection of frame = 5, must be that of the");
}

TEST(SequenceEvaluator, RefusesFramesAndTimesThatDoNotIncrease) {
  test::expect_line_with(refusal(make_truth(3, {}), make_detection(3, {})), "walk: frame = 3, must be above the one before, 3");
  FrameTruth truth = make_truth(4, {});
  truth.time = 0.2;  // that of frame 3
  test::expect_line_with(refusal(truth, make_detection(4, {})), "walk: frame 4: time = 0.2 s, must be above");
  truth.time = std::numeric_limits<double>::quiet_NaN();
  test::expect_line_with(refusal(truth, make_detection(4, {})), "walk: frame 4: time = nan s, must be above");
}

TEST(SequenceEvaluator, RefusesContoursThatLeaveThePicture) {
  const std::string message = refusal(make_truth(4, {}), make_detection(4, {make_obstacle({95, 0, 7, 5}, 2.0, 8)}));
  test::expect_line_with(message, "walk: frame 4: contour point of obstacle 8 = (101, 0), must be in the 101x81 picture");
}

TEST(EvaluationParams, AreRefusedByNameAndValue) {
  EvaluationParams params;
  params.block_frames = 0;
  test::expect_line_with(test::error_of<std::invalid_argument>([&] { SequenceEvaluator("x", params); }),
                         "evaluation.block_frames = 0, must be 1 to");
  params = {};
  params.first_range_m = 4.0;  // would leave out instances that count
  test::expect_line_with(test::error_of<std::invalid_argument>([&] { params.validate(); }),
                         "evaluation.first_range_m = 4, must be max_range_m to 1000");
  params = {};
  params.settle_s = std::numeric_limits<double>::quiet_NaN();
  test::expect_line_with(test::error_of<std::invalid_argument>([&] { params.validate(); }), "evaluation.settle_s = nan");
}

TEST(SequenceEvaluator, TellsTheKindOfWhatADetectionHits) {
  VisibleInstance hole = make_instance(1, 2.0);
  VisibleInstance stairs = make_instance(2, 2.0);
  hole.kind = ObstacleKind::hole;
  stairs.kind = ObstacleKind::stairs_down;
  const VisibleInstance other = make_instance(3, 2.0);  // of a kind that is not known
  NegativeObstacle told = on(1);
  told.candidate.kind = ObstacleKind::edge;
  const cv::Rect over_both = test::place_of(1) | test::place_of(2);
  SequenceEvaluator evaluator("walk");
  evaluator.add(make_truth(0, {hole, stairs, other}),
                make_detection(0, {told, on(2), on(3), off(), make_obstacle(over_both, 2.0)}));
  const std::vector<DetectionScore> scores = evaluator.finish().frames[0].detections;
  EXPECT_EQ(scores[0].kind, ObstacleKind::edge);
  EXPECT_EQ(scores[0].true_kind, ObstacleKind::hole);
  EXPECT_EQ(scores[1].true_kind, ObstacleKind::stairs_down);
  EXPECT_FALSE(scores[2].true_kind.has_value());
  EXPECT_FALSE(scores[3].true_kind.has_value());
  EXPECT_FALSE(scores[4].true_kind.has_value());  // it hits two kinds
}

}  // namespace
}  // namespace brink
