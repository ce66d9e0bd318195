#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "app/command.hpp"
#include "brink/sequence.hpp"
#include "test_data.hpp"

namespace brink::test {
namespace {

cv::Mat1b side_by_side(const Pair& pair) {
  cv::Mat1b both;
  cv::hconcat(pair.left, pair.right, both);
  return both;
}

void write_video(const std::string& path, const char* codec, const cv::Mat1b& picture, int frames) {
  cv::VideoWriter writer(path, cv::CAP_FFMPEG, cv::VideoWriter::fourcc(codec[0], codec[1], codec[2], codec[3]), 15.0,
                         picture.size());
  ASSERT_TRUE(writer.isOpened()) << path;
  cv::Mat3b color;
  cv::cvtColor(picture, color, cv::COLOR_GRAY2BGR);
  for (int number = 0; number < frames; ++number) writer.write(color);
}

/// What `brink detect --stills` finds in the only frame.
nlohmann::json obstacles_of(const std::string& arguments) {
  const CommandResult result = run_command("detect --stills " + arguments);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const std::vector<nlohmann::json> detections = detections_of(result.output);
  EXPECT_EQ(detections.size(), 1U);
  return detections.empty() ? nlohmann::json() : detections[0]["obstacles"];
}

TEST(Input, OnePairIsFoundTheSameInEveryLayout) {
  const TemporaryFolder folder;
  const Pair pair = make_ground_pair(true);
  const nlohmann::json expected = obstacles_of(add_pair(folder, pair));
  ASSERT_FALSE(expected.empty());
  const std::string calibration = " --calib " + folder.add("calib.txt", half_size_calibration());
  (void)folder.add("walk/7.png", encode_png(side_by_side(pair)));
  EXPECT_EQ(obstacles_of(folder / "walk --side-by-side" + calibration), expected);
  write_video(folder / "walk.avi", "FFV1", side_by_side(pair), 1);
  EXPECT_EQ(obstacles_of(folder / "walk.avi" + calibration), expected);
  (void)folder.add("kitti/calib.txt", half_size_calibration());
  (void)folder.add("kitti/image_0/0.png", encode_png(pair.left));
  (void)folder.add("kitti/image_1/0.png", encode_png(pair.right));
  EXPECT_EQ(obstacles_of(folder / "kitti --fps 15"), expected);
  EXPECT_EQ(
      obstacles_of(fmt::format("'{0}/image_0/*.png' --right '{0}/image_1/%d.png' --fps 15{1}", folder / "kitti", calibration)),
      expected);
  EXPECT_EQ(obstacles_of(fmt::format("'{}/*.png' --side-by-side{}", folder / "walk", calibration)), expected);
}

// The file ends in the middle of a picture: that one is not made up, and all that are missing are told in one line.
TEST(Input, TruncatedVideoIsTold) {
  constexpr int kFrames = 6;
  constexpr int kWhole = 3;
  const TemporaryFolder folder;
  write_video(folder / "whole.avi", "MJPG", side_by_side({make_texture({160, 120}, 1), make_texture({160, 120}, 2)}), kFrames);
  const std::string bytes = read_file(folder / "whole.avi");
  std::size_t cut = bytes.find("movi");
  for (int number = 0; number <= kWhole; ++number) cut = bytes.find("00dc", cut + 4);
  ASSERT_NE(cut, std::string::npos);
  const std::string arguments =
      folder.add("cut.avi", bytes.substr(0, cut + 6000)) + " --calib " + folder.add("calib.txt", half_size_calibration());
  const CommandResult result = run_command("detect --stills " + arguments);
  EXPECT_EQ(result.exit_code, 0);
  const std::vector<nlohmann::json> detections = detections_of(result.output);
  ASSERT_EQ(detections.size(), 6U);
  for (int number = 0; number < kFrames; ++number) {
    const nlohmann::json& detection = detections[static_cast<std::size_t>(number)];
    EXPECT_EQ(detection["status"], number < kWhole ? "ok" : "no_picture") << number;
    EXPECT_DOUBLE_EQ(detection["time"].get<double>(), std::round(number / 15.0 * 1e6) / 1e6) << number;
  }
  const std::vector<std::string> lines = lines_of(result.errors);
  ASSERT_EQ(lines.size(), 3U) << result.errors;
  EXPECT_NE(lines[0].find("cut.avi: side-by-side video, 6 frames of 2 x 160x120 px, 15 a second"), std::string::npos);
  EXPECT_NE(lines[1].find("cut.avi: 3 of its 6 frames can be decoded: it is truncated or damaged"), std::string::npos);
  EXPECT_NE(lines[2].find("3 of 6 frames ok"), std::string::npos);
}

TEST(Input, UnequalCountsAreTold) {
  const TemporaryFolder folder;
  const std::string picture = encode_png(make_texture({160, 120}, 1));
  (void)folder.add("calib.txt", half_size_calibration());
  for (const std::string name : {"image_0/0.png", "image_0/1.png", "image_0/2.png", "image_1/0.png"}) {
    (void)folder.add(name, picture);
  }
  const CommandResult result = run_command("detect --stills " + folder / "");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(detections_of(result.output).size(), 3U);
  EXPECT_EQ(faults_of(result).at(0),
            "brink: " + folder / "" + ": 3 left and 1 right pictures: from frame 1 on the right ones are missing");
}

class BadInputKind : public ::testing::Test {
 protected:
  void expect_refusal(const std::string& arguments, int exit_code, const std::string& part) const {
    const CommandResult result = run_command("detect " + arguments);
    EXPECT_EQ(result.exit_code, exit_code) << arguments;
    EXPECT_EQ(faults_of(result).size(), 1U) << arguments << "\n" << result.errors;
    EXPECT_NE(result.errors.find(part), std::string::npos) << "\"" << result.errors << "\" does not hold \"" << part << "\"";
    EXPECT_EQ(result.output, "") << arguments;
  }

