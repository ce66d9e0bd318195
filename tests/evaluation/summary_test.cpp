#include <limits>
#include <optional>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "brink/evaluation.hpp"
#include "brink/evaluation_report.hpp"
#include "expect_error.hpp"

namespace brink {
namespace {

InstanceScore make_instance(bool hit, double distance_m = 2.0) {
  InstanceScore instance;
  instance.id = 1;
  instance.distance_m = distance_m;
  instance.raw = true;
  instance.settled = true;
  instance.reachable = true;
  instance.hit = hit;
  instance.settled_hit = hit;
  return instance;
}

DetectionScore make_false_alarm() {
  DetectionScore detection;
  detection.raw_false = true;
  detection.settled_false = true;
  return detection;
}

/// A sequence of so many frames, 15 a second, with instances and false alarms dealt out to them in turn.
SequenceScore make_sequence(int frames, int hits, int misses, int false_alarms) {
  SequenceScore sequence;
  sequence.frames.resize(static_cast<std::size_t>(frames));
  sequence.duration_s = frames / 15.0;
  for (int i = 0; i < frames; ++i) {
    sequence.frames[static_cast<std::size_t>(i)].frame = i;
    sequence.frames[static_cast<std::size_t>(i)].time = i / 15.0;
  }
  for (int i = 0; i < hits + misses; ++i) {
    sequence.frames[static_cast<std::size_t>(i % frames)].instances.push_back(make_instance(i < hits));
  }
  for (int i = 0; i < false_alarms; ++i) {
    sequence.frames[static_cast<std::size_t>(i % frames)].detections.push_back(make_false_alarm());
  }
  return sequence;
}

TEST(Summary, ReproducesThePapersRatesFromItsCounts) {
  // Frames, TP, FN = instances - TP, and FP of the paper's three sequences.
  const SequenceScore s1 = make_sequence(213, 230, 253 - 230, 56);
  const SequenceScore s2 = make_sequence(300, 160, 170 - 160, 20);
  const SequenceScore s3 = make_sequence(277, 446, 501 - 446, 39);
  const EvaluationSummary pooled = summarise({s1, s2, s3});
  EXPECT_EQ(pooled.frames, 790);
  EXPECT_EQ(pooled.instances, 924);
  EXPECT_EQ(pooled.raw.fn, 88);
  EXPECT_NEAR(pooled.raw_tpr->value, 0.905, 0.0005);  // 836 / 924
  EXPECT_NEAR(pooled.raw_ppv->value, 0.879, 0.0005);  // 836 / 951
  // The paper prints 0.82 and 0.87 for S1, which its own counts are not.
  EXPECT_NEAR(summarise({s1}).raw_tpr->value, 0.909, 0.0005);  // 230 / 253
  EXPECT_NEAR(summarise({s1}).raw_ppv->value, 0.804, 0.0005);  // 230 / 286
  EXPECT_NEAR(summarise({s2}).raw_tpr->value, 0.941, 0.0005);  // 160 / 170
  EXPECT_NEAR(summarise({s2}).raw_ppv->value, 0.889, 0.0005);  // 160 / 180
  EXPECT_NEAR(summarise({s3}).raw_tpr->value, 0.890, 0.0005);  // 446 / 501
  EXPECT_NEAR(summarise({s3}).raw_ppv->value, 0.920, 0.0005);  // 446 / 485
}

TEST(Summary, CountsTheKindsThatAreToldOfEachTrueKind) {
  SequenceScore sequence = make_sequence(1, 0, 0, 0);
  const auto add = [&](std::optional<ObstacleKind> truth, std::optional<ObstacleKind> told, int times) {
    DetectionScore detection;
    detection.true_kind = truth;
    detection.kind = told;
    for (int i = 0; i < times; ++i) sequence.frames[0].detections.push_back(detection);
  };
  EXPECT_FALSE(summarise({sequence}).kind_accuracy.has_value());
  add(ObstacleKind::hole, ObstacleKind::hole, 5);
  add(ObstacleKind::hole, ObstacleKind::unknown, 1);
  add(ObstacleKind::edge, ObstacleKind::stairs_down, 2);
  add(std::nullopt, ObstacleKind::hole, 7);  // hits nothing
  add(ObstacleKind::hole, std::nullopt, 9);  // of an older version
  const EvaluationSummary summary = summarise({sequence});
  EXPECT_EQ(summary.kinds.size(), 2U);
  EXPECT_EQ(summary.kinds.at("hole"), (std::map<std::string, int>{{"hole", 5}, {"unknown", 1}}));
  EXPECT_EQ(summary.kinds.at("edge"), (std::map<std::string, int>{{"stairs_down", 2}}));
  EXPECT_EQ(summary.kind_accuracy, 5.0 / 8.0);
  const std::string text = to_text({sequence});
  EXPECT_NE(text.find("| hole | 0 | 0 | 5 | 1 | 0.833 |\n"), std::string::npos) << text;
  EXPECT_NE(text.find("| edge | 2 | 0 | 0 | 0 | 0.000 |\n"), std::string::npos) << text;
}

TEST(Summary, TellsTheCeilingOfATrackerThatNeedsFiveSightings) {
  // One approach of 20 frames within 5 m, of which the first four cannot be validated: 1 - 4 / 20.
  SequenceScore sequence = make_sequence(20, 20, 0, 0);
  for (std::size_t i = 0; i < 4; ++i) sequence.frames[i].instances[0].reachable = false;
  EXPECT_EQ(summarise({sequence}).raw_ceiling, 0.8);
}

TEST(Summary, SortsInstancesByTheirDistance) {
  SequenceScore sequence = make_sequence(1, 0, 0, 0);
  std::vector<InstanceScore>& instances = sequence.frames[0].instances;
  instances = {make_instance(true, 0.99), make_instance(false, 1.0), make_instance(true, 4.0), make_instance(true, 5.0)};
  instances[2].settled = false;
  instances.push_back(make_instance(true, 2.5));
  instances.back().raw = false;  // does not count
  instances.push_back(make_instance(true));
  instances.back().distance_m.reset();  // has no place in the table
  const auto bins = summarise({sequence}).recall_by_range;
  ASSERT_EQ(bins.size(), 5U);
  const std::vector<int> hits = {1, 0, 0, 0, 2};
  const std::vector<int> misses = {0, 1, 0, 0, 0};
  for (std::size_t i = 0; i < bins.size(); ++i) {
    EXPECT_EQ(bins[i].from_m, static_cast<double>(i));
    EXPECT_EQ(bins[i].to_m, static_cast<double>(i + 1));
    EXPECT_EQ(bins[i].raw.tp, hits[i]) << i;
    EXPECT_EQ(bins[i].raw.fn, misses[i]) << i;
  }
  EXPECT_EQ(bins[4].settled.tp, 1);  // the one at 4 m has not settled
}

TEST(Summary, EndsTheLastBinAtTheRange) {
  EvaluationParams params;
  params.max_range_m = 2.5;
  const auto bins = summarise({make_sequence(1, 0, 0, 0)}, params).recall_by_range;
  ASSERT_EQ(bins.size(), 3U);
  EXPECT_EQ(bins[2].to_m, 2.5);
}

InstanceScore make_instance_of_depth(bool hit, double distance_m, double depth_m, std::optional<bool> expected) {
  InstanceScore instance = make_instance(hit, distance_m);
  instance.depth_m = depth_m;
  instance.expected = expected;
  return instance;
}

TEST(Summary, SortsSettledInstancesByDistanceAndDepthBesideWhatTheEnvelopeExpects) {
  SequenceScore sequence = make_sequence(1, 0, 0, 0);
  std::vector<InstanceScore>& instances = sequence.frames[0].instances;
  instances = {make_instance_of_depth(true, 1.0, 0.15, true),
               make_instance_of_depth(false, 1.9, 0.29, true),
               make_instance_of_depth(true, 1.5, 0.2, std::nullopt),
               make_instance_of_depth(false, 5.0, 7.0, false),
               make_instance_of_depth(true, 1.5, 0.3, std::nullopt),
               make_instance_of_depth(true, 1.5, 0.3, true),
               make_instance(true, 1.5)};  // its depth is not known
  instances[5].settled = false;
  const auto bins = summarise({sequence}).recall_by_depth;
  ASSERT_EQ(bins.size(), 3U);  // those with any
  EXPECT_EQ(bins[0].from_m, 1.0);
  EXPECT_EQ(bins[0].to_m, 2.0);
  EXPECT_EQ(bins[0].from_depth_m, 0.15);
  EXPECT_EQ(bins[0].to_depth_m, 0.3);
  EXPECT_EQ(bins[0].settled.tp, 2);
  EXPECT_EQ(bins[0].settled.fn, 1);
  EXPECT_EQ(bins[0].judged, 2);
  EXPECT_EQ(bins[0].judged_hits, 1);
  EXPECT_EQ(bins[0].expected, 2);
  EXPECT_EQ(bins[1].from_depth_m, 0.3);
  EXPECT_EQ(bins[1].settled.tp, 1);
  EXPECT_EQ(bins[1].judged, 0);
  EXPECT_EQ(bins[2].from_m, 4.0);  // the last bin holds its end
  EXPECT_EQ(bins[2].from_depth_m, 1.2);
  EXPECT_EQ(bins[2].to_depth_m, std::numeric_limits<double>::infinity());
  EXPECT_EQ(bins[2].expected, 0);
}

ApproachEvent make_event(double warned_distance_m, double lead_time_s, bool in_time) {
  ApproachEvent event;
  event.warned_frame = 0;
  event.warned_distance_m = warned_distance_m;
  event.lead_time_s = lead_time_s;
  event.in_time = in_time;
  return event;
}

TEST(Summary, CountsEventsMissedAndLate) {
  SequenceScore sequence = make_sequence(10, 0, 0, 0);
  sequence.events = {make_event(4.0, 3.0, true), make_event(2.0, 1.0, true), make_event(1.0, 0.5, false), ApproachEvent{}};
  const EvaluationSummary summary = summarise({sequence});
  EXPECT_EQ(summary.events, 4);
  EXPECT_EQ(summary.missed, 1);
  EXPECT_EQ(summary.late, 1);
  EXPECT_EQ(summary.warned_in_time->value, 0.5);
  EXPECT_EQ(summary.first_warning_min_m, 1.0);
  EXPECT_EQ(summary.first_warning_median_m, 2.0);
  EXPECT_EQ(summary.lead_time_min_s, 0.5);
  EXPECT_EQ(summary.lead_time_median_s, 1.0);
}

TEST(Summary, RelatesEpisodesToWhatWasSeenWithPosesOnly) {
  // 450 frames = 30 s, 40 m with 3 episodes; the other sequence has no poses, so no episodes can be told: 6 a minute, 7.5 on
  // 100 m.
  SequenceScore with_poses = make_sequence(450, 0, 0, 0);
  with_poses.walked_m = 40.0;
  for (const int frame : {0, 200, 449}) with_poses.episodes.emplace_back().first_frame = frame;
  const EvaluationSummary summary = summarise({with_poses, make_sequence(450, 0, 0, 0)});
  EXPECT_EQ(summary.minutes, 1.0);
  EXPECT_EQ(summary.episodes, 3);
  EXPECT_NEAR(summary.episodes_per_minute->value, 6.0, 1e-9);
  EXPECT_NEAR(summary.episodes_per_100m->value, 7.5, 1e-9);
  EXPECT_FALSE(summarise({make_sequence(450, 0, 0, 0)}).episodes_per_minute.has_value());
}

TEST(Summary, TellsMedianAndTailOfTheAbsoluteErrors) {
  // 0, 0.1, ... 2.0 with changing signs: median 1.0, 95 % of the way 1.9; bearings twice that.
  SequenceScore sequence = make_sequence(21, 0, 0, 0);
  for (int i = 0; i <= 20; ++i) {
    DetectionScore detection;
    detection.distance_error_m = (i % 2 == 0 ? 0.1 : -0.1) * i;
    detection.bearing_error_deg = (i % 2 == 0 ? -0.2 : 0.2) * i;
    sequence.frames[static_cast<std::size_t>(i)].detections = {detection, make_false_alarm()};
  }
  const EvaluationSummary summary = summarise({sequence});
  EXPECT_EQ(summary.localised, 21);
  EXPECT_NEAR(*summary.distance_error_median_m, 1.0, 1e-12);
  EXPECT_NEAR(*summary.distance_error_p95_m, 1.9, 1e-12);
  EXPECT_NEAR(*summary.bearing_error_median_deg, 2.0, 1e-12);
  EXPECT_NEAR(*summary.bearing_error_p95_deg, 3.8, 1e-12);
}

TEST(Summary, TellsTheErrorsWithinThreeMetresByTheTruthApart) {
  SequenceScore sequence = make_sequence(1, 0, 0, 0);
  std::vector<DetectionScore>& detections = sequence.frames[0].detections;
  detections.resize(3);
  detections[0].distance_m = 3.25;  // truly at 3.0 m
  detections[0].distance_error_m = 0.25;
  detections[1].distance_m = 2.5;  // truly at 3.5 m
  detections[1].distance_error_m = -1.0;
  detections[2].distance_m = 1.0;  // hits nothing
  const EvaluationSummary summary = summarise({sequence});
  EXPECT_EQ(summary.localised, 2);
  EXPECT_EQ(summary.near_localised, 1);
  EXPECT_EQ(summary.near_distance_error_median_m, 0.25);
  EXPECT_EQ(summary.near_distance_error_p95_m, 0.25);
}

TEST(Summary, TellsHowReliableProbabilitiesAre) {
  // Claimed 0.9 four times, there three times (0.75); claimed 0.25 and 0.15, both not there; 1.0 once, there. A detection on
  // what does not count (hits 7) and one without a probability are left out. Weighted by the 7 detections, the error is (4 |0.9
  // - 0.75| + |0.25 - 0| + |0.15 - 0| + 0) / 7; 0.9 and 1.0 share a tenth: mean 4.6 / 5, share 4 / 5.
  SequenceScore sequence = make_sequence(1, 1, 0, 0);
  const auto add = [&sequence](std::optional<double> probability, std::vector<int> hits, bool is_false) {
    DetectionScore detection;
    detection.probability = probability;
    detection.hits = std::move(hits);
    detection.raw_false = is_false;
    sequence.frames[0].detections.push_back(detection);
  };
  for (const bool is_false : {false, false, false, true}) add(0.9, is_false ? std::vector<int>{} : std::vector{1}, is_false);
  add(1.0, {1}, false);
  add(0.25, {}, true);
  add(0.15, {}, true);
  add(0.5, {7}, false);
  add(std::nullopt, {1}, false);
  const EvaluationSummary summary = summarise({sequence});
  ASSERT_EQ(summary.calibration.size(), 10U);
  EXPECT_EQ(summary.calibration[9].from, 0.9);
  EXPECT_EQ(summary.calibration[9].to, 1.0);
  EXPECT_EQ(summary.calibration[9].detections, 5);
  EXPECT_NEAR(summary.calibration[9].mean_probability, 0.92, 1e-12);
  EXPECT_NEAR(summary.calibration[9].hit_share, 0.8, 1e-12);
  EXPECT_EQ(summary.calibration[1].detections, 1);
  EXPECT_EQ(summary.calibration[2].detections, 1);
  EXPECT_EQ(summary.calibration[5].detections, 0);
  EXPECT_NEAR(*summary.expected_calibration_error, (5 * 0.12 + 0.25 + 0.15) / 7.0, 1e-12);
}

TEST(Summary, HasNoCalibrationWithoutProbabilities) {
  const EvaluationSummary summary = summarise({make_sequence(3, 3, 0, 3)});
  EXPECT_TRUE(summary.calibration.empty());
  EXPECT_FALSE(summary.expected_calibration_error.has_value());
}

TEST(Summary, CountsStatesOfFramesAndGround) {
  SequenceScore sequence = make_sequence(4, 0, 0, 0);
  sequence.frames[0].ground = GroundState::seen;
  sequence.frames[1].ground = GroundState::uncertain;
  sequence.frames[3].status = FrameStatus::bad_frame;
  const EvaluationSummary summary = summarise({sequence});
  EXPECT_EQ(summary.frame_status, (std::map<std::string, int>{{"ok", 3}, {"bad_frame", 1}}));
  EXPECT_EQ(summary.ground_state, (std::map<std::string, int>{{"seen", 1}, {"uncertain", 1}, {"not_visible", 1}}));
}

TEST(Summary, LeavesEmptyWhatCannotBeCounted) {
  for (const SequenceScore& sequence : {SequenceScore{}, make_sequence(1, 0, 0, 0)}) {
    const EvaluationSummary summary = summarise({sequence});
    EXPECT_EQ(summary.frames, static_cast<int>(sequence.frames.size()));
    EXPECT_FALSE(summary.raw_tpr.has_value());
    EXPECT_FALSE(summary.raw_ppv.has_value());
    EXPECT_FALSE(summary.settled_tpr.has_value());
    EXPECT_FALSE(summary.raw_ceiling.has_value());
    EXPECT_FALSE(summary.warned_in_time.has_value());
    EXPECT_FALSE(summary.first_warning_min_m.has_value());
    EXPECT_FALSE(summary.episodes_per_minute.has_value());
    EXPECT_FALSE(summary.distance_error_median_m.has_value());
  }
}

TEST(Summary, RefusesNoSequencesAndBadParameters) {
  test::expect_line_with(test::error_of<std::invalid_argument>([] { summarise({}); }), "sequences = 0, must be 1 or more");
  EvaluationParams params;
  params.resamplings = 0;
  test::expect_line_with(test::error_of<std::invalid_argument>([&] { summarise({SequenceScore{}}, params); }),
                         "evaluation.resamplings = 0");
}

// Intervals

TEST(Interval, OfAConstantIsThatConstant) {
  // Every block holds the same share, so every resample does, too.
  SequenceScore sequence = make_sequence(150, 0, 0, 0);
  for (FrameScore& frame : sequence.frames) {
    frame.instances = {make_instance(true), make_instance(true), make_instance(true), make_instance(false)};
  }
  const Estimate tpr = *summarise({sequence}).raw_tpr;
  EXPECT_EQ(tpr.value, 0.75);
  EXPECT_EQ(tpr.low, 0.75);
  EXPECT_EQ(tpr.high, 0.75);
}

TEST(Interval, OfTwoBlocksReachesFromOneToTheOther) {
  // All hit in one block, all missed in the other: resamples are 0, 0.5 and 1 with chances 1/4, 1/2, 1/4.
  SequenceScore sequence = make_sequence(30, 15, 15, 0);
  const Estimate tpr = *summarise({sequence}).raw_tpr;
  EXPECT_EQ(tpr.value, 0.5);
  EXPECT_EQ(tpr.low, 0.0);
  EXPECT_EQ(tpr.high, 1.0);
}

TEST(Interval, OfEventsResamplesEvents) {
  // 100 events, 80 of them in time: the binomial's standard deviation is 0.04, 95 % are +- 0.078.
  SequenceScore sequence = make_sequence(1, 0, 0, 0);
  for (int i = 0; i < 100; ++i) sequence.events.push_back(make_event(2.0, 1.0, i < 80));
  const Estimate share = *summarise({sequence}).warned_in_time;
  EXPECT_EQ(share.value, 0.8);
  EXPECT_NEAR(share.low, 0.722, 0.015);
  EXPECT_NEAR(share.high, 0.878, 0.015);
}

TEST(Interval, IsTheSameForTheSameSeed) {
  const SequenceScore sequence = make_sequence(200, 120, 80, 33);
  EvaluationParams params;
  const Estimate first = *summarise({sequence}, params).raw_ppv;
  const Estimate again = *summarise({sequence}, params).raw_ppv;
  EXPECT_EQ(first.low, again.low);
  EXPECT_EQ(first.high, again.high);
  params.seed = 2;
  const Estimate other = *summarise({sequence}, params).raw_ppv;
  EXPECT_NE(std::pair(first.low, first.high), std::pair(other.low, other.high));
}

/// Walks whose blocks of 15 frames are each found or missed as a whole, with this chance: the share of `walks` seeded walks in
/// which the interval of the TPR holds the chance.
double coverage(int block_frames, double chance, int walks) {
  std::mt19937_64 random(5);
  EvaluationParams params;
  params.block_frames = block_frames;
  params.resamplings = 400;
  int covered = 0;
  for (int walk = 0; walk < walks; ++walk) {
    SequenceScore sequence = make_sequence(60 * 15, 0, 0, 0);
    bool is_found = false;
    for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
      if (i % 15 == 0) is_found = static_cast<double>(random() >> 11U) * 0x1.0p-53 < chance;
      sequence.frames[i].instances = {make_instance(is_found)};
    }
    const Estimate tpr = *summarise({sequence}, params).raw_tpr;
    covered += tpr.low <= chance && chance <= tpr.high ? 1 : 0;
  }
  return static_cast<double>(covered) / walks;
}

TEST(Interval, HoldsTheTruthInAbout95PercentOfTheWalks) {
  // Percentile intervals of 60 blocks are a little narrow, and shares come in steps of 1/60. Three standard deviations of 400
  // draws are 0.033.
  const double share = coverage(15, 0.7, 400);
  EXPECT_GE(share, 0.95 - 0.045);
  EXPECT_LE(share, 0.95 + 0.035);
}

TEST(Interval, WouldBeFarTooNarrowWithFramesDrawnOneByOne) {
  // Why frames are drawn in blocks: 15 frames that tell the same make the interval sqrt(15) = 3.9 times too narrow, which holds
  // the truth with a chance of about 2 Phi(1.96 / 3.9) - 1 = 0.39.
  EXPECT_NEAR(coverage(1, 0.7, 100), 0.39, 0.15);
}

}  // namespace
}  // namespace brink
