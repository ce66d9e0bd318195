#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "app/command.hpp"
#include "brink/detections.hpp"
#include "brink/disparity.hpp"
#include "brink/sequence_writer.hpp"

namespace brink::test {
namespace {

using Json = nlohmann::json;

constexpr int kFrames = 30;
constexpr double kFps = 15.0;
const cv::Size kSize(160, 120);
const cv::Rect kHole(60, 70, 40, 20);

StereoCamera camera() { return {.focal = 100.0, .cx = 80.0, .cy = 60.0, .baseline = 0.15}; }

/// A camera at rest, 1.6 m over the ground and looking ahead; a hole whose rim begins 3 m ahead fills kHole.
void write_sequence(const std::string& folder) {
  const SequenceWriter writer(folder, "test: 1\n", Existing::refuse);
  cv::Mat1b negative(kSize, uchar{0});
  negative(kHole).setTo(1);
  std::vector<double> times;
  for (int frame = 0; frame < kFrames; ++frame) {
    const cv::Mat3b picture(kSize, cv::Vec3b::all(static_cast<uchar>(90 + frame)));  // tells which frame it is
    writer.write_pictures(frame, picture, picture, 0);
    writer.write_truth(frame, cv::Mat1f(kSize, 1.0F), negative);
    times.push_back(frame / kFps);
  }
  writer.write_calibration(camera());
  writer.write_times(times);
  writer.write_poses(std::vector<Eigen::Isometry3d>(kFrames, Eigen::Isometry3d::Identity()));
  writer.write_instances({{1, "manhole", 1.0, {{-1.0, 1.6, 3.0}, {1.0, 1.6, 3.0}, {1.0, 1.6, 5.0}, {-1.0, 1.6, 5.0}}}});
  SequenceWriter(folder, "test: 1\n", Existing::resume).commit();
}

NegativeObstacle obstacle(const cv::Rect& area, double distance_m) {
  NegativeObstacle one;
  one.id = 7;
  one.candidate.contour = {area.tl(), {area.br().x - 1, area.y}, area.br() - cv::Point(1, 1), {area.x, area.br().y - 1}};
  one.candidate.distance_m = distance_m;
  one.candidate.rim_nearest = {0.0, 1.6, distance_m};
  one.candidate.area_px = area.area();
  return one;
}

/// Detections of every frame, the same obstacles in each.
std::string detections(const std::vector<NegativeObstacle>& obstacles, int frames = kFrames) {
  std::string text;
  for (int frame = 0; frame < frames; ++frame) {
    Detection detection;
    detection.frame = frame;
    detection.time = frame / kFps;
    detection.ground.state = GroundState::seen;
    detection.ground.plane = GroundPlane{};
    detection.ground.pose.height_m = 1.6;
    detection.obstacles = obstacles;
    text += to_json_line(detection);
  }
  return text;
}

class Evaluate : public ::testing::Test {
 protected:
  Evaluate() {
    write_sequence(folder_ / "suite/walk");
    found_ = folder_.add("results/walk.jsonl", detections({obstacle(kHole, 3.0)}));
    nothing_ = folder_.add("nothing.jsonl", detections({}));
    truth_ = " --truth " + folder_ / "suite/walk";
  }

  // One line that holds `part`, the exit code, and nothing left behind.
  void expect_refusal(const std::string& arguments, int exit_code, const std::string& part) const {
    const auto before = folder_.list();
    const CommandResult result = run_command(arguments);
    EXPECT_EQ(result.exit_code, exit_code) << arguments << "\n" << result.errors;
    EXPECT_EQ(lines_of(result.errors).size(), 1U) << result.errors;
    EXPECT_NE(result.errors.find(part), std::string::npos) << "\"" << result.errors << "\" does not hold \"" << part << "\"";
    EXPECT_EQ(folder_.list(), before) << arguments;
  }

