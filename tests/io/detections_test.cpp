#include "brink/detections.hpp"

#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "brink/sequence.hpp"
#include "expect_error.hpp"
#include "temporary_folder.hpp"
#include "test_data.hpp"

namespace brink {
namespace {

using Json = nlohmann::json;

// The example of docs/formats.md.
NegativeObstacle example_obstacle() {
  NegativeObstacle obstacle;
  obstacle.id = 3;
  obstacle.track_length = 9;
  Candidate& candidate = obstacle.candidate;
  candidate.type = CandidateType::below_ground;
  candidate.area_px = 812;
  candidate.contour = {{10, 20}, {30, 20}, {30, 40}};
  candidate.contour_3d = {{0.48, 1.02, 2.95}};
  candidate.centroid = {0.5, 1.1, 3.123456};
  candidate.nearest = {0.48, 1.02, 2.95};
  candidate.rim_nearest = {0.41, 0.66, 2.47};
  candidate.distance_m = 2.00004;
  candidate.bearing_deg = 11.70049;
  candidate.depth_m = 0.9;
  candidate.width_m = 1.4;
  candidate.measures = {.solid_angle_msr = 6.75,
                        .sigmas = 18.2,
                        .ground_misfit = 0.51,
                        .roughness = 1.25,
                        .agreement = 0.8,
                        .slope_deg = 34.5,
                        .share_beyond = 0.125,
                        .ground_share = 0.9,
                        .standing_share = 0.0625};
  return obstacle;
}

Detection example() {
  Detection detection;
  detection.frame = 12;
  detection.time = 0.8;
  detection.ground.state = GroundState::seen;
  detection.ground.confidence = 0.93;
  detection.ground.plane = GroundPlane{0.0, 0.1, 2.0};
  detection.ground.pose.height_m = 1.64;
  detection.ground.pose.pitch_deg = 24.9;
  detection.obstacles = {example_obstacle()};
  detection.times = {.disparity = 40.0,
                     .ground = 5.0,
                     .below_ground = 1.0,
                     .no_disparity = 0.5,
                     .ego_motion = 42.0,
                     .tracking = 0.25,
                     .total = 46.75};
  return detection;
}

TEST(JsonLine, IsOneLine) {
  const std::string line = to_json_line(example());
  EXPECT_EQ(line.find('\n'), line.size() - 1);
}

TEST(JsonLine, HoldsTheFrameAndItsGround) {
  const Json json = Json::parse(to_json_line(example()));
  EXPECT_EQ(json["frame"], 12);
  EXPECT_EQ(json["time"], 0.8);
  EXPECT_EQ(json["status"], "ok");
  EXPECT_FALSE(json.contains("reason"));
  EXPECT_EQ(json["ground"],
            Json::parse(R"({"state":"seen","confidence":0.93,"height_m":1.64,"pitch_deg":24.9,"roll_deg":0.0})"));
  EXPECT_EQ(json["ego_motion"], Json::parse(R"({"state":"none"})"));
  EXPECT_EQ(json["times_ms"],
            Json::parse(R"({"disparity":40.0,"ground":5.0,"below_ground":1.0,"no_disparity":0.5,"ego_motion":42.0,
                            "tracking":0.25,"total":46.75})"));
}

TEST(JsonLine, HoldsEveryFieldOfAnObstacleRounded) {
  const Json json = Json::parse(to_json_line(example()));
  ASSERT_EQ(json["obstacles"].size(), 1U);
  EXPECT_EQ(json["obstacles"][0], Json::parse(R"({"id":3,"type":"below_ground","evidence":"observed","kind":"unknown",
    "rim_nearest":[0.41,0.66,2.47],"distance_m":2.0,"bearing_deg":11.7,"nearest":[0.48,1.02,2.95],"centroid":[0.5,1.1,3.1235],
    "depth_m":0.9,"width_m":1.4,"area_px":812,
    "measures":{"solid_angle_msr":6.75,"sigmas":18.2,"ground_misfit":0.51,"roughness":1.25,"agreement":0.8,"slope_deg":34.5,"share_beyond":0.125,
    "ground_share":0.9,"standing_share":0.063},"contour":[[10,20],[30,20],[30,40]],"track_length":9})"));
  EXPECT_TRUE(json["tracks"].empty());
  EXPECT_TRUE(json["rejected"].empty());
}

TEST(JsonLine, HoldsTheCornersOfAContourOnly) {
  Detection detection;
  NegativeObstacle obstacle;
  obstacle.candidate.contour = {{4, 4}, {4, 5}, {4, 6}, {5, 7}, {6, 8}, {7, 8}, {6, 7}, {6, 6}, {6, 5}, {5, 4}};
  detection.obstacles = {obstacle};
  const Json json = Json::parse(to_json_line(detection));
  EXPECT_EQ(json["obstacles"][0]["contour"], Json::parse("[[4,4],[4,6],[6,8],[7,8],[6,7],[6,5],[5,4]]"));
}

TEST(JsonLine, GivesTracksTheSameFields) {
  Detection detection = example();
  detection.tracks = std::move(detection.obstacles);
  detection.obstacles.clear();
  const Json json = Json::parse(to_json_line(detection));
  EXPECT_TRUE(json["obstacles"].empty());
  EXPECT_EQ(json["tracks"][0], Json::parse(to_json_line(example()))["obstacles"][0]);
}

TEST(JsonLine, SaysThatType2IsInferredAndItsDepthUnknown) {
  Detection detection = example();
  detection.obstacles[0].candidate.type = CandidateType::no_disparity;
  detection.obstacles[0].candidate.depth_m.reset();
  const Json obstacle = Json::parse(to_json_line(detection))["obstacles"][0];
  EXPECT_EQ(obstacle["type"], "no_disparity");
  EXPECT_EQ(obstacle["evidence"], "inferred");
  EXPECT_TRUE(obstacle["depth_m"].is_null());
}

TEST(JsonLine, TellsTheKind) {
  Detection detection = example();
  for (const ObstacleKind kind : {ObstacleKind::stairs_down, ObstacleKind::edge, ObstacleKind::hole, ObstacleKind::unknown}) {
    detection.obstacles[0].candidate.kind = kind;
    EXPECT_EQ(Json::parse(to_json_line(detection))["obstacles"][0]["kind"], to_string(kind));
  }
}

TEST(JsonLine, TellsTheRuleThatRejected) {
  Detection detection = example();
  Candidate candidate;
  candidate.type = CandidateType::no_disparity;
  candidate.area_px = 200;
  candidate.rejection = Rejection{"black", 31.0, 20.0};
  detection.rejected = {candidate};
  EXPECT_EQ(Json::parse(to_json_line(detection))["rejected"][0],
            Json::parse(R"({"type":"no_disparity","rule":"black","value":31.0,"limit":20.0,"centroid":null,"area_px":200})"));
}

TEST(JsonLine, TellsWhyAFrameFailed) {
  const Json json = Json::parse(to_json_line(make_failed_detection(4, 0.4, FrameStatus::no_picture, "4.png: no such file")));
  EXPECT_EQ(json["frame"], 4);
  EXPECT_EQ(json["status"], "no_picture");
  EXPECT_EQ(json["reason"], "4.png: no such file");
  EXPECT_EQ(json["ground"]["state"], "not_visible");
  EXPECT_TRUE(json["ground"]["height_m"].is_null());
  EXPECT_TRUE(json["obstacles"].empty());
}

TEST(JsonLine, HoldsNoNanWhateverTheDetectionHolds) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Detection detection = example();
  detection.ground.confidence = nan;
  detection.obstacles[0].candidate.rim_nearest.setConstant(nan);
  detection.obstacles[0].candidate.distance_m = std::numeric_limits<double>::infinity();
  detection.obstacles[0].candidate.depth_m = nan;
  const std::string line = to_json_line(detection);
  const Json json = Json::parse(line);
  EXPECT_TRUE(json["ground"]["confidence"].is_null());
  EXPECT_EQ(json["obstacles"][0]["rim_nearest"], Json::parse("[null,null,null]"));
  EXPECT_TRUE(json["obstacles"][0]["distance_m"].is_null());
  EXPECT_TRUE(json["obstacles"][0]["depth_m"].is_null());
}

TEST(JsonLine, StaysJsonWhenAFileNameIsNoUtf8) {
  const std::string line = to_json_line(make_failed_detection(0, 0.0, FrameStatus::bad_frame, "\xff.png \"x\"\n"));
  EXPECT_EQ(Json::parse(line)["reason"], "\xEF\xBF\xBD.png \"x\"\n");  // U+FFFD for the byte
}

TEST(JsonLine, TellsAProbabilityThatIsKnown) {
  Detection detection = example();
  EXPECT_FALSE(Json::parse(to_json_line(detection))["obstacles"][0].contains("probability"));
  detection.obstacles[0].probability = 0.97049;
  EXPECT_EQ(Json::parse(to_json_line(detection))["obstacles"][0]["probability"], 0.97);
}

// One line of every kind of content.
std::string rich_text() {
  Detection seen = example();
  seen.obstacles[0].probability = 0.25;
  seen.tracks = {example_obstacle(), example_obstacle()};
  seen.tracks[1].candidate.type = CandidateType::no_disparity;
  seen.tracks[1].candidate.depth_m.reset();
  seen.tracks[1].candidate.contour = {{7, 8}};
  seen.tracks[0].candidate.kind = ObstacleKind::hole;
  Candidate black;
  black.type = CandidateType::no_disparity;
  black.rejection = Rejection{"black", 31.25, 20.0};
  black.centroid = {0.1, -0.2, 3.0};
  black.contour_3d = {black.centroid};
  Candidate bare;
  bare.area_px = 40;
  bare.rejection = Rejection{"contour", 0.0, 1.0};
  seen.rejected = {black, bare};
  Detection uncertain = example();
  uncertain.frame = 14;
  uncertain.ground.state = GroundState::uncertain;
  uncertain.ground.reason = "only 3 % of the picture";
  return to_json_line(seen) + to_json_line(make_failed_detection(13, 0.9, FrameStatus::no_picture, "13.png: no such file")) +
         to_json_line(uncertain);
}

std::string rewritten(const std::string& path) {
  std::string text;
  for (const Detection& detection : read_detections(path)) text += to_json_line(detection);
  return text;
}

TEST(ReadDetections, ReadsAllThatIsWritten) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(rewritten(folder.add("d.jsonl", rich_text())), rich_text());
}

