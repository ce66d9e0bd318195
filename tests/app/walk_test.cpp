#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/command.hpp"

namespace brink::test {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

constexpr int kFrames = 12;

/// A short simulated walk past a manhole, made once for all tests.
class Walk : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    const CommandResult result =
        run_command(fmt::format("simulate manholes --frames {} --width 320 --height 180 --out {}", kFrames, *folder_ / "walk"));
    ASSERT_EQ(result.exit_code, 0) << result.errors;
  }
  static void TearDownTestSuite() { delete folder_; }

  // A copy of the walk that a test may spoil.
  static std::string copy_to(const TemporaryFolder& folder) {
    fs::copy(*folder_ / "walk", folder / "walk", fs::copy_options::recursive);
    return folder / "walk";
  }

  static TemporaryFolder* folder_;
};
TemporaryFolder* Walk::folder_ = nullptr;

TEST_F(Walk, IsTheSameForAnyNumberOfThreadsAndFromRunToRun) {
  const std::string detect = "detect " + *folder_ / "walk" + " --threads ";
  const CommandResult first = run_command(detect + "1");
  ASSERT_EQ(first.exit_code, 0) << first.errors;
  for (const char* threads : {"1", "2", "4"}) {
    EXPECT_EQ(detections_of(run_command(detect + threads).output), detections_of(first.output)) << threads;
  }
}

TEST_F(Walk, FollowsTheSameHoleWithTheSameId) {
  const std::vector<Json> frames = detections_of(run_command("detect " + *folder_ / "walk").output);
  ASSERT_EQ(frames.size(), static_cast<std::size_t>(kFrames));
  for (int i = 0; i < 2; ++i) EXPECT_TRUE(frames[static_cast<std::size_t>(i)]["obstacles"].empty()) << "two sightings are few";
  ASSERT_FALSE(frames[4]["obstacles"].empty());
  const Json& hole = frames[4]["obstacles"][0];
  EXPECT_EQ(hole["track_length"], 5);
  const Json& last = frames.back()["obstacles"][0];
  EXPECT_EQ(last["id"], hole["id"]);
  EXPECT_GE(last["track_length"], kFrames - 1);  // so small a picture may lose the hole for a frame
  for (std::size_t i = 1; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i]["ego_motion"]["state"], "ok") << frames[i]["ego_motion"];
    EXPECT_EQ(frames[i]["ego_motion"]["current_from_previous"].size(), 4U);
  }
}

TEST_F(Walk, GoesOnAfterAMissingFrame) {
  const TemporaryFolder folder;
  const std::string walk = copy_to(folder);
  fs::remove(walk + "/image_2/000004.png");
  const CommandResult result = run_command("detect " + walk);
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const std::vector<Json> frames = detections_of(result.output);
  ASSERT_EQ(frames.size(), static_cast<std::size_t>(kFrames));
  EXPECT_EQ(frames[4]["status"], "no_picture");
  EXPECT_EQ(frames[4]["ground"]["state"], "not_visible");
  EXPECT_TRUE(frames[4]["obstacles"].empty());
  EXPECT_FALSE(frames[5]["obstacles"].empty()) << "validated before, and followed over one frame";
  EXPECT_FALSE(frames[11]["obstacles"].empty());
  EXPECT_NE(result.errors.find("image_2/000004.png"), std::string::npos) << result.errors;
}

TEST_F(Walk, ByThePapersRulesWhatAMissingFrameDidNotShowIsValidatedAnew) {
  const TemporaryFolder folder;
  const std::string walk = copy_to(folder);
  fs::remove(walk + "/image_2/000005.png");
  const CommandResult result = run_command("detect --method paper " + walk);
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const std::vector<Json> frames = detections_of(result.output);
  EXPECT_FALSE(frames[4]["obstacles"].empty());
  EXPECT_TRUE(frames[6]["obstacles"].empty());
  for (const Json& track : frames[6]["tracks"]) EXPECT_EQ(track["track_length"], 1);
}

TEST_F(Walk, WorksWithOneFrame) {
  const TemporaryFolder folder;
  const std::string walk = copy_to(folder);
  for (int i = 1; i < kFrames; ++i) {
    fs::remove(fmt::format("{}/image_2/{:06}.png", walk, i));
    fs::remove(fmt::format("{}/image_3/{:06}.png", walk, i));
  }
  const CommandResult result = run_command("detect " + walk);
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const std::vector<Json> frames = detections_of(result.output);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_TRUE(frames[0]["obstacles"].empty());
  EXPECT_FALSE(frames[0]["tracks"].empty());
}

TEST_F(Walk, TakesPosesFromElsewhere) {
  const CommandResult result = run_command("detect " + *folder_ / "walk" + " --poses " + *folder_ / "walk/poses.txt");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const std::vector<Json> frames = detections_of(result.output);
  EXPECT_EQ(frames[5]["ego_motion"]["state"], "given");
  EXPECT_FALSE(frames[5]["obstacles"].empty());
  const TemporaryFolder folder;
  const std::string few = folder.add("few.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  const CommandResult refused = run_command("detect " + *folder_ / "walk" + " --poses " + few + " --out " + folder / "o");
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_NE(refused.errors.find("few.txt: has 1 poses, expected one for each of 12 frames"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder / "o"));
}

// The frames are followed by many copies of the last one, so that there is something left to interrupt.
TEST_F(Walk, EndsCleanlyWithWhatIsDoneWhenInterrupted) {
  const TemporaryFolder folder;
  const std::string walk = copy_to(folder);
  fs::remove(walk + "/times.txt");
  for (int i = kFrames; i < 400; ++i) {
    for (const char* eye : {"image_2", "image_3"}) {
      fs::create_hard_link(fmt::format("{}/{}/{:06}.png", walk, eye, kFrames - 1),
                           fmt::format("{}/{}/{:06}.png", walk, eye, i));
    }
  }
  const std::string out = folder / "lines";
  const std::string wait = " > " + out + " & while [ ! -s " + out + " ]; do sleep 0.01; done; kill -INT $!; wait $!";
  const std::string line = fmt::format("{} detect {} 2> {}{}", BRINK_COMMAND, walk, folder / "errors", wait);
  const int status = std::system(line.c_str());  // NOLINT(bugprone-command-processor): that is what is tested
  EXPECT_EQ(WEXITSTATUS(status), 130);
  const std::vector<Json> frames = detections_of(read_file(out));
  EXPECT_GE(frames.size(), 1U);
  EXPECT_LT(frames.size(), 400U);
  EXPECT_NE(read_file(folder / "errors").find(fmt::format("interrupted after {} of 400 frames", frames.size())),
            std::string::npos)
      << read_file(folder / "errors");
}

TEST_F(Walk, GivesItsPathInBothFormats) {
  const TemporaryFolder folder;
  for (const std::string format : {"kitti", "tum"}) {
    const std::string path = folder / format;
    const CommandResult result = run_command("odometry " + *folder_ / "walk" + " --format " + format + " --out " + path);
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    const CommandResult errors = run_command("evaluate --json --segment 0.5 --poses " + path + " --truth " + *folder_ / "walk");
    ASSERT_EQ(errors.exit_code, 0) << errors.errors;
    EXPECT_LT(Json::parse(errors.output)["accumulated"]["translation_m"]["mean"].get<double>(), 0.02);
  }
}

}  // namespace
}  // namespace brink::test
