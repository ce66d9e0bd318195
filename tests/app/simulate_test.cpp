#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <yaml-cpp/yaml.h>

#include "app/command.hpp"
#include "brink/sequence.hpp"

namespace brink::test {
namespace {

using Names = std::set<std::string>;

constexpr const char* kSmall = " --width 96 --height 64";

// The bytes of every file below a folder.
std::map<std::string, std::string> contents(const std::string& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    files[std::filesystem::relative(entry.path(), folder).string()] = read_file(entry.path().string());
  }
  return files;
}

// Says which file differs, not its bytes.
void expect_same(const std::string& folder, const std::string& expected) {
  const auto found = contents(folder);
  const auto wanted = contents(expected);
  ASSERT_EQ(found.size(), wanted.size());
  for (const auto& [name, bytes] : wanted) {
    ASSERT_TRUE(found.contains(name)) << name;
    EXPECT_TRUE(found.at(name) == bytes) << name;
  }
}

std::vector<double> numbers_of(const std::string& line) {
  std::istringstream stream(line);
  std::vector<double> numbers;
  double number = 0.0;
  while (stream >> number) numbers.push_back(number);
  return numbers;
}

void expect_refusal(const std::string& arguments, int exit_code, const std::string& part, const std::string& before = "") {
  const CommandResult result = run_command("simulate " + arguments, before);
  EXPECT_EQ(result.exit_code, exit_code) << arguments << "\n" << result.errors;
  EXPECT_EQ(lines_of(result.errors).size(), 1U) << result.errors;
  EXPECT_TRUE(result.errors.starts_with("brink: ")) << result.errors;
  EXPECT_NE(result.errors.find(part), std::string::npos) << result.errors;
}

TEST(Simulate, WritesASequenceWithAllItsTruth) {
  const TemporaryFolder folder;
  const CommandResult result = run_command("simulate manholes --frames 3 --fps 10" + (kSmall + (" --out " + folder / "walk")));
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(lines_of(result.errors).size(), 1U) << result.errors;
  Names expected{"walk"};
  for (const char* name : {"calib.txt", "times.txt", "poses.txt", "imu.csv", "instances.yaml", "simulation.yaml"}) {
    expected.insert(std::string("walk/") + name);
  }
  for (const std::string part : {"image_2", "image_3", "disparity", "negative"}) {
    expected.insert("walk/" + part);
    for (int frame = 0; frame < 3; ++frame) expected.insert(fmt::format("walk/{}/{:06}.png", part, frame));
  }
  EXPECT_EQ(folder.list(), expected);

  const Sequence sequence = open_sequence(folder / "walk");
  EXPECT_DOUBLE_EQ(sequence.camera().focal, 52.5);
  EXPECT_DOUBLE_EQ(sequence.camera().cx, 47.5);
  EXPECT_DOUBLE_EQ(sequence.camera().cy, 31.5);
  EXPECT_DOUBLE_EQ(sequence.camera().baseline, 0.15);
  ASSERT_EQ(sequence.size(), 3);
  const FrameReading reading = sequence.read(2);
  EXPECT_EQ(reading.status, FrameStatus::ok) << reading.reason;
  EXPECT_EQ(reading.frame.left.size(), cv::Size(96, 64));
  EXPECT_NEAR(reading.frame.time, 0.2, 1e-6);

  EXPECT_EQ(cv::imread(folder / "walk/disparity/000000.png", cv::IMREAD_UNCHANGED).type(), CV_16UC1);
  EXPECT_EQ(cv::imread(folder / "walk/negative/000000.png", cv::IMREAD_UNCHANGED).type(), CV_8UC1);
}

TEST(Simulate, ThePosesStartAtTheFirstLeftCameraAndTheImuCoversThem) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_command("simulate motion --frames 16 --fps 15" + (kSmall + (" --out " + folder / "walk"))).exit_code, 0);
  const auto poses = lines_of(read_file(folder / "walk/poses.txt"));
  ASSERT_EQ(poses.size(), 16U);
  EXPECT_EQ(numbers_of(poses[0]), (std::vector<double>{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}));
  const std::vector<double> last = numbers_of(poses[15]);
  ASSERT_EQ(last.size(), 12U);
  const double walked = std::hypot(last[3], last[7], last[11]);
  EXPECT_GT(walked, 0.5);  // in one second
  EXPECT_LT(walked, 1.5);
  EXPECT_GT(last[11], 0.5) << "forwards is z";
  const auto imu = lines_of(read_file(folder / "walk/imu.csv"));
  ASSERT_EQ(imu.size(), 202U);
  EXPECT_EQ(imu[0], "t,gx,gy,gz,ax,ay,az");
  EXPECT_TRUE(imu[201].starts_with("1.000000,"));
}