TEST(ReadDetections, ReadsTheNumbersOfEachField) {
  const test::TemporaryFolder folder;
  const std::vector<Detection> detections = read_detections(folder.add("d.jsonl", rich_text()));
  ASSERT_EQ(detections.size(), 3U);
  const Detection& detection = detections[0];
  EXPECT_EQ(detection.frame, 12);
  EXPECT_EQ(detection.time, 0.8);
  ASSERT_TRUE(detection.ground.plane.has_value());
  EXPECT_EQ(detection.ground.pose.pitch_deg, 24.9);
  ASSERT_EQ(detection.obstacles.size(), 1U);
  const NegativeObstacle& obstacle = detection.obstacles[0];
  EXPECT_EQ(obstacle.id, 3);
  EXPECT_EQ(obstacle.track_length, 9);
  EXPECT_EQ(obstacle.probability, 0.25);
  EXPECT_EQ(obstacle.candidate.rim_nearest, Eigen::Vector3d(0.41, 0.66, 2.47));
  EXPECT_EQ(obstacle.candidate.distance_m, 2.0);
  EXPECT_EQ(obstacle.candidate.depth_m, 0.9);
  EXPECT_EQ(obstacle.candidate.contour, (std::vector<cv::Point>{{10, 20}, {30, 20}, {30, 40}}));
  EXPECT_EQ(obstacle.candidate.kind, ObstacleKind::unknown);
  EXPECT_EQ(detection.tracks[0].candidate.kind, ObstacleKind::hole);
  EXPECT_FALSE(detection.tracks[1].candidate.depth_m.has_value());
  EXPECT_FALSE(detection.tracks[0].probability.has_value());
  EXPECT_TRUE(detection.rejected[1].contour_3d.empty());
  EXPECT_EQ(detections[1].status, FrameStatus::no_picture);
  EXPECT_EQ(detections[1].reason, "13.png: no such file");
  EXPECT_FALSE(detections[1].ground.plane.has_value());
}

