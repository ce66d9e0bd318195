#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "app/command.hpp"
#include "ego_motion/synthetic_room.hpp"
#include "expect_error.hpp"

namespace brink::test {
namespace {

constexpr double kStep = 0.08;  // m ahead each frame

/// A straight walk of five frames. @param missing frame without pictures, -1 = none.
void add_walk(const TemporaryFolder& folder, int missing = -1) {
  const StereoCamera camera = room_camera();
  const std::string row = fmt::format("{} 0 {} 0 0 {} {} 0 0 0 1 0", camera.focal, camera.cx, camera.focal, camera.cy);
  const std::string right = fmt::format("{} 0 {} {} 0 {} {} 0 0 0 1 0", camera.focal, camera.cx,
                                        -camera.focal * camera.baseline, camera.focal, camera.cy);
  (void)folder.add("walk/calib.txt", "P0: " + row + "\nP1: " + right + "\n");
  (void)folder.add("walk/times.txt", "0\n0.1\n0.2\n0.3\n0.4\n");
  for (int i = 0; i < 5; ++i) {
    if (i == missing) continue;
    const Frame frame = render_room(make_pose(0, 0, kStep * i), i);
    (void)folder.add(fmt::format("walk/image_0/{:06}.png", i), encode_png(frame.left));
    (void)folder.add(fmt::format("walk/image_1/{:06}.png", i), encode_png(frame.right));
  }
}

std::vector<std::vector<double>> numbers_of(const std::string& text) {
  std::vector<std::vector<double>> rows;
  for (const std::string& line : lines_of(text)) {
    std::istringstream numbers(line);
    rows.emplace_back();
    for (double number = 0.0; numbers >> number;) rows.back().push_back(number);
  }
  return rows;
}

TEST(Odometry, WritesThePathAsKittiPoses) {
  const TemporaryFolder folder;
  add_walk(folder);
  const CommandResult result = run_command("odometry " + folder / "walk" + " --out " + folder / "poses.txt");
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const auto poses = numbers_of(read_file(folder / "poses.txt"));
  ASSERT_EQ(poses.size(), 5U);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    ASSERT_EQ(poses[i].size(), 12U);
    EXPECT_NEAR(poses[i][11], kStep * static_cast<double>(i), 0.004);
    EXPECT_NEAR(poses[i][0], 1.0, 1e-4);
  }
  EXPECT_EQ(faults_of(result), std::vector<std::string>{"brink: 5 frames, 0.32 m from start to end"});
}

TEST(Odometry, WritesThePathAsTumLines) {
  const TemporaryFolder folder;
  add_walk(folder);
  const CommandResult result = run_command("odometry " + folder / "walk" + " --format tum");
  const auto lines = numbers_of(result.output);
  ASSERT_EQ(lines.size(), 5U);
  ASSERT_EQ(lines[4].size(), 8U);
  EXPECT_EQ(lines[4][0], 0.4);
  EXPECT_NEAR(lines[4][3], 4 * kStep, 0.004);
  EXPECT_NEAR(lines[4][7], 1.0, 1e-4);
}

TEST(Odometry, SaysWhichFramesCannotBeReadAndBridgesThem) {
  const TemporaryFolder folder;
  add_walk(folder, 2);
  const CommandResult result = run_command("odometry " + folder / "walk" + " --out " + folder / "poses.txt");
  EXPECT_EQ(result.exit_code, 0);
  const auto poses = numbers_of(read_file(folder / "poses.txt"));
  ASSERT_EQ(poses.size(), 5U);
  EXPECT_EQ(poses[2], poses[1]);
  EXPECT_NE(result.errors.find("000002.png"), std::string::npos) << result.errors;
  EXPECT_NE(result.errors.find("1 frames could not be read"), std::string::npos) << result.errors;
  // Frame 3 is compared with frame 1, the last one that there was: nothing is lost in the end.
  EXPECT_NEAR(poses[4][11], 4 * kStep, 0.006);
}

TEST(Odometry, SaysWhichStepsHaveNoMotionAndStandsStillThere) {
  const TemporaryFolder folder;
  add_walk(folder, 2);
  const std::string black = encode_png(cv::Mat1b(room_size(), uchar{0}));
  (void)folder.add("walk/image_0/000002.png", black);
  (void)folder.add("walk/image_1/000002.png", black);
  const CommandResult result = run_command("odometry " + folder / "walk" + " --out " + folder / "poses.txt");
  EXPECT_EQ(result.exit_code, 0);
  const auto poses = numbers_of(read_file(folder / "poses.txt"));
  ASSERT_EQ(poses.size(), 5U);
  EXPECT_EQ(poses[2], poses[1]);
  EXPECT_EQ(poses[3], poses[1]) << "nothing to compare with";
  EXPECT_NEAR(poses[4][11], 2 * kStep, 0.006);
  EXPECT_NE(result.errors.find("frame 2: no motion: the left picture has no texture"), std::string::npos) << result.errors;
  EXPECT_NE(result.errors.find("2 steps without motion"), std::string::npos) << result.errors;
}

TEST(Odometry, LeavesNoFileWhenThereIsNoMotionAtAll) {
  const TemporaryFolder folder;
  (void)folder.add("walk/calib.txt", half_size_calibration());
  const std::string black = encode_png(cv::Mat1b(60, 80, uchar{0}));
  for (const char* name : {"walk/image_0/0.png", "walk/image_0/1.png", "walk/image_1/0.png", "walk/image_1/1.png"}) {
    (void)folder.add(name, black);
  }
  const CommandResult result = run_command("odometry " + folder / "walk" + " --out " + folder / "poses.txt");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.errors.find("no motion"), std::string::npos) << result.errors;
  EXPECT_FALSE(std::filesystem::exists(folder / "poses.txt"));
}

TEST(Odometry, RefusesAWrongFormatAndAMissingFolder) {
  const TemporaryFolder folder;
  EXPECT_EQ(run_command("odometry " + folder / "nowhere").exit_code, 1);
  EXPECT_EQ(run_command("odometry " + folder / "nowhere" + " --format euler").exit_code, 2);
  EXPECT_EQ(run_command("odometry").exit_code, 2);
}

}  // namespace
}  // namespace brink::test
