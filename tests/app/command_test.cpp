#include "app/command.hpp"

#include <cmath>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "brink/overlay.hpp"
#include "brink/parameters.hpp"
#include "test_data.hpp"

namespace brink::test {
namespace {

using Json = nlohmann::json;
using Names = std::set<std::string>;

// A sequence of two frames: with a hole, and without.
void add_sequence(const TemporaryFolder& folder) {
  (void)folder.add("walk/calib.txt", half_size_calibration());
  (void)folder.add("walk/times.txt", "0\n0.0666\n");
  for (const int frame : {0, 1}) {
    const Pair pair = make_ground_pair(frame == 0);
    (void)folder.add("walk/image_0/00000" + std::to_string(frame) + ".png", encode_png(pair.left));
    (void)folder.add("walk/image_1/00000" + std::to_string(frame) + ".png", encode_png(pair.right));
  }
}

void expect_the_hole(const Json& detection) {
  EXPECT_EQ(detection["status"], "ok");
  EXPECT_EQ(detection["ground"]["state"], "seen");
  EXPECT_NEAR(detection["ground"]["height_m"].get<double>(), 1.5, 0.02);
  EXPECT_NEAR(detection["ground"]["pitch_deg"].get<double>(), 30.0, 0.5);
  ASSERT_EQ(detection["obstacles"].size(), 1U);
  const Json& obstacle = detection["obstacles"][0];
  EXPECT_EQ(obstacle["type"], "below_ground");
  EXPECT_EQ(obstacle["evidence"], "observed");
  EXPECT_EQ(obstacle["track_length"], 1);
  EXPECT_NEAR(obstacle["depth_m"].get<double>(), 0.5, 0.1);
  EXPECT_NEAR(obstacle["distance_m"].get<double>(), 2.2, 0.2);
  EXPECT_NEAR(obstacle["bearing_deg"].get<double>(), 0.0, 16.0);  // any point of the near rim, 1.2 m wide
}

TEST(Detect, ReportsTheHoleInOnePair) {
  const TemporaryFolder folder;
  const CommandResult result = run_command("detect " + add_pair(folder, make_ground_pair(true)));
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const std::vector<Json> detections = detections_of(result.output);
  ASSERT_EQ(detections.size(), 1U);
  expect_the_hole(detections[0]);
  const auto lines = lines_of(result.errors);
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_EQ(lines[0], "brink: " + folder / "left.png" +
                          ": one pair; calibration: KITTI, P0 and P1, 640x360 px, focal length 350.00 px, baseline 0.1500 m, "
                          "field of view 85 x 54 degrees, rectified already");
  EXPECT_EQ(lines[1], "brink: one pair: candidates are reported as obstacles at once, as with --stills");
  EXPECT_EQ(lines[2], "brink: 1 of 1 frames ok; ground seen in 1, uncertain in 0, not visible in 0; obstacles: 1");
}

TEST(Detect, ReportsNothingOnFlatGround) {
  const TemporaryFolder folder;
  const CommandResult result = run_command("detect " + add_pair(folder, make_ground_pair(false)));
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const Json detection = detections_of(result.output).at(0);
  EXPECT_EQ(detection["ground"]["state"], "seen");
  EXPECT_TRUE(detection["obstacles"].empty());
}

TEST(Detect, WritesDetectionsAndFourPicturesPerFrame) {
  const TemporaryFolder folder;
  add_sequence(folder);
  const Names before = folder.list();
  const CommandResult result = run_command("detect " + folder / "walk" + " --stills --out " + folder / "o.jsonl" +
                                           " --overlay " + folder / "deep/pictures");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(result.output, "");
  EXPECT_EQ(faults_of(result).size(), 1U) << result.errors;
  const std::vector<Json> detections = detections_of(read_file(folder / "o.jsonl"));
  ASSERT_EQ(detections.size(), 2U);
  expect_the_hole(detections[0]);
  EXPECT_EQ(detections[1]["frame"], 1);
  EXPECT_EQ(detections[1]["time"], 0.0666);
  EXPECT_TRUE(detections[1]["obstacles"].empty());
  Names expected = before;
  expected.insert({"o.jsonl", "deep", "deep/pictures"});
  for (const std::string frame : {"000000", "000001"}) {
    for (const std::string picture : {"ground", "disparity", "candidates", "drops"}) {
      const std::string name = fmt::format("deep/pictures/{}_{}.png", frame, picture);
      expected.insert(name);
      EXPECT_EQ(read_picture(folder / name).size(), half_size());
    }
  }
  EXPECT_EQ(folder.list(), expected);
}

TEST(Detect, WritesAVideoOfAllFramesWithTheFailedOnes) {
  const TemporaryFolder folder;
  add_sequence(folder);
  (void)folder.add("walk/image_0/000001.png", "no picture");
  const CommandResult result =
      run_command("detect " + folder / "walk" + " --stills --out " + folder / "o.jsonl" + " --overlay " + folder / "walk.mp4");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  cv::VideoCapture video(folder / "walk.mp4", cv::CAP_FFMPEG);
  int frames = 0;
  for (cv::Mat picture; video.read(picture); ++frames) EXPECT_EQ(picture.size(), cv::Size(kVideoWidth, kVideoHeight));
  EXPECT_EQ(frames, 2);
  EXPECT_NEAR(video.get(cv::CAP_PROP_FPS), 15.0, 0.1);
}

TEST(Detect, ValidatesNothingInTwoFrames) {
  const TemporaryFolder folder;
  add_sequence(folder);
  const CommandResult result = run_command("detect " + folder / "walk");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const Json detection = detections_of(result.output).at(0);
  EXPECT_TRUE(detection["obstacles"].empty());
  EXPECT_EQ(detection["tracks"].size(), 1U);
  EXPECT_EQ(detection["ego_motion"]["state"], "failed");
  EXPECT_EQ(detection["ego_motion"]["reason"], "first frame");
  EXPECT_EQ(faults_of(result).size(), 1U) << result.errors;
}

TEST(Detect, TellsABadFrameAndGoesOn) {
  const TemporaryFolder folder;
  add_sequence(folder);
  (void)folder.add("walk/image_1/000000.png", "no picture");
  const CommandResult result = run_command("detect --stills " + folder / "walk");
  EXPECT_EQ(result.exit_code, 0);
  const std::vector<Json> detections = detections_of(result.output);
  ASSERT_EQ(detections.size(), 2U);
  EXPECT_EQ(detections[0]["status"], "bad_frame");
  EXPECT_NE(detections[0]["reason"].get<std::string>().find("000000.png: is not a PNG or JPEG picture"), std::string::npos);
  EXPECT_EQ(detections[1]["status"], "ok");
  const auto lines = faults_of(result);
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0], "brink: " + detections[0]["reason"].get<std::string>());
  EXPECT_TRUE(lines[1].starts_with("brink: 1 of 2 frames ok;")) << lines[1];
}