TEST(ReadDetections, ReadsTheNoiseOfDisparitiesWhereItIsTold) {
  const test::TemporaryFolder folder;
  Detection detection = example();
  detection.disparity_sd_px = 0.0944;
  const std::string text = to_json_line(detection);
  EXPECT_EQ(Json::parse(text)["ground"]["disparity_sd_px"], 0.094);
  EXPECT_EQ(read_detections(folder.add("d.jsonl", text)).at(0).disparity_sd_px, 0.094);
  EXPECT_FALSE(read_detections(folder.add("older.jsonl", to_json_line(example()))).at(0).disparity_sd_px.has_value());
}

TEST(ReadDetections, ReadsMergedRememberedAndMeasuredObstacles) {
  const test::TemporaryFolder folder;
  Detection detection = example();
  detection.obstacles[0].candidate.types = {CandidateType::below_ground, CandidateType::no_disparity};
  detection.obstacles[0].unseen_s = 0.133;
  detection.obstacles[0].time_to_edge_s = 2.25;
  const std::string text = to_json_line(detection);
  const Json obstacle = Json::parse(text)["obstacles"][0];
  EXPECT_EQ(obstacle["types"], Json::parse(R"(["below_ground","no_disparity"])"));
  EXPECT_EQ(obstacle["evidence"], "inferred") << "not seen in this frame";
  const NegativeObstacle read = read_detections(folder.add("d.jsonl", text)).at(0).obstacles.at(0);
  EXPECT_EQ(read.candidate.types, detection.obstacles[0].candidate.types);
  EXPECT_EQ(read.unseen_s, 0.133);
  EXPECT_EQ(read.time_to_edge_s, 2.25);
  EXPECT_EQ(read.candidate.measures.slope_deg, 34.5);
  std::string wrong = text;
  wrong.replace(wrong.find("no_disparity\"]"), 12, "no_such_type");
  test::expect_line_with(test::error_of<std::runtime_error>([&] { (void)read_detections(folder.add("w.jsonl", wrong)); }),
                         "obstacles[0].types[1]");
}

