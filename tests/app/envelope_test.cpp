#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/command.hpp"

namespace brink::test {
namespace {

using Json = nlohmann::json;

constexpr const char* kCalibration =
    "P0: 350 0 159.5 0 0 350 89.5 0 0 0 1 0\n"
    "P1: 350 0 159.5 -52.5 0 350 89.5 0 0 0 1 0\n";

class Envelope : public ::testing::Test {
 protected:
  // Runs with a calibration for 320x180 px and two distances, so that it is quick.
  [[nodiscard]] CommandResult run(const std::string& rest) const {
    return run_command("envelope --calib " + calib_ + " --distances 2 3 " + rest);
  }

  void expect_refusal(const std::string& arguments, int exit_code, const std::string& part) const {
    const CommandResult result = run_command("envelope " + arguments);
    EXPECT_EQ(result.exit_code, exit_code) << arguments;
    const std::vector<std::string> faults = faults_of(result);
    ASSERT_EQ(faults.size(), 1U) << result.errors;
    EXPECT_TRUE(faults[0].starts_with("brink: ")) << result.errors;
    EXPECT_NE(faults[0].find(part), std::string::npos) << result.errors;
    EXPECT_TRUE(result.output.empty());
  }

  TemporaryFolder folder_;
  std::string calib_ = folder_.add("calib.txt", kCalibration);
};

TEST_F(Envelope, TellsTheSmallestDropsAndTheLargestDistances) {
  const CommandResult result = run("--depths 0.05 0.2");
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.errors.find("taken for 320x180 px"), std::string::npos) << result.errors;
  const std::vector<std::string> lines = lines_of(result.output);
  ASSERT_EQ(lines.size(), 17U) << result.output;
  EXPECT_EQ(lines[0], "320x180 px, 1.60 m over the ground, looking down by 25.0 deg, noise of disparities 0.1 px");
  EXPECT_TRUE(lines[4].starts_with("| 2 m | 0.1"));
  EXPECT_TRUE(lines[9].starts_with("| 0.05 m | none | none |"));
  EXPECT_EQ(lines[15], "| 2 m | depth | seen | depth | seen |");
}

TEST_F(Envelope, IsTheSameForPrograms) {
  const CommandResult result = run("--json --size 320 200 --camera-height 1.5 --pitch 30 --noise 0.2 --threads 1");
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const Json json = Json::parse(result.output);
  EXPECT_EQ(json["height_px"], 200);
  EXPECT_EQ(json["height_m"], 1.5);
  EXPECT_EQ(json["pitch_deg"], 30.0);
  EXPECT_EQ(json["disparity_sd_px"], 0.2);
  ASSERT_EQ(json["drops"].size(), 2U);
  EXPECT_EQ(json["drops"][0]["name"], "hole 1 x 1 m");
  EXPECT_EQ(json["drops"][1]["name"], "edge");
  EXPECT_EQ(json["drops"][1]["smallest_depths"].size(), 2U);
  EXPECT_EQ(json["drops"][1]["largest_distances"][0]["distance_m"], nullptr);  // 5 cm
  EXPECT_EQ(json["drops"][1]["sightings"][2]["answer"], "seen");               // 30 cm at 2 m
  EXPECT_EQ(run("--json --size 320 200 --camera-height 1.5 --pitch 30 --noise 0.2 --threads 4").output, result.output);
}

TEST_F(Envelope, GoesByTheParametersOfTheMethod) {
  const CommandResult result = run("--json --depths 0.05 --set candidates.min_depth_m=0.05");
  EXPECT_TRUE(Json::parse(result.output)["drops"][1]["largest_distances"][0]["distance_m"].is_number()) << result.output;
}

TEST_F(Envelope, IsDrawn) {
  const std::string file = folder_ / "envelope.png";
  EXPECT_EQ(run("--picture " + file).exit_code, 0);
  const cv::Mat picture = read_picture(file);
  EXPECT_EQ(picture.size(), cv::Size(960, 560));
  EXPECT_EQ(picture.channels(), 3);
}

TEST_F(Envelope, RefusesBadInputInOneLine) {
  const std::string calib = "--calib " + calib_ + " ";
  expect_refusal("", 2, "--calib is required");
  expect_refusal("--calib " + folder_ / "none.txt", 1, "none.txt: no such file");
  expect_refusal("--calib " + folder_.add("prose.txt", "15 cm apart\n"), 1, "prose.txt: ");
  expect_refusal(calib + "--camera-height 0", 2, "height_m = 0, must be above 0 to 100");
  expect_refusal(calib + "--camera-height high", 2, "--camera-height");
  expect_refusal(calib + "--pitch 90", 2, "pitch_deg = 90, must be above -90 to below 90");
  expect_refusal(calib + "--noise 0", 2, "disparity_sd_px = 0, must be 0.001 to 100");
  expect_refusal(calib + "--length -1", 2, "length_m = -1, must be above 0 to 1000");
  expect_refusal(calib + "--distances 0", 2, "distance_m = 0, must be above 0 to 1000");
  expect_refusal(calib + "--depths nan", 2, "depth_m = nan, must be above 0 to 1000");
  expect_refusal(calib + "--size 640", 2, "--size");
  expect_refusal(calib + "--size 8 8", 2, "width = 8, must be 32 to");
  expect_refusal(calib + "--picture " + folder_ / "none/envelope.png", 1, "none/envelope.png: cannot be written");
}

}  // namespace
}  // namespace brink::test