TEST(Detect, TellsTheSameFromRunToRunAndForAnyNumberOfThreads) {
  const TemporaryFolder folder;
  add_sequence(folder);
  const std::string command = "detect --stills " + folder / "walk" + " --threads ";
  const std::vector<Json> first = detections_of(run_command(command + "1").output);
  ASSERT_EQ(first.size(), 2U);
  for (const char* threads : {"1", "2", "4"}) EXPECT_EQ(detections_of(run_command(command + threads).output), first) << threads;
}

TEST(Detect, TellsTheSameOfRealPicturesForAnyNumberOfThreads) {
  BRINK_REQUIRE_DATA(potholes, "pothole_b");
  const std::string command = "detect --stills --set candidates.min_depth_m=0.01 " + potholes + " --threads ";
  const std::vector<Json> first = detections_of(run_command(command + "1").output);
  ASSERT_EQ(first.size(), 3U);
  for (const char* threads : {"1", "2", "4"}) EXPECT_EQ(detections_of(run_command(command + threads).output), first) << threads;
}

TEST(Detect, LaterSourcesOfParametersWin) {
  const TemporaryFolder folder;
  const std::string params = " --params " + folder.add("p.yaml", "disparity: {matcher: bm}\nground: {seed: 5}\n");
  const auto value = [](const std::string& arguments, const std::string& key) {
    for (const std::string& line : lines_of(run_command("params " + arguments).output)) {
      if (line.starts_with(key + " = ")) return line.substr(key.size() + 3, line.find(':') - key.size() - 3);
    }
    return std::string("missing");
  };
  EXPECT_EQ(value("", "disparity.matcher"), "elas");
  EXPECT_EQ(value(params, "disparity.matcher"), "bm");
  EXPECT_EQ(value(params + " --matcher sgbm", "disparity.matcher"), "sgbm");
  EXPECT_EQ(value(params + " --matcher sgbm --set disparity.matcher=sgbm-wls", "disparity.matcher"), "sgbm-wls");
  EXPECT_EQ(value(params + " --set ground.seed=6 --set ground.seed=7", "ground.seed"), "7");
  EXPECT_EQ(value("--method paper", "elas.subpixel"), ElasParams::paper().subpixel ? "true" : "false");
}

