#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "brink/detections.hpp"
#include "brink/evaluation_report.hpp"
#include "evaluation/hand_made.hpp"
#include "expect_error.hpp"
#include "temporary_folder.hpp"

// Walks at 15 frames a second towards instance 1, whose rim and whose pixels are set apart. 0.35 s after it appears, from the
// seventh frame on, it is settled.
namespace brink {
namespace {

using test::at;
using test::make_detection;
using test::make_instance;
using test::make_truth;
using test::off;
using test::on;

struct Step {
  double distance_m = 1.0;                       ///< of the nearest rim point, seen or not
  bool is_hit = false;                           ///< a detection lies on the instance
  std::optional<double> claim_m = std::nullopt;  ///< another one, which lies on nothing, says this distance
  bool is_seen = true;
  double bearing_deg = 0.0;
  bool is_inside = false;
  double height_m = 1.6;
};

constexpr Step kHit{.is_hit = true};
constexpr Step kSilent{};

RimPlace make_rim(int id, const Step& step, double depth_m = 1.0) {
  return {id, depth_m, step.distance_m, step.bearing_deg, step.height_m, step.is_inside};
}

/// A remembered drop: no pixels, but a distance.
NegativeObstacle remembered(double distance_m) {
  NegativeObstacle obstacle = test::make_obstacle({}, distance_m, 4);
  obstacle.candidate.contour.clear();
  obstacle.unseen_s = 0.4;
  return obstacle;
}

void add_step(SequenceEvaluator& evaluator, int frame, const Step& step, double rate = test::kRate) {
  const std::vector<VisibleInstance> seen = {make_instance(1, 2.9)};  // what shows of it is far inside
  FrameTruth truth = at(make_truth(frame, step.is_seen ? seen : std::vector<VisibleInstance>{}, rate), {0, 0, 0});
  truth.rims = {make_rim(1, step)};
  std::vector<NegativeObstacle> obstacles;
  if (step.is_hit) obstacles.push_back(on(1, 4.0));
  if (step.claim_m) obstacles.push_back(remembered(*step.claim_m));
  evaluator.add(truth, make_detection(frame, obstacles));
}

SequenceScore walk(const std::vector<Step>& steps, double rate = test::kRate) {
  SequenceEvaluator evaluator("walk_1");
  for (int frame = 0; frame < static_cast<int>(steps.size()); ++frame) {
    add_step(evaluator, frame, steps[static_cast<std::size_t>(frame)], rate);
  }
  return evaluator.finish();
}

/// For each frame: '-' nothing ahead, 'r' reported, '.' not reported before the first warning, 's' silent after it, 'D' silent
/// for so long in this frame that the warning is dropped.
std::string show(const SequenceScore& score) {
  std::string text;
  for (const FrameScore& frame : score.frames) {
    if (frame.edges_ahead.value().empty()) {
      text += '-';
      continue;
    }
    const EdgeAhead& edge = frame.edges_ahead->front();
    text += edge.reported ? 'r' : edge.dropped ? 'D' : edge.warned ? 's' : '.';
  }
  return text;
}

std::vector<Step> repeat(const std::vector<std::pair<int, Step>>& parts) {
  std::vector<Step> steps;
  for (const auto& [times, step] : parts) steps.insert(steps.end(), static_cast<std::size_t>(times), step);
  return steps;
}

AheadCounts count(const SequenceScore& score) { return summarise({score}).ahead; }

TEST(EdgesAhead, LieWithinTwoMetres) {
  const std::vector<Step> steps = {{.distance_m = 2.01}, {.distance_m = 2.0}, {.distance_m = 0.1}, {.distance_m = 2.1}};
  const SequenceScore score = walk(steps);
  EXPECT_EQ(show(score), "-..-");
  EXPECT_EQ(score.frames[2].edges_ahead->at(0).id, 1);
  EXPECT_EQ(score.frames[2].edges_ahead->at(0).distance_m, 0.1);
}

TEST(EdgesAhead, LieWithinSixtyDegreesOfWhereTheCameraLooks) {
  EXPECT_EQ(show(walk({{.bearing_deg = 60.0}, {.bearing_deg = 60.1}, {.bearing_deg = -60.0}, {.bearing_deg = -61.0}})), ".-.-");
}

TEST(EdgesAhead, AreThoseThatWereSeenBeforeOrAreSeenNow) {
  EXPECT_EQ(show(walk({{.is_seen = false}, {.is_seen = true}, {.is_seen = false}})), "-..");
  // Far away is soon enough.
  EXPECT_EQ(show(walk({{.distance_m = 7.0}, {.is_seen = false}})), "-.");
  SequenceEvaluator evaluator("too few pixels");
  FrameTruth truth = make_truth(0, {make_instance(1, 1.0, 149)});
  truth.rims = {make_rim(1, {})};
  evaluator.add(truth, make_detection(0, {}));
  EXPECT_EQ(show(evaluator.finish()), "-");
}

TEST(EdgesAhead, AreDeep) {
  SequenceEvaluator evaluator("kerb");
  FrameTruth truth = make_truth(0, {make_instance(1, 1.0, 400, 0.149), make_instance(2, 1.0, 400, 0.15)});
  truth.rims = {make_rim(1, {}, 0.149), make_rim(2, {}, 0.15)};
  evaluator.add(truth, make_detection(0, {}));
  const std::vector<EdgeAhead> edges = evaluator.finish().frames[0].edges_ahead.value();
  ASSERT_EQ(edges.size(), 1U);
  EXPECT_EQ(edges[0].id, 2);
}

TEST(EdgesAhead, EndWhereTheBearerStandsInTheOpening) {
  EXPECT_EQ(show(walk({{.distance_m = 0.1}, {.distance_m = 0.1, .is_inside = true}, {.distance_m = 0.1}})), ".-.");
}

TEST(EdgesAhead, HaveBeenPassedByWhoeverWalkedDownAndLeftTheOpeningBelow) {
  // 1 m deep: more than half of it lower than before is down on the lower floor; the head bobs by less.
  EXPECT_EQ(show(walk({{.height_m = 1.6},
                       {.is_inside = true, .height_m = 1.2},
                       {.height_m = 0.6},
                       {.height_m = 1.09},
                       {.height_m = 1.11},
                       {.height_m = 0.6}})),
            ".---..");
  EXPECT_EQ(show(walk({{.is_inside = true}, {.height_m = 0.6}})), "-.");  // nobody knows how high he stood before
}

TEST(EdgesAhead, AreNoneWhereTruthKnowsNoRims) {
  SequenceEvaluator evaluator("no rims");
  evaluator.add(make_truth(0, {make_instance(1, 1.0)}), make_detection(0, {}));
  const SequenceScore score = evaluator.finish();
  EXPECT_EQ(show(score), "-");
  const EvaluationSummary summary = summarise({score});
  EXPECT_FALSE(summary.reported_ahead.has_value());
  EXPECT_FALSE(summary.held.has_value());
  EXPECT_FALSE(summary.dropped_per_minute.has_value());
  EXPECT_FALSE(summary.false_silence.has_value());
  EXPECT_EQ(to_text({score}).find("m ahead, in"), std::string::npos);
}

TEST(Reported, ByAMaskWhateverItsDistanceOrByAMemoryWhoseDistanceIsRight) {
  const auto claim = [](double claim_m) { return Step{.distance_m = 1.0, .claim_m = claim_m, .is_seen = false}; };
  ASSERT_GT(1.3 - 1.0, 0.3);  // in floating point
  EXPECT_EQ(show(walk({kHit, claim(1.3), claim(0.7), claim(1.31), claim(0.69)})), "rrrss");
}

TEST(Reported, NotByADetectionOfSomethingElseAtTheSameDistance) {
  SequenceEvaluator evaluator("two edges");
  FrameTruth truth = make_truth(0, {make_instance(1, 1.0), make_instance(2, 1.0)});
  truth.rims = {make_rim(1, {}), make_rim(2, {})};
  evaluator.add(truth, make_detection(0, {on(2, 1.0)}));
  const std::vector<EdgeAhead> edges = evaluator.finish().frames[0].edges_ahead.value();
  EXPECT_FALSE(edges.at(0).reported);
  EXPECT_TRUE(edges.at(1).reported);
}

TEST(Reported, NotByADetectionBeyondTheRange) {
  FrameTruth truth = make_truth(0, {make_instance(1, 1.0)});
  truth.rims = {make_rim(1, {})};
  SequenceEvaluator evaluator("far claim");
  evaluator.add(truth, make_detection(0, {on(1, 5.1)}));
  EXPECT_EQ(show(evaluator.finish()), ".");
}

TEST(Held, IsTheShareOfTheFramesFromTheFirstWarningOn) {
  // Frames 0 and 1 come before the warning; of the four from frame 2 on, three are reported.
  const SequenceScore score = walk({kSilent, kSilent, kHit, kHit, kSilent, kHit});
  EXPECT_EQ(show(score), "..rrsr");
  const AheadCounts counts = count(score);
  EXPECT_EQ(counts.warned, 4);
  EXPECT_EQ(counts.held, 3);
  EXPECT_EQ(score.events.at(0).held, 0.75);
  EXPECT_EQ(summarise({score}).held->value, 0.75);
}

TEST(Held, BeginsWithAWarningFromAfar) {
  const SequenceScore score = walk({{.distance_m = 4.0, .is_hit = true}, {.distance_m = 3.0}, kSilent, kHit});
  EXPECT_EQ(show(score), "--sr");
  EXPECT_EQ(score.events.at(0).held, 0.5);
}

TEST(Held, DoesNotBeginWithSomethingFarAwayWhoseDistanceIsRightByChance) {
  EXPECT_EQ(show(walk({{.distance_m = 4.0, .claim_m = 4.0}, kSilent})), "-.");
}

TEST(Held, IsUnknownWithoutAWarning) {
  const SequenceScore score = walk({kSilent, kSilent});
  EXPECT_FALSE(score.events.at(0).held.has_value());
  EXPECT_FALSE(summarise({score}).held.has_value());
}

TEST(Held, GoesOnWhileTheEdgeLiesAheadOutOfView) {
  // Two seconds before an edge that has left the image: seen again, it is no new approach.
  Step memory = kSilent;
  memory.is_seen = false;
  const SequenceScore score = walk(repeat({{1, kHit}, {30, memory}, {1, kSilent}}));
  EXPECT_EQ(score.frames.back().edges_ahead->at(0).warned, true);
  EXPECT_EQ(score.frames.back().edges_ahead->at(0).settled, true);
}

TEST(Held, BeginsAnewAfterOneSecondOutOfViewAndAside) {
  const Step away{.is_seen = false, .bearing_deg = 180.0};
  // At 15 per second 13 frames without it leave 14 steps, 0.93 s, in between; 14 frames leave 1 s.
  EXPECT_EQ(show(walk(repeat({{1, kHit}, {13, away}, {1, kSilent}}))), "r-------------s");
  EXPECT_EQ(show(walk(repeat({{1, kHit}, {14, away}, {1, kSilent}}))), "r--------------.");
  // Back before an edge that is known and out of view: asked for again, once it is settled.
  Step memory = kSilent;
  memory.is_seen = false;
  const SequenceScore back = walk(repeat({{1, kHit}, {14, away}, {7, memory}}));
  EXPECT_EQ(show(back), "r--------------.......");
  EXPECT_FALSE(back.frames[20].edges_ahead->at(0).settled);
  EXPECT_TRUE(back.frames[21].edges_ahead->at(0).settled);
}

TEST(DroppedWarnings, AreSilencesOfThreeTenthsOfASecond) {
  // At 15 per second the fourth silent frame comes 0.267 s after the last report, the fifth 0.333 s.
  EXPECT_EQ(show(walk(repeat({{1, kHit}, {4, kSilent}, {1, kHit}}))), "rssssr");
  EXPECT_EQ(show(walk(repeat({{1, kHit}, {5, kSilent}, {1, kHit}}))), "rssssDr");
  ASSERT_LT(0.6 - 0.3, 0.3 + 1e-12);
  EXPECT_EQ(show(walk(repeat({{4, kHit}, {3, kSilent}}), 10.0)), "rrrrssD");  // 0.3 s themselves count
}

TEST(DroppedWarnings, AreCountedOnceForEachSilence) {
  const SequenceScore score = walk(repeat({{1, kHit}, {12, kSilent}, {1, kHit}, {6, kSilent}}));
  EXPECT_EQ(show(score), "rssssDsssssssrssssDs");
  EXPECT_EQ(count(score).dropped, 2);
  EXPECT_NEAR(summarise({score}).dropped_per_minute->value, 2 / (20 / 15.0 / 60.0), 1e-9);
}

TEST(DroppedWarnings, NeedAWarning) { EXPECT_EQ(show(walk(repeat({{10, kSilent}}))), ".........."); }

TEST(DroppedWarnings, CountOnlyWhileTheEdgeLiesAhead) {
  const Step far{.distance_m = 2.5};
  EXPECT_EQ(show(walk(repeat({{1, kHit}, {3, kSilent}, {1, far}, {4, kSilent}}))), "rsss-ssss");
  // Silent from 2.5 m on: counted from where it comes within 2 m, which is frame 10; the fifth frame after that is 0.333 s on.
  const Step warned{.distance_m = 3.0, .is_hit = true};
  EXPECT_EQ(show(walk(repeat({{1, warned}, {9, far}, {6, kSilent}}))), "----------sssssD");
}

FrameScore last_of(const Detection& detection, int frames = 7) {
  SequenceEvaluator evaluator("standing");
  for (int frame = 0; frame + 1 < frames; ++frame) add_step(evaluator, frame, kSilent);
  FrameTruth truth = make_truth(frames - 1, {make_instance(1, 1.0)});
  truth.rims = {make_rim(1, kSilent)};
  Detection last = detection;
  last.frame = frames - 1;
  evaluator.add(truth, last);
  return evaluator.finish().frames.back();
}

TEST(FalseSilence, IsAFrameThatSeesTheGroundAndReportsNothing) {
  EXPECT_EQ(last_of(make_detection(0, {})).ahead().silent_frames, 1);
  EXPECT_EQ(last_of(make_detection(0, {})).ahead().frames, 1);
  EXPECT_EQ(last_of(make_detection(0, {on(1)})).ahead().silent_frames, 0);
  EXPECT_EQ(last_of(make_detection(0, {off()})).ahead().silent_frames, 0);       // wrong, but not silent
  EXPECT_EQ(last_of(make_detection(0, {on(1, 5.1)})).ahead().silent_frames, 1);  // beyond the range
}

TEST(FalseSilence, IsNoneWhereTheGroundIsNotSeenOrTheFrameFailed) {
  Detection detection = make_detection(0, {});
  detection.ground.state = GroundState::uncertain;
  EXPECT_EQ(last_of(detection).ahead().silent_frames, 0);
  detection.ground.state = GroundState::not_visible;
  EXPECT_EQ(last_of(detection).ahead().silent_frames, 0);
  const AheadCounts failed = last_of(make_failed_detection(0, 0.0, FrameStatus::no_picture, "missing")).ahead();
  EXPECT_EQ(failed.silent_frames, 0);
  EXPECT_EQ(failed.frames, 1);  // its edge counts, and is not reported
  EXPECT_EQ(failed.settled, 1);
  EXPECT_EQ(failed.reported, 0);
}

TEST(FalseSilence, BeginsWhenTheInstanceIsSettled) {
  const AheadCounts early = last_of(make_detection(0, {}), 6).ahead();
  EXPECT_EQ(early.frames, 0);
  EXPECT_EQ(early.silent_frames, 0);
}

TEST(FalseSilence, CountsAFrameWithTwoEdgesOnce) {
  FrameScore frame;
  frame.ground = GroundState::seen;
  frame.edges_ahead = {{1, 1.0, true, false, false, false}, {2, 1.5, true, false, true, true}};
  EXPECT_EQ(frame.ahead().settled, 2);
  EXPECT_EQ(frame.ahead().frames, 1);
  EXPECT_EQ(frame.ahead().silent_frames, 1);
  EXPECT_EQ(frame.ahead().warned, 1);
  EXPECT_EQ(frame.ahead().dropped, 1);
}

TEST(LastMetres, ArePooledFrameByFrameAndEventByEvent) {
  // Of ten frames, those from the seventh on are settled: 3 of 4 reported, 1 silent. Held: 4 of 5 from frame 5 on.
  const SequenceScore half = walk(repeat({{5, kSilent}, {4, kHit}, {1, kSilent}}));
  const SequenceScore all = walk(repeat({{10, kHit}}));
  const EvaluationSummary summary = summarise({half, all});
  EXPECT_EQ(summary.ahead.settled, 8);
  EXPECT_EQ(summary.ahead.reported, 7);
  EXPECT_EQ(summary.reported_ahead->value, 7.0 / 8.0);
  EXPECT_EQ(summary.held->value, 14.0 / 15.0);
  EXPECT_EQ(summary.held_min, 0.8);
  EXPECT_EQ(summary.false_silence->value, 1.0 / 8.0);
  EXPECT_EQ(summary.dropped_per_minute->value, 0.0);
  const std::string text = to_text({half, all});
  EXPECT_NE(text.find("Edges within 2 m ahead, in 8 frames: reported in 0.875 ["), std::string::npos) << text;
  EXPECT_NE(text.find("held 0.933 ["), std::string::npos) << text;
  EXPECT_NE(text.find("(least of an event 0.800)"), std::string::npos) << text;
  EXPECT_NE(text.find("dropped warnings 0, per minute 0.00 ["), std::string::npos) << text;
  EXPECT_NE(text.find("false silence in 1 frames, share 0.125 ["), std::string::npos) << text;
}

TEST(LastMetres, HaveParametersThatCheckThemselves) {
  const auto fault = [](double EvaluationParams::*member, double value) {
    EvaluationParams params;
    params.*member = value;
    return test::error_of<std::invalid_argument>([&] { params.validate(); });
  };
  test::expect_line_with(fault(&EvaluationParams::ahead_range_m, -1.0), "evaluation.ahead_range_m = -1, must be 0 to 1000");
  test::expect_line_with(fault(&EvaluationParams::ahead_deg, 181.0), "evaluation.ahead_deg = 181, must be 0 to 180");
  test::expect_line_with(fault(&EvaluationParams::claim_error_m, -0.1), "evaluation.claim_error_m = -0.1");
  test::expect_line_with(fault(&EvaluationParams::dropped_s, std::numeric_limits<double>::quiet_NaN()),
                         "evaluation.dropped_s = nan");
}

// A remembered drop whose opening has left the image: written, read and judged like any other.
TEST(EmptyContour, IsNeitherHitNorFalseAndReportsTheEdgeByItsDistance) {
  const test::TemporaryFolder folder;
  std::string lines;
  for (int frame = 0; frame < 7; ++frame) {
    Detection detection = make_detection(frame, {remembered(1.1)});
    detection.ground.plane = GroundPlane{};
    lines += to_json_line(detection);
  }
  const std::vector<Detection> read = read_detections(folder.add("memory.jsonl", lines));
  ASSERT_TRUE(read[6].obstacles.at(0).candidate.contour.empty());
  EXPECT_EQ(read[6].obstacles[0].unseen_s, 0.4);
  const FrameScore score = last_of(read[6]);
  EXPECT_EQ(score.raw().tp, 0);
  EXPECT_EQ(score.raw().fn, 1);
  EXPECT_EQ(score.raw().fp, 0);
  EXPECT_EQ(score.settled().fp, 0);
  EXPECT_TRUE(score.detections.at(0).hits.empty());
  EXPECT_TRUE(score.edges_ahead->at(0).reported);

  const cv::Mat3b drawn =
      draw_evaluation({}, make_truth(6, {make_instance(1, 1.0)}), read[6], score, "remembered beyond the image");
  EXPECT_EQ(drawn.size(), cv::Size(101, 81));
  CocoWriter coco;
  coco.add("000006.png", drawn.size(), read[6]);
  EXPECT_NE(coco.text().find("\"annotations\": []"), std::string::npos) << coco.text();
}

TEST(ByDomain, GroupsSequencesByTheirNamesUpToTheLastUnderscore) {
  SequenceScore stairs = walk(repeat({{7, kHit}}));
  SequenceScore more_stairs = walk(repeat({{1, kHit}, {6, kSilent}}));
  SequenceScore quay = walk(repeat({{7, kSilent}}));
  stairs.name = "wide_stairs_101";
  quay.name = "quay";
  more_stairs.name = "wide_stairs_102";
  const std::vector<DomainSummary> domains = summarise_by_domain({stairs, quay, more_stairs});
  ASSERT_EQ(domains.size(), 2U);
  EXPECT_EQ(domains[0].name, "wide_stairs");
  EXPECT_EQ(domains[0].summary.sequences, 2);
  EXPECT_EQ(domains[0].summary.held->value, 8.0 / 14.0);
  EXPECT_EQ(domains[1].name, "quay");
  EXPECT_EQ(domains[1].summary.missed, 1);
  quay.name = "_5";
  EXPECT_EQ(summarise_by_domain({quay}).at(0).name, "_5");
}

TEST(ByDomain, IsATableBelowThePooledOne) {
  SequenceScore stairs = walk(repeat({{1, kHit}, {6, kSilent}}));
  SequenceScore quay = walk(repeat({{7, kSilent}}));
  SequenceScore older = walk(repeat({{7, kHit}}));
  stairs.name = "stairs_1";
  quay.name = "quay_1";
  older.name = "older_1";
  for (FrameScore& frame : older.frames) frame.edges_ahead.reset();
  older.events[0].held.reset();
  const std::string text = to_text({stairs, quay, older});
  EXPECT_NE(text.find("| stairs | 1 | 0.000 | - | 0 of 1 | 0.143 | 1 | 1 of 1 | 0 |\n"), std::string::npos) << text;
  EXPECT_NE(text.find("| quay | 1 | 0.000 | - | 1 of 1 | - | 0 | 1 of 1 | 0 |\n"), std::string::npos) << text;
  EXPECT_NE(text.find("| older | 1 | 1.000 | 1.000 | 0 of 1 | - | - | - | 0 |\n"), std::string::npos) << text;
  EXPECT_EQ(to_text({stairs}).find("| domain |"), std::string::npos);  // one domain: the pooled table says it all
  EXPECT_NE(to_json(summarise_by_domain({stairs, quay})).find("\"quay\": {"), std::string::npos);
}

}  // namespace
}  // namespace brink