Detection moving_example() {
  Detection detection = example();
  detection.ego_motion_state = EgoMotionState::ok;
  detection.ego_motion.matches = 412;
  detection.ego_motion.inliers = 371;
  EgoMotion motion;
  motion.current_from_previous = Eigen::Translation3d(0.01, -0.002, -0.083) * Eigen::AngleAxisd(0.25, Eigen::Vector3d::UnitY());
  detection.ego_motion.motion = motion;
  return detection;
}

TEST(JsonLine, HoldsTheEgoMotion) {
  const Json json = Json::parse(to_json_line(moving_example()))["ego_motion"];
  EXPECT_EQ(json["state"], "ok");
  EXPECT_EQ(json["matches"], 412);
  EXPECT_EQ(json["inliers"], 371);
  EXPECT_EQ(json["current_from_previous"][2][3], -0.083);
  EXPECT_EQ(json["current_from_previous"][3], Json({0.0, 0.0, 0.0, 1.0}));
}

TEST(ReadDetections, ReadsWhatADepthSensorWithoutPicturesLeavesOut) {
  Detection detection = moving_example();
  detection.ego_motion_state = EgoMotionState::ground;
  detection.no_disparity_off = "no left picture";
  const Json json = Json::parse(to_json_line(detection));
  EXPECT_EQ(json["ego_motion"]["state"], "ground");
  EXPECT_EQ(json["no_disparity_off"], "no left picture");
  EXPECT_FALSE(Json::parse(to_json_line(example())).contains("no_disparity_off"));
  const test::TemporaryFolder folder;
  EXPECT_EQ(rewritten(folder.add("d.jsonl", to_json_line(detection))), to_json_line(detection));
}