TEST(Disparity, WritesPngAndPfmOfTheSameDisparities) {
  const TemporaryFolder folder;
  (void)add_pair(folder, make_ground_pair(false));
  for (const std::string name : {"d.png", "d.pfm"}) {
    const CommandResult result =
        run_command("disparity " + folder / "left.png" + " " + folder / "right.png" + " --out " + folder / name);
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_NE(result.errors.find(": 640x360 px, density "), std::string::npos) << result.errors;
  }
  const cv::Mat1w png = cv::imread(folder / "d.png", cv::IMREAD_UNCHANGED);
  const cv::Mat1f pfm = cv::imread(folder / "d.pfm", cv::IMREAD_UNCHANGED);
  ASSERT_EQ(png.size(), half_size());
  ASSERT_EQ(pfm.size(), half_size());
  for (int v = 0; v < png.rows; ++v) {
    for (int u = 0; u < png.cols; ++u) {
      ASSERT_EQ(png(v, u) == 0, std::isinf(pfm(v, u)));
      if (png(v, u) == 0) continue;
      ASSERT_NEAR(png(v, u) / 256.0, pfm(v, u), 0.002);
    }
  }
  const GroundPlane ground = make_ground_plane(1.5, 30.0, 0.0, half_size_camera());
  EXPECT_NEAR(pfm(250, 400), ground.disparity(400, 250), 0.3);
}

TEST(Disparity, RunsEveryMatcher) {
  const TemporaryFolder folder;
  (void)add_pair(folder, make_ground_pair(false));
  for (const std::string matcher : {"elas", "bm", "sgbm", "sgbm-wls"}) {
    const CommandResult result = run_command(fmt::format("disparity {} {} --out {} --matcher {}", folder / "left.png",
                                                         folder / "right.png", folder / "d.png", matcher));
    EXPECT_EQ(result.exit_code, 0) << matcher << ": " << result.errors;
  }
}

TEST(Params, ListsEveryParameterWithItsDefault) {
  const CommandResult result = run_command("params");
  ASSERT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.errors, "");
  for (const Parameter& parameter : list_parameters()) {
    EXPECT_NE(result.output.find(parameter.key + " = " + parameter.value), std::string::npos) << parameter.key;
    EXPECT_NE(result.output.find(": " + parameter.meaning + "\n"), std::string::npos) << parameter.key;
  }
}

TEST(Params, PrintsAFileThatIsReadBack) {
  const TemporaryFolder folder;
  const std::string yaml = run_command("params --yaml --set candidates.min_depth_m=0.0125").output;
  const std::string again = run_command("params --yaml --params " + folder.add("p.yaml", yaml)).output;
  EXPECT_EQ(again, yaml);
  EXPECT_NE(yaml.find("min_depth_m: 0.0125"), std::string::npos);
}

