#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "brink/evaluation.hpp"
#include "count_fields.hpp"
#include "expect_error.hpp"
#include "temporary_folder.hpp"

namespace brink {
namespace {

using Json = nlohmann::ordered_json;

// Numbers whose decimal expansion is long, extreme, or not that of a short decimal.
SequenceScore make_sequence() {
  SequenceScore sequence;
  sequence.name = "walk \"1\"";
  sequence.duration_s = 41.0 / 15.0;
  sequence.walked_m = std::nextafter(4.0, 5.0);
  FrameScore frame;
  frame.frame = 12;
  frame.time = 0.1 + 0.2;
  frame.status = FrameStatus::bad_frame;
  frame.ground = GroundState::uncertain;
  frame.fragments = 3;
  frame.instances = {{7, 400, 1.0 / 3.0, true, true, true, true, true, 0.7, false},
                     {8, 100, std::nullopt, false, false, false, false, false, std::nullopt, std::nullopt}};
  DetectionScore detection;
  detection.id = 5;
  detection.hits = {7, 8};
  detection.distance_m = std::numeric_limits<double>::min();
  detection.distance_error_m = -1e-17;
  detection.bearing_error_deg = -0.0;
  detection.probability = 0.97;
  detection.kind = ObstacleKind::edge;
  detection.true_kind = ObstacleKind::stairs_down;
  frame.detections = {detection, {6, {}, true, true, 1e300, {}, {}, {}, 0, {}, {}}};
  frame.edges_ahead = {{7, 0.1 + 0.7, true, false, true, true}, {8, 1.9, false, true, true, false}};
  sequence.frames = {frame};
  sequence.events = {{7, 12, 1.1, 0.9, 12, 1.1, 0.7, true, 1.0 / 3.0}, {8, 12, 2.2, 2.1, {}, {}, {}, false, {}}};
  sequence.episodes = {{12, 12, 1, {0.1, -0.2, 1e-9}}};
  return sequence;
}

StoredScores read(const std::string& text) {
  const test::TemporaryFolder folder;
  return read_scores(folder.add("scores.json", text));
}

std::string fault(const std::string& text) {
  return test::error_of<std::runtime_error>([&] { read(text); });
}

// The message for a file in which one thing is changed.
std::string fault(const std::function<void(Json&)>& change) {
  Json json = Json::parse(to_json({make_sequence()}, {}));
  change(json);
  return fault(json.dump());
}

TEST(ScoresFile, GivesBackEveryFieldAsItWas) {
  const SequenceScore written = make_sequence();
  const StoredScores stored = read(to_json({written, SequenceScore{}}, {}));
  ASSERT_EQ(stored.sequences.size(), 2U);
  const SequenceScore& read = stored.sequences[0];
  EXPECT_EQ(read.name, written.name);
  EXPECT_EQ(read.duration_s, written.duration_s);
  EXPECT_EQ(read.walked_m, written.walked_m);
  ASSERT_EQ(read.frames.size(), 1U);
  const FrameScore& frame = read.frames[0];
  EXPECT_EQ(frame.frame, 12);
  EXPECT_EQ(frame.time, 0.1 + 0.2);
  EXPECT_EQ(frame.status, FrameStatus::bad_frame);
  EXPECT_EQ(frame.ground, GroundState::uncertain);
  EXPECT_EQ(frame.fragments, 3);
  ASSERT_EQ(frame.instances.size(), 2U);
  EXPECT_EQ(frame.instances[0].distance_m, 1.0 / 3.0);
  EXPECT_FALSE(frame.instances[1].distance_m.has_value());
  EXPECT_EQ(frame.instances[0].depth_m, 0.7);
  EXPECT_EQ(frame.instances[0].expected, false);
  EXPECT_FALSE(frame.instances[1].expected.has_value());
  ASSERT_EQ(frame.detections.size(), 2U);
  EXPECT_EQ(frame.detections[0].hits, (std::vector<int>{7, 8}));
  EXPECT_EQ(frame.detections[0].distance_m, std::numeric_limits<double>::min());
  EXPECT_EQ(frame.detections[0].distance_error_m, -1e-17);
  EXPECT_TRUE(std::signbit(*frame.detections[0].bearing_error_deg));
  EXPECT_EQ(frame.detections[0].probability, 0.97);
  EXPECT_EQ(frame.detections[0].kind, ObstacleKind::edge);
  EXPECT_EQ(frame.detections[0].true_kind, ObstacleKind::stairs_down);
  EXPECT_FALSE(frame.detections[1].true_kind.has_value());
  EXPECT_EQ(frame.detections[1].distance_m, 1e300);
  EXPECT_EQ(frame.detections[1].episode, 0);
  EXPECT_EQ(read.events[0].lead_time_s, 0.7);
  EXPECT_FALSE(read.events[1].warned_frame.has_value());
  EXPECT_EQ(read.episodes[0].place, Eigen::Vector3d(0.1, -0.2, 1e-9));
  EXPECT_FALSE(stored.sequences[1].walked_m.has_value());
}

TEST(ScoresFile, IsTheSameTextWhenWrittenAgain) {
  EvaluationParams params;
  params.max_range_m = 4.3;
  params.seed = 12;
  const std::string text = to_json({make_sequence()}, params);
  const StoredScores stored = read(text);
  EXPECT_EQ(stored.params.max_range_m, 4.3);
  EXPECT_EQ(stored.params.seed, 12);
  EXPECT_EQ(to_json(stored.sequences, stored.params), text);
}

TEST(ScoresFile, HoldsAsManyFieldsAsTheStructuresHave) {
  const Json json = Json::parse(to_json({make_sequence()}, {}));
  EXPECT_EQ(json["params"].size(), test::count_fields<EvaluationParams>());
  const Json& sequence = json["sequences"][0];
  EXPECT_EQ(sequence.size(), test::count_fields<SequenceScore>());
  EXPECT_EQ(sequence["events"][0].size(), test::count_fields<ApproachEvent>());
  EXPECT_EQ(sequence["episodes"][0].size(), test::count_fields<Episode>());
  EXPECT_EQ(sequence["frames"][0].size(), test::count_fields<FrameScore>());
  EXPECT_EQ(sequence["frames"][0]["edges_ahead"][0].size(), test::count_fields<EdgeAhead>());
  EXPECT_EQ(sequence["frames"][0]["instances"][0].size(), test::count_fields<InstanceScore>());
  EXPECT_EQ(sequence["frames"][0]["detections"][0].size(), test::count_fields<DetectionScore>());
}

TEST(ScoresFile, IsReadWithoutTheKindsThatOlderVersionsDoNotTell) {
  Json json = Json::parse(to_json({make_sequence()}, {}));
  Json& detection = json["sequences"][0]["frames"][0]["detections"][0];
  EXPECT_EQ(detection.erase("kind") + detection.erase("true_kind"), 2U);
  const StoredScores stored = read(json.dump());
  EXPECT_FALSE(stored.sequences[0].frames[0].detections[0].kind.has_value());
  EXPECT_FALSE(stored.sequences[0].frames[0].detections[0].true_kind.has_value());
}

TEST(ScoresFile, IsReadWithoutTheFieldsThatOlderOnesLack) {
  Json json = Json::parse(to_json({make_sequence()}, {}));
  Json& instance = json["sequences"][0]["frames"][0]["instances"][0];
  instance.erase("depth_m");
  instance.erase("expected");
  const StoredScores stored = read(json.dump());
  EXPECT_FALSE(stored.sequences[0].frames[0].instances[0].depth_m.has_value());
  EXPECT_FALSE(stored.sequences[0].frames[0].instances[0].expected.has_value());
  instance["expected"] = 1;
  test::expect_line_with(fault(json.dump()), "instances[0].expected = 1, expected true or false");
}

TEST(ScoresFile, GivesBackTheLastMetresAsTheyWere) {
  EvaluationParams params;
  params.ahead_range_m = 2.5;
  params.ahead_deg = 45.0;
  params.claim_error_m = 0.2;
  params.dropped_s = 0.5;
  const StoredScores stored = read(to_json({make_sequence()}, params));
  EXPECT_EQ(stored.params.ahead_range_m, 2.5);
  EXPECT_EQ(stored.params.ahead_deg, 45.0);
  EXPECT_EQ(stored.params.claim_error_m, 0.2);
  EXPECT_EQ(stored.params.dropped_s, 0.5);
  EXPECT_EQ(stored.sequences[0].events[0].held, 1.0 / 3.0);
  EXPECT_FALSE(stored.sequences[0].events[1].held.has_value());
  const std::vector<EdgeAhead> edges = stored.sequences[0].frames[0].edges_ahead.value();
  ASSERT_EQ(edges.size(), 2U);
  EXPECT_EQ(edges[0].id, 7);
  EXPECT_EQ(edges[0].distance_m, 0.1 + 0.7);
  EXPECT_TRUE(edges[0].settled);
  EXPECT_FALSE(edges[0].reported);
  EXPECT_TRUE(edges[0].warned);
  EXPECT_TRUE(edges[0].dropped);
  EXPECT_FALSE(edges[1].settled);
  EXPECT_TRUE(edges[1].reported);
  EXPECT_FALSE(edges[1].dropped);
}

TEST(ScoresFile, IsReadWithoutTheLastMetresThatOlderOnesLack) {
  EvaluationParams params;
  params.ahead_range_m = 2.5;
  Json json = Json::parse(to_json({make_sequence()}, params));
  for (const char* name : {"ahead_range_m", "ahead_deg", "claim_error_m", "dropped_s"}) json["params"].erase(name);
  json["sequences"][0]["frames"][0].erase("edges_ahead");
  json["sequences"][0]["events"][0].erase("held");
  const StoredScores stored = read(json.dump());
  EXPECT_EQ(stored.params.ahead_range_m, 2.0);
  EXPECT_FALSE(stored.sequences[0].frames[0].edges_ahead.has_value());
  EXPECT_FALSE(stored.sequences[0].events[0].held.has_value());
  json["params"]["ahead_deg"] = "wide";
  test::expect_line_with(fault(json.dump()), R"(params.ahead_deg = "wide", expected a number)");
}

TEST(ScoresFile, BeginsWithItsFormat) { EXPECT_TRUE(to_json({}, {}).starts_with(R"({"format":"brink-scores-1","params":{)")); }

TEST(ScoresFile, StaysJsonWhenANameIsNoUtf8) {
  SequenceScore sequence;
  sequence.name = "\xff";
  EXPECT_EQ(Json::parse(to_json({sequence}, {}))["sequences"][0]["name"], "\xEF\xBF\xBD");
}

TEST(ScoresFile, IsRefusedInOneLineWhereverItIsCutOff) {
  const std::string text = to_json({make_sequence()}, {});
  for (std::size_t length = 0; length + 1 < text.size(); length += 7) {
    test::expect_line_with(fault(text.substr(0, length)),
                           length == 0 ? "scores.json: is empty" : "scores.json: is no JSON at byte");
  }
}

TEST(ScoresFile, OfAnotherKindIsRefused) {
  test::expect_line_with(fault("[]"), R"(scores.json: format = null, expected "brink-scores-1")");
  test::expect_line_with(fault("{}"), R"(scores.json: format = null, expected "brink-scores-1")");
  test::expect_line_with(fault(R"({"format":"brink-scores-2"})"), R"(format = "brink-scores-2", expected "brink-scores-1")");
  test::expect_line_with(fault(R"({"frame":0,"obstacles":[]}{"frame":1})"), "scores.json: is no JSON at byte 27 of 37");
  test::expect_line_with(fault(R"({"format":5e999})"), "scores.json: holds a number that is too large");
  EXPECT_THROW(read_scores("/nowhere/scores.json"), std::runtime_error);
}

TEST(ScoresFile, NamesTheFieldThatIsWrong) {
  test::expect_line_with(fault([](Json& j) { j.erase("sequences"); }), "scores.json: sequences is missing");
  test::expect_line_with(fault([](Json& j) { j["sequences"] = 3; }), "scores.json: sequences = 3, expected a list");
  test::expect_line_with(fault([](Json& j) { j["params"] = Json::array(); }),
                         "scores.json: params = [...], expected an object");
  test::expect_line_with(fault([](Json& j) { j["sequences"][0]["frames"][0]["time"] = "x"; }),
                         R"(scores.json: sequences[0].frames[0].time = "x", expected a number)");
  test::expect_line_with(fault([](Json& j) { j["sequences"][0]["frames"][0]["time"] = nullptr; }),
                         "sequences[0].frames[0].time = null, expected a number");
  test::expect_line_with(fault([](Json& j) { j["sequences"][0]["frames"][0].erase("ground"); }),
                         "sequences[0].frames[0].ground is missing");
  test::expect_line_with(fault([](Json& j) { j["sequences"][0]["frames"][0]["status"] = "good"; }),
                         R"(frames[0].status = "good", expected one of ok, no_picture, bad_frame)");
  test::expect_line_with(fault([](Json& j) { j["sequences"][0]["frames"][0]["instances"][1]["id"] = 1.5; }),
                         "instances[1].id = 1.5, expected an integer");
  test::expect_line_with(fault([](Json& j) { j["sequences"][0]["frames"][0]["instances"][1]["id"] = 5'000'000'000; }),
                         "instances[1].id = 5000000000, expected an integer");
  test::expect_line_with(fault([](Json& j) { j["sequences"][0]["frames"][0]["instances"][1]["hit"] = 1; }),
                         "instances[1].hit = 1, expected true or false");
  test::expect_line_with(fault([](Json& j) { j["sequences"][0]["name"] = Json::object(); }),
                         "sequences[0].name = {...}, expected a text");
  test::expect_line_with(fault([](Json& j) {
                           j["sequences"][0]["episodes"][0]["place"] = Json::array({1, 2});
                         }),
                         "sequences[0].episodes[0].place = [...], expected three numbers");
}

TEST(ScoresFile, NamesWhatContradictsItself) {
  test::expect_line_with(fault([](Json& j) { j["params"]["block_frames"] = 0; }),
                         "scores.json: evaluation.block_frames = 0, must be 1 to");
  test::expect_line_with(fault([](Json& j) { j["sequences"][0]["frames"].push_back(j["sequences"][0]["frames"][0]); }),
                         "scores.json: sequences[0].frames[1].frame = 12, expected more than the one before, 12");
  test::expect_line_with(fault([](Json& j) { j["sequences"][0]["episodes"][0]["first_frame"] = 13; }),
                         "sequences[0].episodes[0].first_frame = 13, expected the number of one of the frames");
}

}  // namespace
}  // namespace brink