TEST(ReadDetections, ReadsTheEgoMotionBack) {
  const test::TemporaryFolder folder;
  Detection failed = example();
  failed.frame = 13;
  failed.ego_motion_state = EgoMotionState::failed;
  failed.ego_motion.reason = "too few matches";
  const std::string text = to_json_line(moving_example()) + to_json_line(failed);
  EXPECT_EQ(rewritten(folder.add("d.jsonl", text)), text);
  Json json = Json::parse(to_json_line(moving_example()));
  json["ego_motion"]["current_from_previous"].erase(3);
  const std::string path = folder.add("short.jsonl", json.dump() + "\n");
  test::expect_line_with(test::error_of<std::runtime_error>([&] { read_detections(path); }),
                         "ego_motion.current_from_previous");
}

TEST(ReadDetections, LeavesOutEmptyLinesAndFieldsThatItDoesNotKnow) {
  const test::TemporaryFolder folder;
  Json json = Json::parse(to_json_line(example()));
  json["new"] = Json::parse(R"({"a":[1,null]})");
  json["obstacles"][0]["new"] = 1e300;
  const std::string path = folder.add("d.jsonl", "\n" + json.dump() + "\r\n\n");
  EXPECT_EQ(rewritten(path), to_json_line(example()));
}

std::string fault_of(const std::string& text) {
  const test::TemporaryFolder folder;
  const std::string path = folder.add("d.jsonl", text);
  std::string fault = test::error_of<std::runtime_error>([&] { read_detections(path); });
  EXPECT_TRUE(fault.starts_with(path + ": ")) << fault;
  return fault;
}

// The fault of the example with one value changed.
std::string fault_with(const char* pointer, const Json& value) {
  Json json = Json::parse(to_json_line(example()));
  json[Json::json_pointer(pointer)] = value;
  return fault_of(json.dump() + "\n");
}

std::string fault_without(const char* pointer, const char* name) {
  Json json = Json::parse(to_json_line(example()));
  EXPECT_EQ(json[Json::json_pointer(pointer)].erase(name), 1U);
  return fault_of(json.dump() + "\n");
}

TEST(ReadDetections, NamesALineThatIsCutOff) {
  const std::string line = to_json_line(example());
  for (std::size_t length = 1; length + 1 < line.size(); length += 3) {
    const std::string cut = line.substr(0, length);
    test::expect_line_with(fault_of(line + cut), "line 2: is cut off");
  }
}

TEST(ReadDetections, SaysThatNanIsNoJson) {
  std::string line = to_json_line(example());
  line.replace(line.find("0.8"), 3, "NaN");
  test::expect_line_with(fault_of(line), "line 1: is no JSON at column 20");
}

TEST(ReadDetections, RefusesANumberThatIsTooLarge) {
  std::string line = to_json_line(example());
  line.replace(line.find("0.8"), 3, "1e999");
  test::expect_line_with(fault_of(line), "line 1: holds a number that is too large");
}

TEST(ReadDetections, RefusesWhatIsNoObject) {
  test::expect_line_with(fault_of("[1]\n"), "line 1: the line = [1], expected an object");
  test::expect_line_with(fault_of("frame,time\n"), "line 1: is no JSON at column 2");
}

TEST(ReadDetections, RefusesAnEmptyFile) {
  test::expect_line_with(fault_of(""), "is empty, expected one line for each frame");
  test::expect_line_with(fault_of("\n\n"), "is empty");
}

TEST(ReadDetections, RefusesAFileThatIsNotThereOrAFolder) {
  const test::TemporaryFolder folder;
  test::expect_line_with(test::error_of<std::runtime_error>([&] { read_detections(folder / "no"); }), "no: no such file");
  test::expect_line_with(test::error_of<std::runtime_error>([&] { read_detections(folder / ""); }), "is a folder");
}

TEST(ReadDetections, RefusesFramesThatDoNotIncrease) {
  test::expect_line_with(fault_of(rich_text() + rich_text()), "line 4: frame = 12, expected more than the one before, 14");
  test::expect_line_with(fault_of(to_json_line(example()) + to_json_line(example())), "line 2: frame = 12");
}