TEST(Bench, MeasuresEveryStage) {
  const TemporaryFolder folder;
  const std::string pair = add_pair(folder, make_ground_pair(true));
  const CommandResult result = run_command("bench " + pair + " --repeat 2 --json --threads 1");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const Json json = Json::parse(result.output);
  EXPECT_EQ(json["frames"], 1);
  EXPECT_EQ(json["threads"], 1);
  for (const char* stage : {"disparity", "ground", "below_ground", "no_disparity", "total"}) {
    const Json& times = json["times_ms"][stage];
    EXPECT_LE(times["median"], times["p95"]) << stage;
    EXPECT_LE(times["p95"], times["max"]) << stage;
  }
  EXPECT_GE(json["times_ms"]["total"]["median"], json["times_ms"]["disparity"]["median"]);
  EXPECT_GT(json["fps"], 0.0);
  EXPECT_GT(json["peak_memory_mb"], 1.0);
  EXPECT_LE(json["resident_mb"]["last"], json["peak_memory_mb"]);
  if (!json["allocations"].is_null()) {
    EXPECT_GT(json["allocations"]["calls"], 0.0);
    EXPECT_GT(json["allocations"]["mb"], 0.1);
    EXPECT_GT(json["allocated_mb"]["first"], 0.1);
    EXPECT_LT(json["allocated_mb"]["last"], json["resident_mb"]["last"]);
  }
  const std::string text = run_command("bench " + pair + " --repeat 1").output;
  EXPECT_NE(text.find("disparity: median "), std::string::npos);
  EXPECT_NE(text.find(" Y, p95 "), std::string::npos);
}

TEST(Bench, ResizesPicturesToTheSameShape) {
  const TemporaryFolder folder;
  const std::string pair = add_pair(folder, make_ground_pair(true));
  const Json whole = Json::parse(run_command("bench " + pair + " --repeat 1 --json").output);
  const int width = whole["width"].get<int>();
  const int height = whole["height"].get<int>();
  const std::string half = fmt::format("{}x{}", width / 2, height / 2);
  const Json json = Json::parse(run_command("bench " + pair + " --repeat 1 --json --size " + half).output);
  EXPECT_EQ(json["width"], width / 2);
  EXPECT_EQ(json["height"], height / 2);
  for (const std::string wrong : {"640", "640x", "axb", "640x360x2", "9x9", "640x640"}) {
    const CommandResult result = run_command(fmt::format("bench {} --repeat 1 --size {}", pair, wrong));
    EXPECT_EQ(result.exit_code, 2) << wrong;
    EXPECT_NE(result.errors.find("--size"), std::string::npos) << wrong;
    EXPECT_TRUE(result.output.empty()) << wrong;
  }
}

TEST(Help, IsThereForEveryCommandWithExamples) {
  EXPECT_EQ(run_command("--version").output, "brink 0.1.0\n");
  EXPECT_EQ(run_command("--help").exit_code, 0);
  for (const std::string command : {"detect", "disparity", "params", "bench"}) {
    const CommandResult result = run_command(command + " --help");
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_NE(result.output.find("Example"), std::string::npos) << command;
    EXPECT_NE(result.output.find("brink " + command), std::string::npos) << command;
    EXPECT_NE(run_command("--help").output.find("  " + command + ": "), std::string::npos);
  }
}

TEST(Help, SetsNothingInColumns) {
  for (const std::string command : {"", "detect", "disparity", "params", "bench"}) {
    for (const std::string& line : lines_of(run_command(command + " --help").output)) {
      const std::size_t text = line.find_first_not_of(' ');
      if (text == std::string::npos) continue;
      EXPECT_EQ(line.find("  ", text), std::string::npos) << line;
    }
  }
}

}  // namespace
}  // namespace brink::test
