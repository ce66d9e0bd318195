#include "brink/detections.hpp"

#include <limits>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

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
  detection.times = {40.0, 5.0, 1.0, 0.5, 46.5};
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
            Json::parse(R"({"disparity":40.0,"ground":5.0,"below_ground":1.0,"no_disparity":0.5,"total":46.5})"));
}

TEST(JsonLine, HoldsEveryFieldOfAnObstacleRounded) {
  const Json json = Json::parse(to_json_line(example()));
  ASSERT_EQ(json["obstacles"].size(), 1U);
  EXPECT_EQ(json["obstacles"][0], Json::parse(R"({"id":3,"type":"below_ground","evidence":"observed","kind":"unknown",
    "rim_nearest":[0.41,0.66,2.47],"distance_m":2.0,"bearing_deg":11.7,"nearest":[0.48,1.02,2.95],"centroid":[0.5,1.1,3.1235],
    "depth_m":0.9,"width_m":1.4,"area_px":812,"contour":[[10,20],[30,20],[30,40]],"track_length":9})"));
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

}  // namespace
}  // namespace brink
