#include <algorithm>
#include <functional>
#include <stdexcept>

#include <gtest/gtest.h>

#include "brink/evaluation.hpp"
#include "expect_error.hpp"

namespace brink {
namespace {

/// A walk of 600 frames, 40 s, with an instance in each and an event every 50; `is_good` tells where it was detected rightly.
/// Where it was not, there is a miss, an FP that begins an episode in every 15th frame, and the distance is off by 0.4 m
/// instead of 0.1.
SequenceScore make_run(const std::function<bool(int)>& is_good) {
  SequenceScore run;
  run.name = "walk";
  run.duration_s = 40.0;
  run.walked_m = 48.0;
  for (int i = 0; i < 600; ++i) {
    const bool good = is_good(i);
    FrameScore frame;
    frame.frame = i;
    InstanceScore instance;
    instance.raw = instance.settled = true;
    instance.hit = instance.settled_hit = good;
    frame.instances = {instance};
    DetectionScore detection;
    detection.distance_error_m = good ? 0.1 : 0.4;
    detection.raw_false = detection.settled_false = !good;
    frame.detections = {detection};
    run.frames.push_back(frame);
    if (!good && i % 15 == 0) run.episodes.emplace_back().first_frame = i;
    if (i % 50 == 0) {
      run.events.emplace_back().first_frame = i;
      run.events.back().in_time = good;
    }
  }
  return run;
}

bool two_thirds(int frame) { return frame / 10 % 3 != 0; }

TEST(Compare, FindsNoDifferenceBetweenIdenticalRuns) {
  const std::vector<SequenceScore> runs = {make_run(two_thirds)};
  const std::vector<Comparison> comparisons = compare(runs, runs);
  ASSERT_EQ(comparisons.size(), 7U);
  for (const Comparison& comparison : comparisons) {
    EXPECT_EQ(comparison.a, comparison.b) << comparison.name;
    EXPECT_EQ(comparison.difference.value, 0.0) << comparison.name;
    EXPECT_EQ(comparison.difference.low, 0.0) << comparison.name;
    EXPECT_EQ(comparison.difference.high, 0.0) << comparison.name;
    EXPECT_FALSE(comparison.is_worse()) << comparison.name;
  }
}

TEST(Compare, TellsARunThatIsClearlyWorseInEveryFigure) {
  const std::vector<SequenceScore> good = {make_run([](int frame) { return frame % 15 != 0; })};
  const std::vector<SequenceScore> bad = {make_run([](int frame) { return frame % 3 == 1; })};
  std::vector<std::string> worse;
  for (const Comparison& comparison : compare(good, bad)) {
    if (comparison.is_worse()) worse.push_back(comparison.name);
  }
  // Episodes begin in every 15th frame with both.
  EXPECT_EQ(worse, (std::vector<std::string>{"raw TPR", "raw PPV", "settled TPR", "settled PPV", "events warned in time",
                                             "distance error, median, m"}));
  for (const Comparison& comparison : compare(bad, good)) EXPECT_FALSE(comparison.is_worse()) << comparison.name;
}

TEST(Compare, CountsMoreEpisodesAsWorse) {
  const auto all_good = [](int) { return true; };
  const auto all_bad = [](int) { return false; };
  // None against one in each of 40 blocks in 40 s: 60 a minute, whatever blocks are drawn.
  const std::vector<Comparison> comparisons = compare({make_run(all_good)}, {make_run(all_bad)});
  const auto episodes = std::ranges::find(comparisons, "false-alarm episodes per minute", &Comparison::name);
  ASSERT_NE(episodes, comparisons.end());
  EXPECT_EQ(episodes->a, 0.0);
  EXPECT_NEAR(episodes->b, 60.0, 1e-9);
  EXPECT_NEAR(episodes->difference.low, 60.0, 1e-9);
  EXPECT_NEAR(episodes->difference.high, 60.0, 1e-9);
  EXPECT_TRUE(episodes->is_worse());
}

TEST(Compare, DrawsTheSameBlocksForBoth) {
  // Every third block is found in 8 of its 15 frames only, so the TPR depends much on the blocks drawn. b misses one frame more
  // of each block: the difference is 1/15 in every block, and so in every paired resample.
  const auto a = [](int frame) { return frame / 15 % 3 != 0 || frame % 15 >= 7; };
  const auto b = [a](int frame) { return a(frame) && frame % 15 != 7; };
  const Comparison tpr = compare({make_run(a)}, {make_run(b)})[0];
  EXPECT_EQ(tpr.name, "raw TPR");
  EXPECT_NEAR(tpr.difference.value, -1.0 / 15.0, 1e-12);
  EXPECT_NEAR(tpr.difference.low, -1.0 / 15.0, 1e-12);
  EXPECT_NEAR(tpr.difference.high, -1.0 / 15.0, 1e-12);
  EXPECT_TRUE(tpr.is_worse());
}

TEST(Compare, DoesNotCallASmallDifferenceWorse) {
  // One frame of 600 fewer: in 36 % of the resamples its block is not even drawn.
  const auto almost = [](int frame) { return two_thirds(frame) && frame != 200; };
  ASSERT_TRUE(two_thirds(200));
  const Comparison tpr = compare({make_run(two_thirds)}, {make_run(almost)})[0];
  EXPECT_LT(tpr.difference.value, 0.0);
  EXPECT_FALSE(tpr.is_worse());
}

/// The same walk with an edge ahead in each frame, settled and warned of.
SequenceScore make_approach(const std::function<bool(int)>& is_reported) {
  SequenceScore run = make_run([](int) { return true; });
  for (FrameScore& frame : run.frames) {
    const bool reported = is_reported(frame.frame);
    frame.ground = GroundState::seen;
    if (!reported) frame.detections.clear();
    frame.edges_ahead = {{1, 1.0, true, reported, true, !reported && frame.frame % 15 == 14}};
  }
  return run;
}

TEST(Compare, TellsWhoLosesWarningsInTheLastMetres) {
  // 9 of 15 frames reported in each block, and each block ends with a dropped warning: whatever blocks are drawn, the share
  // falls by 0.4, and 40 warnings in 40 s are 60 a minute.
  const std::vector<SequenceScore> steady = {make_approach([](int) { return true; })};
  const std::vector<SequenceScore> losing = {make_approach([](int frame) { return frame % 15 < 9; })};
  const std::vector<std::pair<std::string, double>> expected = {{"reported in the last metres", -0.4},
                                                                {"held in the last metres", -0.4},
                                                                {"dropped warnings per minute", 60.0},
                                                                {"false silence", 0.4}};
  const std::vector<Comparison> worse = compare(steady, losing);
  const std::vector<Comparison> better = compare(losing, steady);
  for (const auto& [name, difference] : expected) {
    const auto found = std::ranges::find(worse, name, &Comparison::name);
    ASSERT_NE(found, worse.end()) << name;
    EXPECT_NEAR(found->difference.value, difference, 1e-9) << name;
    EXPECT_NEAR(found->difference.low, difference, 1e-9) << name;
    EXPECT_NEAR(found->difference.high, difference, 1e-9) << name;
    EXPECT_TRUE(found->is_worse()) << name;
    EXPECT_FALSE(std::ranges::find(better, name, &Comparison::name)->is_worse()) << name;
  }
}

TEST(Compare, LeavesOutTheLastMetresWhereOneOfBothIsAnOlderScore) {
  const std::vector<SequenceScore> newer = {make_approach([](int) { return true; })};
  std::vector<SequenceScore> older = newer;
  for (FrameScore& frame : older[0].frames) frame.edges_ahead.reset();
  EXPECT_EQ(compare(newer, newer).size(), 11U);
  EXPECT_EQ(compare(older, newer).size(), 7U);
  EXPECT_EQ(compare(newer, older).size(), 7U);
}

TEST(Compare, LeavesOutWhatOneOfBothDoesNotHave) {
  SequenceScore silent = make_run(two_thirds);
  for (FrameScore& frame : silent.frames) frame.detections.clear();
  std::vector<std::string> names;
  for (const Comparison& comparison : compare({make_run(two_thirds)}, {silent})) names.push_back(comparison.name);
  EXPECT_EQ(std::ranges::count(names, "raw TPR"), 1);
  EXPECT_EQ(std::ranges::count(names, "distance error, median, m"), 0);
}

TEST(Compare, IsTheSameForTheSameSeed) {
  const std::vector<SequenceScore> a = {make_run(two_thirds)};
  const std::vector<SequenceScore> b = {make_run([](int frame) { return frame / 7 % 4 != 0; })};
  const std::vector<Comparison> first = compare(a, b);
  const std::vector<Comparison> again = compare(a, b);
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].difference.low, again[i].difference.low);
    EXPECT_EQ(first[i].difference.high, again[i].difference.high);
  }
}