  TemporaryFolder folder_;
  std::string found_;
  std::string nothing_;
  std::string truth_;
};

// 30 instances, all hit. At 15 frames per second the first six of them are not settled yet.
TEST_F(Evaluate, ScoresDetections) {
  const CommandResult result = run_command("evaluate " + found_ + truth_ + " --json");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const Json summary = Json::parse(result.output)["summary"];
  EXPECT_EQ(summary["raw"]["counts"], Json({{"tp", 30}, {"fn", 0}, {"fp", 0}}));
  EXPECT_EQ(summary["settled"]["counts"], Json({{"tp", 24}, {"fn", 0}, {"fp", 0}}));
  EXPECT_NEAR(summary["raw"]["ceiling"].get<double>(), 26.0 / 30.0, 1e-9);
  EXPECT_LT(summary["localisation"]["distance_error_median_m"].get<double>(), 0.02);
}

TEST_F(Evaluate, PrintsTablesWithTheRowsOfThePaper) {
  const CommandResult result = run_command("evaluate " + nothing_ + truth_);
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("| walk | 30 | 30 | 0 | 30 | 0 | 0 | 0.000 | 0.867 | - | 0.000 | - |"), std::string::npos)
      << result.output;
  EXPECT_NE(result.output.find("| paper S1, stairs | 213 | 253 | 230 | 23 | 56 | - | 0.909 | - | 0.804 | - | - |"),
            std::string::npos);
  EXPECT_NE(result.output.find("| paper, all | 790 | 924 | 836 | 88 | 115 | - | 0.905 | - | 0.879 | - | - |"),
            std::string::npos);
}

TEST_F(Evaluate, TakesSeveralPairs) {
  const CommandResult result = run_command("evaluate " + found_ + " " + nothing_ + truth_ + truth_ + " --json");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const Json json = Json::parse(result.output);
  EXPECT_EQ(json["summary"]["raw"]["counts"], Json({{"tp", 30}, {"fn", 30}, {"fp", 0}}));
  EXPECT_EQ(json["by_domain"], Json({{"walk", json["summary"]}}));  // both pairs are of the one domain
}

TEST_F(Evaluate, RunsTheDetectorOverASuiteWhereResultsAreMissing) {
  const std::string suite = "evaluate --suite " + folder_ / "suite" + " --results " + folder_ / "new" + " --run --stills";
  const CommandResult first = run_command(suite);
  ASSERT_EQ(first.exit_code, 0) << first.errors;
  const auto made = std::filesystem::last_write_time(folder_ / "new/walk.jsonl");
  const CommandResult second = run_command(suite);
  EXPECT_EQ(second.output, first.output);
  EXPECT_EQ(std::filesystem::last_write_time(folder_ / "new/walk.jsonl"), made);
  expect_refusal(suite + " --method paper", 1, "parameters.yaml: other parameters made these results");
}

// COCO's data format: every key that its readers ask for, ids that refer to each other, a polygon of x and y in turn.
TEST_F(Evaluate, WritesACocoDataSet) {
  ASSERT_EQ(run_command("evaluate " + found_ + truth_ + " --coco " + folder_ / "coco.json").exit_code, 0);
  const Json coco = Json::parse(read_file(folder_ / "coco.json"));
  ASSERT_EQ(coco["images"].size(), 30U);
  ASSERT_EQ(coco["annotations"].size(), 30U);
  ASSERT_EQ(coco["categories"].size(), 1U);
  std::set<int> images;
  for (const Json& image : coco["images"]) {
    EXPECT_TRUE(images.insert(image["id"].get<int>()).second);
    EXPECT_EQ(image["width"], 160);
    EXPECT_EQ(image["height"], 120);
  }
  EXPECT_EQ(coco["images"][3]["file_name"], "walk/image_2/000003.png");
  std::set<int> ids;
  for (const Json& annotation : coco["annotations"]) {
    EXPECT_TRUE(ids.insert(annotation["id"].get<int>()).second);
    EXPECT_TRUE(images.contains(annotation["image_id"].get<int>()));
    EXPECT_EQ(annotation["category_id"], coco["categories"][0]["id"]);
    EXPECT_EQ(annotation["iscrowd"], 0);
    EXPECT_EQ(annotation["score"], 1.0);
    EXPECT_EQ(annotation["area"], 800);
    EXPECT_EQ(annotation["bbox"], Json({60, 70, 40, 20}));
    EXPECT_EQ(annotation["segmentation"], Json({{60, 70, 99, 70, 99, 89, 60, 89}}));
  }
}

TEST_F(Evaluate, DrawsAndExplainsMisses) {
  ASSERT_EQ(run_command("evaluate " + nothing_ + truth_ + " --gallery " + folder_ / "gallery").exit_code, 0);
  EXPECT_EQ(read_picture(folder_ / "gallery/miss_01.png").size(), kSize);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "gallery/miss_02.png"));  // the same instance all the time
  EXPECT_NE(read_file(folder_ / "gallery/causes.md").find("| no region | 24 | 100.0 | 1 |"), std::string::npos)
      << read_file(folder_ / "gallery/causes.md");
}