TEST(ReadDetections, NamesTheFieldThatIsWrong) {
  test::expect_line_with(fault_with("/obstacles/0/distance_m", "x"), R"(obstacles[0].distance_m = "x", expected a number)");
  test::expect_line_with(fault_with("/obstacles/0/distance_m", nullptr), "obstacles[0].distance_m = null, expected a number");
  test::expect_line_with(fault_with("/obstacles/0/depth_m", true), "obstacles[0].depth_m = true, expected a number or null");
  test::expect_line_with(fault_with("/obstacles/0/nearest", {1, 2}), "nearest = [1,2], expected three numbers");
  test::expect_line_with(fault_with("/obstacles/0/nearest", {1, 2, nullptr}), "nearest = [1,2,null], expected three numbers");
  test::expect_line_with(fault_with("/obstacles/0/kind", "pit"),
                         R"(obstacles[0].kind = "pit", expected unknown or stairs_down or edge or hole)");
  test::expect_line_with(fault_with("/obstacles/0/probability", 1.5), "probability = 1.5, expected a number from 0 to 1");
  test::expect_line_with(fault_with("/obstacles/0", 7), "obstacles[0] = 7, expected an object");
  test::expect_line_with(fault_with("/tracks", Json::object()), "tracks = {}, expected a list");
  test::expect_line_with(fault_with("/ground", "seen"), R"(ground = "seen", expected an object)");
  test::expect_line_with(fault_with("/ground/height_m", nullptr), "ground.height_m = null, expected a number");
  test::expect_line_with(fault_with("/frame", 1.5), "frame = 1.5, expected an integer");
  test::expect_line_with(fault_with("/frame", -1), "frame = -1, expected an integer from 0");
  test::expect_line_with(fault_with("/frame", 3000000000U), "frame = 3000000000, expected an integer");
}

TEST(ReadDetections, NamesTheFieldThatIsMissing) {
  test::expect_line_with(fault_without("", "obstacles"), "line 1: obstacles is missing, expected a list");
  test::expect_line_with(fault_without("/obstacles/0", "distance_m"), "obstacles[0].distance_m is missing, expected a number");
  test::expect_line_with(fault_without("/times_ms", "total"), "times_ms.total is missing, expected a number");
}

TEST(ReadDetections, RefusesNamesThatItDoesNotKnow) {
  test::expect_line_with(fault_with("/status", "okay"), R"(status = "okay", expected ok or no_picture or bad_frame)");
  test::expect_line_with(fault_with("/ground/state", 1), "ground.state = 1, expected seen or uncertain or not_visible");
  test::expect_line_with(fault_with("/obstacles/0/type", "hole"), "expected below_ground or no_disparity");
}

TEST(ReadDetections, RefusesContoursThatAreNoPixels) {
  test::expect_line_with(fault_with("/obstacles/0/contour", "x"), R"(contour = "x", expected a list of points)");
  test::expect_line_with(fault_with("/obstacles/0/contour/1", {1.5, 2}),
                         "obstacles[0].contour[1] = [1.5,2], expected two integers from -1000000 to 1000000");
  test::expect_line_with(fault_with("/obstacles/0/contour/2", {1, 1000001}), "contour[2] = [1,1000001], expected two integers");
  test::expect_line_with(fault_with("/obstacles/0/contour/0", {1, 2, 3}), "contour[0] = [1,2,3], expected two integers");
}

TEST(ReadDetections, ShortensLongValuesInMessages) {
  const std::string fault = fault_with("/tracks", std::string(500, 'x'));
  test::expect_line_with(fault, "xxx..., expected a list");
  EXPECT_LT(fault.size(), 200U);
}

// What the detector says of real pictures comes back as it was written.
TEST(ReadDetections, ReadsWhatTheDetectorSaysOfRealPotholes) {
  BRINK_REQUIRE_DATA(data, "pothole_b");
  DetectorParams params;
  params.stills = true;
  params.candidates.min_depth_m = 0.01;
  Detector detector(params);
  const Sequence sequence = open_sequence(data);
  std::string text;
  for (int i = 0; i < sequence.size(); ++i) text += to_json_line(detector.process(sequence.read(i).frame));
  EXPECT_NE(text.find("\"contour\""), std::string::npos);
  const test::TemporaryFolder folder;
  EXPECT_EQ(rewritten(folder.add("d.jsonl", text)), text);
}

}  // namespace
}  // namespace brink