std::string refusal(const std::function<void(std::vector<SequenceScore>&)>& change) {
  const std::vector<SequenceScore> a = {make_run(two_thirds)};
  std::vector<SequenceScore> b = a;
  change(b);
  return test::error_of<std::invalid_argument>([&] { compare(a, b); });
}

TEST(Compare, RefusesOtherSequencesFramesAndEvents) {
  test::expect_line_with(refusal([](auto& b) { b.clear(); }), "sequences = 1 and 0, must be equal to be compared");
  test::expect_line_with(refusal([](auto& b) { b[0].name = "ride"; }), "name of sequence 0 = walk and ride, must be equal");
  test::expect_line_with(refusal([](auto& b) { b[0].frames.pop_back(); }), "walk: frames = 600 and 599, must be equal");
  test::expect_line_with(refusal([](auto& b) { b[0].frames.back().frame = 700; }), "walk: number of frame 599 = 599 and 700");
  test::expect_line_with(refusal([](auto& b) { b[0].events.pop_back(); }), "walk: events = 12 and 11, must be equal");
  test::expect_line_with(refusal([](auto& b) { b[0].events[3].id = 5; }),
                         "walk: event 3 = id 0 from frame 150 and id 5 from frame 150, must be equal");
  test::expect_line_with(test::error_of<std::invalid_argument>([] { compare({}, {}); }), "sequences = 0, must be 1 or more");
}

}  // namespace
}  // namespace brink