TEST_F(Evaluate, DrawsTheFrameOfTheMaskWhereOthersHaveNone) {
  for (int frame = 0; frame < 20; ++frame) {
    std::filesystem::remove(folder_ / fmt::format("suite/walk/negative/{:06}.png", frame));
    std::filesystem::remove(folder_ / fmt::format("suite/walk/disparity/{:06}.png", frame));
  }
  std::string last;
  for (const std::string& line : lines_of(detections({}))) {
    if (Json::parse(line)["frame"] >= 20) last += line + "\n";
  }
  const std::string arguments = folder_.add("last.jsonl", last) + truth_ + " --gallery " + folder_ / "gallery";
  const CommandResult result = run_command("evaluate " + arguments);
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  // All are equally near: the first one that is settled, six frames after the first mask.
  const cv::Mat picture = read_picture(folder_ / "gallery/miss_01.png");
  EXPECT_EQ(picture.at<cv::Vec3b>(60, 10), cv::Vec3b::all(90 + 26));
}

TEST_F(Evaluate, ExplainsAFalseAlarmWithoutAGround) {
  std::string text;
  for (const std::string& line : lines_of(detections({obstacle({10, 10, 30, 30}, 2.0)}))) {
    Json json = Json::parse(line);
    json["ground"] = {{"state", "not_visible"}, {"reason", "dark"}, {"confidence", 0.0}};
    text += json.dump() + "\n";
  }
  const std::string arguments = folder_.add("blind.jsonl", text) + truth_ + " --gallery " + folder_ / "gallery";
  const CommandResult result = run_command("evaluate " + arguments);
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(read_file(folder_ / "gallery/causes.md").find("below_ground without a ground"), std::string::npos);
}

// Half of the picture's upper part, where the true surface is 15 m away: far above a ground 1.6 m below the camera.
TEST_F(Evaluate, DrawsAndExplainsFalseAlarms) {
  const std::string false_alarm = folder_.add("false.jsonl", detections({obstacle({10, 10, 30, 30}, 2.0)}));
  ASSERT_EQ(run_command("evaluate " + false_alarm + truth_ + " --gallery " + folder_ / "gallery").exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "gallery/false_alarm_01.png"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "gallery/false_alarm_02.png"));  // one episode
  EXPECT_NE(
      read_file(folder_ / "gallery/causes.md").find("| below_ground on something that stands on the ground | 30 | 100.0 | 1 |"),
      std::string::npos)
      << read_file(folder_ / "gallery/causes.md");
}

TEST_F(Evaluate, ScoresATrajectory) {
  std::string poses;
  for (int frame = 0; frame < kFrames; ++frame) poses += fmt::format("1 0 0 {} 0 1 0 0 0 0 1 0\n", 0.1 * (frame % 2));
  const CommandResult result = run_command("evaluate --poses " + folder_.add("path.txt", poses) + truth_ + " --json");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const Json json = Json::parse(result.output);
  EXPECT_NEAR(json["accumulated"]["translation_m"]["mean"].get<double>(), 0.05, 0.004);  // every second pose is 0.1 m off
  EXPECT_NEAR(json["frame_to_frame"]["translation_m"]["mean"].get<double>(), 0.1, 1e-9);
}

TEST_F(Evaluate, ScoresDisparities) {
  cv::Mat1f disparity(kSize, 2.5F);  // the truth is 1 px
  disparity.row(0).setTo(kInvalidDisparity);
  const std::string file = folder_.add("d.png", encode_disparity(disparity, DisparityFormat::png));
  const std::string truth = " --truth " + folder_ / "suite/walk/disparity/000000.png";
  const CommandResult result = run_command("evaluate --disparity " + file + truth + " --json");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const Json json = Json::parse(result.output);
  EXPECT_NEAR(json["density"].get<double>(), 119.0 / 120.0, 1e-9);
  EXPECT_EQ(json["valid"], Json({{"bad_1", 1.0}, {"bad_2", 0.0}, {"bad_3", 0.0}}));
  EXPECT_NEAR(json["invalid_is_bad"]["bad_2"].get<double>(), 1.0 / 120.0, 1e-9);
  cv::Mat1b mask(kSize, uchar{0});
  mask.rowRange(0, 2).setTo(255);
  const CommandResult masked =
      run_command("evaluate --disparity " + file + truth + " --json --mask " + folder_.add("m.png", encode_png(mask)));
  EXPECT_NEAR(Json::parse(masked.output)["density"].get<double>(), 0.5, 1e-9);
}

