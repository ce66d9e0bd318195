// Detectors whose scores can be told beforehand, on a walk that is made by hand.
//
// The camera looks straight down on a plan: 81x121 px of 0.05 m, its foot at the middle of the lowest row. It walks 0.1 m = 2
// px a frame, 15 frames a second, towards two openings whose near rims lie 4.55 m ahead in frame 0 and 0.55 m in frame 40:
//   1, a hole 1 m wide and long: columns 10..29, 20 rows;   2, a trench 0.4 m wide, 1 m long: columns 50..57, 20 rows.
// Near rim of frame i: row 29 + 2 i. All 20 rows are in the picture always: 400 and 160 px, both at least 150.
//
// Raw: 41 frames x 2 = 82 instances, all within 5 m. Settled: without the first 0.35 s, frames 0 to 5: 35 x 2 = 70.
// Ceiling: 1 - 4 / 41 for each, 74 / 82. Events: both, as they come nearer than 3 m.

#include <functional>

#include <gtest/gtest.h>

#include "evaluation/hand_made.hpp"

namespace brink {
namespace {

constexpr int kFrames = 41;
constexpr double kPixel = 0.05;  // m
constexpr double kStep = 0.1;    // m per frame
const cv::Size kPicture(81, 121);

double true_distance(int frame) { return 4.55 - kStep * frame; }

cv::Rect opening(int id, int frame) { return {id == 1 ? 10 : 50, 10 + 2 * frame, id == 1 ? 20 : 8, 20}; }

FrameTruth truth_of(int frame) {
  FrameTruth truth;
  truth.frame = frame;
  truth.time = frame / test::kRate;
  truth.negative = cv::Mat1b(kPicture, uchar{0});
  for (const int id : {1, 2}) {
    truth.negative(opening(id, frame)).setTo(id);
    truth.instances.push_back(test::make_instance(id, true_distance(frame), opening(id, frame).area()));
  }
  return test::at(truth, {0.0, 0.0, kStep * frame});
}

NegativeObstacle report(int id, const cv::Rect& area, double distance_m) {
  NegativeObstacle obstacle = test::make_obstacle(area, distance_m, id);
  obstacle.candidate.rim_nearest = {(area.x + area.width / 2.0 - kPicture.width / 2.0) * kPixel, 1.0, distance_m};
  return obstacle;
}

SequenceScore run(const std::function<std::vector<NegativeObstacle>(int)>& detector) {
  SequenceEvaluator evaluator("plan");
  for (int frame = 0; frame < kFrames; ++frame) evaluator.add(truth_of(frame), test::make_detection(frame, detector(frame)));
  return evaluator.finish();
}

void expect_counts(const Counts& counts, int tp, int fn, int fp) {
  EXPECT_EQ(counts.tp, tp);
  EXPECT_EQ(counts.fn, fn);
  EXPECT_EQ(counts.fp, fp);
}

TEST(SyntheticDetector, ThatReportsNothingMissesAll) {
  const SequenceScore score = run([](int) { return std::vector<NegativeObstacle>{}; });
  const EvaluationSummary summary = summarise({score});
  expect_counts(summary.raw, 0, 82, 0);
  expect_counts(summary.settled, 0, 70, 0);
  EXPECT_EQ(summary.raw_tpr->value, 0.0);
  EXPECT_FALSE(summary.raw_ppv.has_value());
  EXPECT_EQ(*summary.raw_ceiling, 74.0 / 82.0);
  EXPECT_EQ(summary.events, 2);
  EXPECT_EQ(summary.missed, 2);
  EXPECT_EQ(summary.warned_in_time->value, 0.0);
  EXPECT_EQ(summary.episodes, 0);
  EXPECT_EQ(summary.localised, 0);
  EXPECT_NEAR(*score.walked_m, 4.0, 1e-12);
  EXPECT_NEAR(score.duration_s, 41.0 / 15.0, 1e-12);
}

TEST(SyntheticDetector, ThatReportsEverythingHitsNothing) {
  // The whole picture has 9801 px: IoU with the hole is 400 / 9801, and of the picture only (30x30 + 18x30) / 9801, 15 %, lies
  // in U. So each frame has an FP. Its place is 1 m ahead of the camera: it moves by 0.1 m a frame, which is one episode.
  const SequenceScore score = run([](int) { return std::vector{report(1, {0, 0, 81, 121}, 1.0)}; });
  const EvaluationSummary summary = summarise({score});
  expect_counts(summary.raw, 0, 82, 41);
  expect_counts(summary.settled, 0, 70, 41);
  EXPECT_EQ(summary.raw_tpr->value, 0.0);
  EXPECT_EQ(summary.raw_ppv->value, 0.0);
  EXPECT_EQ(summary.missed, 2);
  ASSERT_EQ(summary.episodes, 1);
  EXPECT_EQ(score.episodes[0].detections, 41);
  EXPECT_NEAR(summary.episodes_per_minute->value, 60.0 / (41.0 / 15.0), 1e-9);
  EXPECT_NEAR(summary.episodes_per_100m->value, 100.0 / 4.0, 1e-9);
}

TEST(SyntheticDetector, ThatReportsTheTruthIsPerfect) {
  const SequenceScore score = run([](int frame) {
    return std::vector{report(1, opening(1, frame), true_distance(frame)), report(2, opening(2, frame), true_distance(frame))};
  });
  const EvaluationSummary summary = summarise({score});
  expect_counts(summary.raw, 82, 0, 0);
  expect_counts(summary.settled, 70, 0, 0);
  EXPECT_EQ(summary.fragments, 0);
  EXPECT_EQ(summary.settled_tpr->value, 1.0);
  EXPECT_EQ(summary.settled_ppv->value, 1.0);
  EXPECT_EQ(summary.warned_in_time->value, 1.0);
  EXPECT_EQ(summary.missed + summary.late, 0);
  EXPECT_DOUBLE_EQ(*summary.first_warning_min_m, 4.55);
  EXPECT_DOUBLE_EQ(*summary.lead_time_min_s, 40.0 / 15.0);
  EXPECT_EQ(summary.localised, 82);
  EXPECT_EQ(*summary.distance_error_p95_m, 0.0);
  EXPECT_EQ(summary.episodes, 0);
}

TEST(SyntheticDetector, ThatIsHalfAMetreToTheSideStillHitsWhatIsAMetreWide) {
  // 0.5 m = 10 px to the right. Hole: 15 of the detection's 20 columns lie on the mask dilated by 5 px: a hit, IoU = 1 / 3.
  // Trench: 3 of 8 columns on the dilated mask, none on the mask: a miss, and an FP also before it is settled, as less than
  // half lies on "don't care". That FP stays at one place in the world: one episode of 41 detections. Distances are right.
  const SequenceScore score = run([](int frame) {
    const cv::Point shift(10, 0);
    return std::vector{report(1, opening(1, frame) + shift, true_distance(frame)),
                       report(2, opening(2, frame) + shift, true_distance(frame))};
  });
  const EvaluationSummary summary = summarise({score});
  expect_counts(summary.raw, 41, 41, 41);
  expect_counts(summary.settled, 35, 35, 41);
  EXPECT_EQ(summary.raw_tpr->value, 0.5);
  EXPECT_EQ(summary.raw_ppv->value, 0.5);
  EXPECT_EQ(summary.events, 2);
  EXPECT_EQ(summary.missed, 1);
  EXPECT_EQ(summary.warned_in_time->value, 0.5);
  ASSERT_EQ(summary.episodes, 1);
  EXPECT_EQ(score.episodes[0].detections, 41);
  EXPECT_EQ(summary.localised, 41);
  EXPECT_EQ(*summary.distance_error_p95_m, 0.0);
}

TEST(SyntheticDetector, ThatIsHalfAMetreTooFarHitsWithThatError) {
  // 10 px up, away from the camera: 15 of 20 rows of each lie on the dilated masks. Claims of 5 m and more do not count: the
  // true distance 4.55 m of frame 0 is claimed as 5.05 m, so frame 0 has two misses; the others are off by 0.5 m.
  const SequenceScore score = run([](int frame) {
    const cv::Point shift(0, -10);
    return std::vector{report(1, opening(1, frame) + shift, true_distance(frame) + 0.5),
                       report(2, opening(2, frame) + shift, true_distance(frame) + 0.5)};
  });
  const EvaluationSummary summary = summarise({score});
  expect_counts(summary.raw, 80, 2, 0);
  expect_counts(summary.settled, 70, 0, 0);
  EXPECT_DOUBLE_EQ(*summary.first_warning_min_m, 4.45);
  EXPECT_NEAR(*summary.distance_error_median_m, 0.5, 1e-12);
  EXPECT_NEAR(*summary.distance_error_p95_m, 0.5, 1e-12);
}

TEST(SyntheticDetector, ThatIsFiveFramesLateMissesFiveFramesAndIsOffByFiveSteps) {
  // What it says in frame i is true of frame i - 5: 10 px and 0.5 m farther than the truth. 15 of 20 rows lie on the dilated
  // masks: hits from frame 5 on, 36 x 2; frames 0 to 4 are 10 misses in the raw rates, which take in frames that no tracker can
  // have (the ceiling is 74 / 82), and lie before the settled ones begin.
  const SequenceScore score = run([](int frame) -> std::vector<NegativeObstacle> {
    if (frame < 5) return {};
    return {report(1, opening(1, frame - 5), true_distance(frame - 5)),
            report(2, opening(2, frame - 5), true_distance(frame - 5))};
  });
  const EvaluationSummary summary = summarise({score});
  expect_counts(summary.raw, 72, 10, 0);
  expect_counts(summary.settled, 70, 0, 0);
  EXPECT_EQ(summary.raw_tpr->value, 72.0 / 82.0);
  EXPECT_EQ(summary.settled_tpr->value, 1.0);
  EXPECT_EQ(summary.warned_in_time->value, 1.0);
  EXPECT_NEAR(*summary.first_warning_min_m, 4.05, 1e-12);
  EXPECT_NEAR(*summary.lead_time_median_s, 35.0 / 15.0, 1e-12);
  EXPECT_NEAR(*summary.distance_error_median_m, 0.5, 1e-12);
  EXPECT_EQ(summary.episodes, 0);
}

TEST(SyntheticDetector, ThatValidatesAtTheFifthSightingReachesTheCeiling) {
  const EvaluationSummary summary = summarise({run([](int frame) -> std::vector<NegativeObstacle> {
    if (frame < 4) return {};
    return {report(1, opening(1, frame), true_distance(frame)), report(2, opening(2, frame), true_distance(frame))};
  })});
  EXPECT_EQ(summary.raw_tpr->value, 1.0 - 4.0 / 41.0);
  EXPECT_EQ(summary.raw_tpr->value, *summary.raw_ceiling);
  EXPECT_EQ(summary.settled_tpr->value, 1.0);
}

}  // namespace
}  // namespace brink
