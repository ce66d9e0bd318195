// --as: disparity or depth images in place of right pictures, as a user gives them.
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "app/command.hpp"

namespace brink::test {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

/// Flat ground with a hole 0.5 m deep, 2.2 m ahead, with exact disparities.
cv::Mat1f hole_disparity() {
  const StereoCamera camera = half_size_camera();
  return make_disparity(camera, half_size(), make_ground_plane(1.5, 30.0, 0.0, camera), {{2.2, 3.4, -0.6, 0.6, 0.5}});
}

std::string encode_disparities() { return encode_disparity(hole_disparity(), DisparityFormat::png); }

std::string encode_depths() {
  const StereoCamera camera = half_size_camera();
  cv::Mat1w depth(half_size());
  const cv::Mat1f disparity = hole_disparity();
  for (int i = 0; i < static_cast<int>(disparity.total()); ++i) {
    const float d = disparity(i / disparity.cols, i % disparity.cols);
    const double millimetres = d > 0.0F ? 1000.0 * camera.focal * camera.baseline / d : 0.0;
    depth(i / depth.cols, i % depth.cols) = cv::saturate_cast<ushort>(millimetres);
  }
  return encode_png(depth);
}

/// Two frames, with left pictures or without.
std::string add_walk(const TemporaryFolder& folder, bool with_pictures) {
  const Pair pair = make_ground_pair(true);
  (void)folder.add("walk/calib.txt", half_size_calibration());
  for (int i = 0; i < 2; ++i) {
    if (with_pictures) (void)folder.add(fmt::format("walk/image_0/{}.png", i), encode_png(pair.left));
    (void)folder.add(fmt::format("walk/disparity/{}.png", i), encode_disparities());
    (void)folder.add(fmt::format("walk/depth/{}.png", i), encode_depths());
  }
  return folder / "walk";
}

void expect_hole(const Json& obstacle) {
  EXPECT_EQ(obstacle["type"], "below_ground");
  EXPECT_NEAR(obstacle["distance_m"].get<double>(), 2.2, 0.05);
  EXPECT_NEAR(obstacle["depth_m"].get<double>(), 0.5, 0.05);
}

TEST(DepthInput, OfOnePictureGivesTheSameHoleAsDisparityAndAsDepth) {
  const TemporaryFolder folder;
  const std::string left = folder.add("left.png", encode_png(make_ground_pair(true).left));
  const std::string calibration = " --calib " + folder.add("calib.txt", half_size_calibration());
  const std::string disparity = folder.add("d.png", encode_disparities());
  const std::string depth = folder.add("z.png", encode_depths());
  for (const std::string& arguments :
       {left + " --right " + disparity + " --as disparity", left + " --right " + depth + " --as depth",
        disparity + " --as disparity", depth + " --as depth"}) {
    SCOPED_TRACE(arguments);
    const CommandResult result = run_command("detect " + arguments + calibration);
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    const Json frame = detections_of(result.output).at(0);
    ASSERT_EQ(frame["obstacles"].size(), 1U);
    expect_hole(frame["obstacles"][0]);
    const bool alone = arguments.find("--right") == std::string::npos;
    EXPECT_EQ(frame.contains("no_disparity_off"), alone);
    EXPECT_EQ(result.errors.find("Type 2) are off") != std::string::npos, alone) << result.errors;
  }
}

TEST(DepthInput, OfAFolderIsFollowedOverItsFrames) {
  for (const bool with_pictures : {true, false}) {
    for (const std::string kind : {"disparity", "depth"}) {
      SCOPED_TRACE(kind + (with_pictures ? " with pictures" : ""));
      const TemporaryFolder folder;
      const CommandResult result = run_command("detect " + add_walk(folder, with_pictures) + " --fps 15 --as " + kind);
      ASSERT_EQ(result.exit_code, 0) << result.errors;
      const std::vector<Json> frames = detections_of(result.output);
      ASSERT_EQ(frames.size(), 2U);
      EXPECT_EQ(frames[1]["ego_motion"]["state"], with_pictures ? "ok" : "ground");
      ASSERT_EQ(frames[1]["tracks"].size(), 1U);
      EXPECT_EQ(frames[1]["tracks"][0]["track_length"], 2);
      expect_hole(frames[1]["tracks"][0]);
    }
  }
}

TEST(DepthInput, TakesPatternsOfPicturesAndOfImages) {
  const TemporaryFolder folder;
  const std::string walk = add_walk(folder, true);
  const std::string rest = " --as depth --fps 15 --calib " + walk + "/calib.txt";
  for (const bool alone : {false, true}) {
    SCOPED_TRACE(alone);
    const std::string input =
        alone ? "'" + walk + "/depth/*.png'" : "'" + walk + "/image_0/*.png' --right '" + walk + "/depth/*.png'";
    const CommandResult result = run_command("detect " + input + rest);
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    const std::vector<Json> frames = detections_of(result.output);
    ASSERT_EQ(frames.size(), 2U);
    EXPECT_EQ(frames[1]["ego_motion"]["state"], alone ? "ground" : "ok");
    ASSERT_EQ(frames[1]["tracks"].size(), 1U);
    expect_hole(frames[1]["tracks"][0]);
  }
  const CommandResult mixed = run_command("detect '" + walk + "/image_0/*.png' --right " + walk + "/depth/0.png" + rest);
  EXPECT_EQ(mixed.exit_code, 2);
  EXPECT_NE(mixed.errors.find("must be of one kind"), std::string::npos) << mixed.errors;
}

TEST(DepthInput, DrawsVideosAndPicturesWithoutALeftPicture) {
  const TemporaryFolder folder;
  const std::string walk = add_walk(folder, false);
  for (const std::string overlay : {"overlay", "overlay.avi"}) {
    const CommandResult result = run_command("detect " + walk + " --as depth --overlay " + folder / overlay);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_TRUE(fs::exists(folder / overlay));
  }
  EXPECT_EQ(cv::imread(folder / "overlay/000001_drops.png").size(), half_size());
}

TEST(DepthInput, IsMeasuredByOdometryAndBenchAsWell) {
  const TemporaryFolder folder;
  const std::string walk = add_walk(folder, true);
  const CommandResult path = run_command("odometry " + walk + " --fps 15 --as depth");
  EXPECT_EQ(path.exit_code, 0) << path.errors;
  EXPECT_EQ(lines_of(path.output).size(), 2U);
  const CommandResult bench = run_command("bench " + walk + " --fps 15 --as depth --repeat 1");
  EXPECT_EQ(bench.exit_code, 0) << bench.errors;
  fs::remove_all(folder / "walk/image_0");
  const CommandResult blind = run_command("odometry " + walk + " --fps 15 --as depth");
  EXPECT_EQ(blind.exit_code, 1);
  EXPECT_NE(blind.errors.find("no left pictures: the path of the camera is measured in them"), std::string::npos);
}

struct Refusal {
  std::string arguments;
  int exit_code;
  std::string line;
};

TEST(DepthInput, IsNeverGuessed) {
  const TemporaryFolder folder;
  const std::string walk = add_walk(folder, false);
  const std::string left = folder.add("left.png", encode_png(make_ground_pair(true).left));
  const std::string calibration = " --calib " + folder.add("calib.txt", half_size_calibration());
  const std::string disparity = folder.add("d.png", encode_disparities());
  const std::string pfm = folder.add("d.pfm", encode_disparity(hole_disparity(), DisparityFormat::pfm));
  fs::remove_all(folder / "walk/depth");
  for (const Refusal& refusal :
       {Refusal{left + " --right " + disparity + calibration, 1, "d.png: is a 16-bit picture, expected 8-bit: disparities and"},
        Refusal{left + " --right " + pfm + calibration, 1, "d.pfm: is a TIFF, PFM or OpenEXR picture, expected PNG or JPEG"},
        Refusal{pfm + calibration, 2, "d.pfm holds disparities or depths: --as disparity or --as depth tells which"},
        Refusal{walk, 1, "no pictures, expected folders image_2"},
        Refusal{walk + " --as depth", 1, "no depth images, expected them in the folder depth"},
        Refusal{walk + " --as height", 2, "--as: height not in {disparity,depth}"},
        Refusal{walk + " --as disparity --right " + disparity, 2, "is a folder"},
        Refusal{walk + " --as disparity --side-by-side", 2, "--as goes with one left picture or none"},
        Refusal{disparity + " --as disparity", 2, "--calib is needed with it"},
        Refusal{disparity + " --as disparity --fps 15" + calibration, 2, "--fps and --times go with a sequence"},
        Refusal{left + " --as disparity" + calibration, 1, "left.png: is a 8-bit picture of 1 channels, expected 16-bit"}}) {
    SCOPED_TRACE(refusal.arguments);
    const CommandResult result = run_command("detect " + refusal.arguments);
    EXPECT_EQ(result.exit_code, refusal.exit_code);
    EXPECT_NE(result.errors.find(refusal.line), std::string::npos) << result.errors;
  }
}

TEST(DepthInput, OfASuiteIsNotMixedWithOtherResults) {
  const TemporaryFolder folder;
  (void)add_walk(folder, true);
  for (int i = 0; i < 2; ++i) {
    (void)folder.add(fmt::format("walk/negative/{:06}.png", i), encode_png(cv::Mat1b(half_size(), uchar{0})));
  }
  const std::string evaluate = "evaluate --suite " + folder / "" + " --results " + folder / "results" + " --run";
  const CommandResult first = run_command(evaluate + " --as disparity --gallery " + folder / "gallery");
  EXPECT_EQ(first.exit_code, 0) << first.errors;
  EXPECT_EQ(detections_of(read_file(folder / "results/walk.jsonl")).size(), 2U);
  const CommandResult other = run_command(evaluate + " --as depth");
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_NE(other.errors.find("other parameters made these results"), std::string::npos) << other.errors;
  const CommandResult alone =
      run_command("evaluate " + folder / "results/walk.jsonl" + " --truth " + folder / "walk" + " --as depth");
  EXPECT_EQ(alone.exit_code, 2);
  EXPECT_NE(alone.errors.find("--as goes with --suite"), std::string::npos) << alone.errors;
}

}  // namespace
}  // namespace brink::test