TEST_F(Evaluate, RefusesDetectionsOfAnotherSequence) {
  const std::string fewer = folder_.add("fewer.jsonl", detections({}, 12));
  expect_refusal("evaluate " + fewer + truth_, 1, "fewer.jsonl: has 12 frames, expected the 30 of ");
  std::string later = detections({}, kFrames + 1);
  later.erase(0, later.find('\n') + 1);
  expect_refusal("evaluate " + folder_.add("later.jsonl", later) + truth_, 1, "later.jsonl: frame 0 = 1, expected 0 as in ");
  const std::string larger = folder_.add("larger.jsonl", detections({obstacle({150, 10, 40, 20}, 2.0)}));
  expect_refusal("evaluate " + larger + truth_, 1, "larger.jsonl: ");
}

TEST_F(Evaluate, RefusesDamagedDetections) {
  const std::string good = detections({obstacle(kHole, 3.0)});
  expect_refusal("evaluate " + folder_.add("cut.jsonl", good.substr(0, good.size() - 50)) + truth_, 1, "cut.jsonl: line 30");
  expect_refusal("evaluate " + folder_.add("empty.jsonl", "") + truth_, 1, "empty.jsonl: is empty");
  std::string nan = good;
  nan.replace(nan.find("\"distance_m\":3.0"), 16, "\"distance_m\":NaN");
  expect_refusal("evaluate " + folder_.add("nan.jsonl", nan) + truth_, 1, "nan.jsonl: line 1");
  expect_refusal("evaluate " + folder_ / "none.jsonl" + truth_, 1, "none.jsonl: no such file");
}

TEST_F(Evaluate, RefusesTruthWithoutMasks) {
  std::filesystem::remove_all(folder_ / "suite/walk/negative");
  expect_refusal("evaluate " + found_ + truth_, 1, "suite/walk/negative");
  expect_refusal("evaluate --suite " + folder_ / "suite" + " --results " + folder_ / "results", 1,
                 "holds no sequences with truth");
  expect_refusal("evaluate " + found_ + " --truth " + folder_ / "none", 1, "none");
}

TEST_F(Evaluate, RefusesWhatDoesNotGoTogether) {
  expect_refusal("evaluate", 2, "expected one --truth SEQUENCE for each");
  expect_refusal("evaluate " + found_, 2, "1 files of detections and 0 times --truth");
  expect_refusal("evaluate --suite " + folder_ / "suite", 2, "--suite DIR goes with --results DIR");
  expect_refusal("evaluate " + found_ + truth_ + " --run", 2, "--run goes with --suite");
  expect_refusal("evaluate " + found_ + truth_ + " --block 0", 2, "evaluation.block_frames = 0");
  expect_refusal("evaluate --poses " + found_, 2, "--poses and --disparity go with one --truth");
  expect_refusal("evaluate --poses " + found_ + truth_, 1, "walk.jsonl: line 1");
}

TEST_F(Evaluate, ComparesTwoRuns) {
  const std::string a = folder_ / "a.json";
  const std::string b = folder_ / "b.json";
  const std::string options = truth_ + " --json --out ";
  ASSERT_EQ(run_command("evaluate " + found_ + options + a).exit_code, 0);
  ASSERT_EQ(run_command("evaluate " + nothing_ + options + b).exit_code, 0);
  EXPECT_EQ(run_command("compare " + a + " " + a).exit_code, 0);
  EXPECT_EQ(run_command("compare " + b + " " + a).exit_code, 0);  // better is fine
  const CommandResult worse = run_command("compare " + a + " " + b);
  EXPECT_EQ(worse.exit_code, 1);
  EXPECT_NE(worse.output.find("| settled TPR | 1.0000 | 0.0000 | -1.0000 [-1.0000, -1.0000] | worse |"), std::string::npos)
      << worse.output;
  EXPECT_NE(worse.errors.find("is worse than"), std::string::npos);
  EXPECT_TRUE(Json::parse(run_command("compare --json " + a + " " + a).output).is_array());
  expect_refusal("compare " + a + " " + found_, 1, "walk.jsonl");
  expect_refusal("compare " + a, 2, "B is required");
}

}  // namespace
}  // namespace brink::test