TEST(Simulate, MisRectificationMovesTheRightPictureOnly) {
  const TemporaryFolder folder;
  const std::string walk = std::string("simulate motion --frames 1") + kSmall + " --out ";
  ASSERT_EQ(run_command(walk + folder / "good").exit_code, 0);
  const auto good = contents(folder / "good");
  for (const std::string option : {"--rotation 2", "--vertical-offset 3"}) {
    ASSERT_EQ(run_command(walk + folder / "bad" + " --force " + option).exit_code, 0) << option;
    const auto bad = contents(folder / "bad");
    EXPECT_TRUE(bad.at("image_2/000000.png") == good.at("image_2/000000.png")) << option;
    EXPECT_TRUE(bad.at("disparity/000000.png") == good.at("disparity/000000.png")) << option;
    EXPECT_FALSE(bad.at("image_3/000000.png") == good.at("image_3/000000.png")) << option;
  }
}

TEST(Simulate, NamesEveryObstacleThatIsMarkedInThePictures) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_command("simulate stairs --frames 20 --fps 2" + (kSmall + (" --out " + folder / "walk"))).exit_code, 0);
  std::set<int> named;
  for (const YAML::Node& instance : YAML::LoadFile(folder / "walk/instances.yaml")) {
    EXPECT_TRUE(named.insert(instance["id"].as<int>()).second);
    EXPECT_EQ(instance["type"].as<std::string>(), "stairs_down");
    EXPECT_GT(instance["depth_m"].as<double>(), 0.5);
    EXPECT_GE(instance["opening"].size(), 3U);
    for (const YAML::Node& point : instance["opening"]) EXPECT_EQ(point.size(), 3U);
  }
  EXPECT_GE(named.size(), 1U);
  int marked = 0;
  for (int frame = 0; frame < 20; ++frame) {
    const cv::Mat1b mask = cv::imread(folder / fmt::format("walk/negative/{:06}.png", frame), cv::IMREAD_UNCHANGED);
    for (const uchar id : mask) {
      if (id == 0) continue;
      ++marked;
      ASSERT_TRUE(named.contains(id)) << int{id};
    }
  }
  EXPECT_GT(marked, 100);
}

TEST(Simulate, WritesTheSameBytesForTheSameSeedAndAnyNumberOfThreads) {
  const TemporaryFolder folder;
  const std::string command = std::string("simulate street --seed 5 --frames 3 --blur") + kSmall;
  for (const char* threads : {"1", "2"}) {
    ASSERT_EQ(run_command(command + " --threads " + threads + " --out " + folder / threads).exit_code, 0);
  }
  expect_same(folder / "2", folder / "1");
  ASSERT_EQ(run_command("simulate street --seed 6 --frames 3 --blur" + (kSmall + (" --out " + folder / "other"))).exit_code, 0);
  EXPECT_NE(contents(folder / "other")["image_2/000000.png"], contents(folder / "1")["image_2/000000.png"]);
}

TEST(Simulate, StoresJpegWhenAsked) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_command("simulate control --frames 1 --jpeg 90" + (kSmall + (" --out " + folder / "walk"))).exit_code, 0);
  EXPECT_TRUE(folder.list().contains("walk/image_2/000000.jpg"));
  EXPECT_TRUE(folder.list().contains("walk/disparity/000000.png"));
  EXPECT_EQ(open_sequence(folder / "walk").read(0).status, FrameStatus::ok);
}