  TemporaryFolder folder_;
  std::string calib_ = " --calib " + folder_.add("calib.txt", half_size_calibration());
  std::string picture_ = folder_.add("picture.png", encode_png(make_texture({320, 120}, 1)));
};

TEST_F(BadInputKind, OptionsThatDoNotGoTogether) {
  const std::string prose = folder_.add("walk.mp4", "no video\n");
  const std::string folder = folder_ / "";
  expect_refusal(prose, 2, "walk.mp4 is taken for a side-by-side video: --calib is needed with it");
  expect_refusal(folder + " --side-by-side", 2, "has both eyes side by side: --calib is needed with it");
  expect_refusal(folder + " --side-by-side --right " + picture_ + calib_, 2, "--right goes with one picture");
  expect_refusal(folder + " --right " + picture_ + calib_, 2, "--right goes with one picture");
  expect_refusal(folder + " --pictures square", 2, "--pictures");
  expect_refusal(picture_ + " --side-by-side" + calib_, 2, "--side-by-side goes with a folder, a pattern or a video");
  expect_refusal(picture_ + " --fps 15 --right " + picture_ + calib_, 2, "--fps and --times go with a sequence");
  expect_refusal(folder + " --side-by-side --fps 0" + calib_, 2, "fps = 0, must be more than 0");
  expect_refusal(folder + " --fps fast", 2, "--fps");
}

TEST_F(BadInputKind, VideoThatIsNone) {
  write_video(folder_ / "whole.mp4", "mp4v", make_texture({320, 120}, 1), 5);
  const std::string bytes = read_file(folder_ / "whole.mp4");
  const std::string why = ": cannot be read as a video: it is none, or its beginning or end is missing";
  expect_refusal(folder_.add("cut.mp4", bytes.substr(0, bytes.size() / 2)) + calib_, 1, "cut.mp4" + why);
  expect_refusal(folder_.add("empty.mkv", "") + calib_, 1, "empty.mkv" + why);
  expect_refusal(folder_.add("prose.txt", "no video\n") + calib_, 1, "prose.txt" + why);
  expect_refusal("/dev/null" + calib_, 1, "/dev/null: is no regular file");
}

TEST_F(BadInputKind, TimesThatDoNotIncrease) {
  (void)folder_.add("walk/0.png", encode_png(make_texture({320, 120}, 1)));
  (void)folder_.add("walk/1.png", encode_png(make_texture({320, 120}, 1)));
  (void)folder_.add("walk/times.txt", "0.5\n0.5\n");
  expect_refusal(folder_ / "walk --side-by-side" + calib_, 1,
                 "times.txt: time 2 = 0.5, expected more than the one before, 0.5");
}

TEST(Input, EurocIsRecognisedAndNamed) {
  BRINK_REQUIRE_DATA(standing, "euroc_standing");
  const CommandResult result = run_command("detect " + standing);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(detections_of(result.output).size(), 10U);
  const std::string first = lines_of(result.errors).at(0);
  EXPECT_TRUE(first.starts_with(fmt::format(
      "brink: {}: EuRoC/ASL, 10 frames, {} IMU readings; calibration: EuRoC sensor.yaml pair, radial-tangential, 752x480 px, ",
      standing, open_sequence(standing).imu().size())))
      << first;
  EXPECT_TRUE(first.ends_with("rectified on the fly")) << first;
  EXPECT_NE(first.find("baseline 0.11"), std::string::npos) << first;
}

}  // namespace
}  // namespace brink::test