TEST(Simulate, LeavesOutThePicturesOfDroppedFrames) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_command("simulate control --frames 12 --dropped 0.5" + (kSmall + (" --out " + folder / "walk"))).exit_code, 0);
  int dropped = 0;
  for (int frame = 0; frame < 12; ++frame) {
    const bool left = folder.list().contains(fmt::format("walk/image_2/{:06}.png", frame));
    EXPECT_EQ(folder.list().contains(fmt::format("walk/image_3/{:06}.png", frame)), left);
    EXPECT_TRUE(folder.list().contains(fmt::format("walk/disparity/{:06}.png", frame)));
    if (!left) ++dropped;
  }
  EXPECT_TRUE(folder.list().contains("walk/image_2/000000.png"));
  EXPECT_GT(dropped, 1);
  EXPECT_LT(dropped, 11);
  EXPECT_EQ(lines_of(read_file(folder / "walk/poses.txt")).size(), 12U);
  EXPECT_EQ(lines_of(read_file(folder / "walk/times.txt")).size(), 12U);
}

TEST(Simulate, AKilledRunLeavesNoHalfSequenceAndIsResumedToTheSameBytes) {
  const TemporaryFolder folder;
  const std::string arguments = std::string("simulate control --frames 6") + kSmall;
  const std::string walk = folder / "walk";
  ASSERT_EQ(run_command(arguments + " --out " + folder / "whole").exit_code, 0);
  const std::string kill = fmt::format(
      "{0} {1} --out {2} 2> {3} & while [ ! -e {2}.part/negative/000001.png ]; do sleep 0.01; done; kill -9 $!; wait 2> {3}; ",
      BRINK_COMMAND, arguments, walk, folder / "errors");
  const std::string look = fmt::format("test -e {0} && touch {1}; ", walk, folder / "too_early");
  const CommandResult resumed = run_command(arguments + " --resume --out " + walk, kill + look);
  ASSERT_EQ(resumed.exit_code, 0) << resumed.errors;
  EXPECT_FALSE(folder.list().contains("too_early"));
  EXPECT_FALSE(folder.list().contains("walk.part"));
  expect_same(walk, folder / "whole");

  const CommandResult again = run_command(arguments + " --resume --out " + walk);
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_EQ(again.errors, "brink: " + walk + ": is complete already\n");
}

TEST(Simulate, ResumesOnlyWhatWasBegunWithTheSameParameters) {
  const TemporaryFolder folder;
  const std::string out = kSmall + (" --out " + folder / "walk");
  ASSERT_EQ(run_command("simulate control --frames 2" + out).exit_code, 0);
  expect_refusal("control --frames 3 --resume" + out, 1,
                 R"(walk: cannot be resumed, it was made with "frames: 2", not "frames: 3")");
  std::filesystem::rename(folder / "walk", folder / "walk.part");
  expect_refusal("control --frames 2 --seed 2 --resume" + out, 1, "walk.part: cannot be resumed, it was made with \"seed: 1\"");
  expect_refusal("control --frames 2" + out, 1, "walk.part: is left of an interrupted run; --resume goes on");
  EXPECT_EQ(run_command("simulate control --frames 3 --force" + out).exit_code, 0);
  EXPECT_EQ(lines_of(read_file(folder / "walk/times.txt")).size(), 3U);
}

TEST(Simulate, ReplacesOnlySimulatedSequencesAndOnlyWithForce) {
  const TemporaryFolder folder;
  const std::string arguments = std::string("control --frames 1") + kSmall;
  const std::string out = " --out " + folder / "walk/";
  ASSERT_EQ(run_command("simulate " + arguments + out).exit_code, 0);
  expect_refusal(arguments + out, 1, "walk: is there already; --force replaces it");
  EXPECT_EQ(run_command("simulate --seed 3 --force " + arguments + out).exit_code, 0);
  EXPECT_NE(read_file(folder / "walk/simulation.yaml").find("seed: 3\n"), std::string::npos);
  (void)folder.add("mine/diary.txt", "dear diary");
  expect_refusal(arguments + " --force --out " + folder / "mine", 1, "mine: is no simulated sequence");
  EXPECT_EQ(read_file(folder / "mine/diary.txt"), "dear diary");
  EXPECT_EQ(folder.list().count("mine.part"), 0U);
}

TEST(Simulate, TellsInOneLineWhatIsWrong) {
  const TemporaryFolder folder;
  const std::string out = " --out " + folder / "walk";
  expect_refusal("maze" + out, 2, "family = maze, must be ");
  expect_refusal("control", 2, "no --out DIR given");
  expect_refusal("" + out, 2, "no FAMILY given");
  expect_refusal("control --frames 0" + out, 2, "frames = 0, must be 1 to 100000");
  expect_refusal("control --frames -5" + out, 2, "frames = -5");
  expect_refusal("control --width 1" + out, 2, "width = 1, must be 32 to 4096");
  expect_refusal("control --height 1000000" + out, 2, "height = 1000000, must be 32 to 4096");
  expect_refusal("control --width 1e9" + out, 2, "--width");
  expect_refusal("control --fps 0" + out, 2, "fps = 0");
  expect_refusal("control --fps nan" + out, 2, "fps = nan");
  expect_refusal("control --frames 90000" + out, 2, "frames / fps = 6000, must be at most 3600 s");
  expect_refusal("control --baseline 15" + out, 2, "baseline_m = 15");
  expect_refusal("control --focal 0" + out, 2, "focal_px = 0");
  expect_refusal("control --light moon" + out, 2, "light = moon, must be sunny, overcast or dusk");
  expect_refusal("control --noise -1" + out, 2, "noise = -1");
  expect_refusal("control --dropped 1" + out, 2, "dropped = 1");
  expect_refusal("control --jpeg 101" + out, 2, "--jpeg");
  expect_refusal("control --force --resume" + out, 2, "--force");
  EXPECT_TRUE(folder.list().empty());
}

TEST(Simulate, TellsInOneLineWhereNothingCanBeWritten) {
  const TemporaryFolder folder;
  const std::string arguments = std::string("control --frames 1") + kSmall;
  expect_refusal(arguments + " --out " + folder.add("file", "x") + "/walk", 1, "cannot be written: Not a directory");
  expect_refusal(arguments + " --out /dev/full", 1, "/dev/full: is there already");
  const std::string full = "control --frames 1 --width 320 --height 180 --out " + folder / "walk";
  for (const char* resume : {"", " --resume"}) {
    expect_refusal(full + resume, 1, "000000.png: cannot be written: File too large", "ulimit -f 16; ");
    EXPECT_FALSE(folder.list().contains("walk"));
  }
  EXPECT_EQ(run_command("simulate --resume " + full).exit_code, 0) << "with room again the run goes on";
}

TEST(Simulate, ListsTheFamiliesWithTheirMeaning) {
  const CommandResult result = run_command("simulate --list");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const auto lines = lines_of(result.output);
  ASSERT_EQ(lines.size(), 7U);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::array<const char*, 7> names{"stairs", "platform", "manholes", "street", "control", "motion", "crowd"};
    EXPECT_TRUE(lines[i].starts_with(std::string(names.at(i)) + ": ")) << lines[i];
    EXPECT_GT(lines[i].size(), 25U) << lines[i];
  }
}

TEST(Simulate, DetectReadsWhatItWrites) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_command("simulate control --frames 2 --width 320 --height 180 --out " + folder / "walk").exit_code, 0);
  const CommandResult result = run_command("detect --stills " + folder / "walk");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const auto detections = detections_of(result.output);
  ASSERT_EQ(detections.size(), 2U);
  for (const auto& detection : detections) EXPECT_EQ(detection["ground"]["state"], "seen") << detection.dump();
}

}  // namespace
}  // namespace brink::test
