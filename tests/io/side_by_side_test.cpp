#include <array>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

#include "brink/files.hpp"
#include "brink/pictures.hpp"
#include "brink/sequence.hpp"
#include "expect_error.hpp"
#include "temporary_folder.hpp"

namespace brink {
namespace {

constexpr int kFrames = 12;
constexpr int kStep = 15;  // grey levels from frame to frame
const cv::Size kHalf(64, 48);

const char* const kCalibration = "P0: 70 0 32 0 0 70 24 0 0 0 1 0\nP1: 70 0 32 -7 0 70 24 0 0 0 1 0\n";

// Left half of the level of its number, right half 40 brighter.
cv::Mat3b both_eyes(int number, cv::Size half = kHalf) {
  cv::Mat3b picture(half.height, 2 * half.width, cv::Vec3b::all(static_cast<uchar>(kStep * number)));
  picture.colRange(half.width, 2 * half.width) += cv::Scalar::all(40);
  return picture;
}

void write_video(const std::string& path, const char* codec, int frames = kFrames, double fps = 20.0, cv::Size half = kHalf) {
  cv::VideoWriter writer(path, cv::CAP_FFMPEG, cv::VideoWriter::fourcc(codec[0], codec[1], codec[2], codec[3]), fps,
                         cv::Size(2 * half.width, half.height));
  ASSERT_TRUE(writer.isOpened()) << path;
  for (int number = 0; number < frames; ++number) writer.write(both_eyes(number, half));
}

void expect_frame(const FrameReading& reading, int number) {
  EXPECT_EQ(reading.reason, "");
  ASSERT_EQ(reading.status, FrameStatus::ok);
  EXPECT_EQ(reading.frame.index, number);
  EXPECT_EQ(reading.frame.left.size(), kHalf);
  constexpr double kLossy = 3.0;
  EXPECT_LE(cv::norm(reading.frame.left, cv::Mat1b(kHalf, static_cast<uchar>(kStep * number)), cv::NORM_INF), kLossy);
  EXPECT_LE(cv::norm(reading.frame.right, cv::Mat1b(kHalf, static_cast<uchar>(kStep * number + 40)), cv::NORM_INF), kLossy);
}

class SideBySide : public ::testing::Test {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const { return folder_ / name; }
  Sequence open(const std::string& name, std::optional<double> fps = std::nullopt) const {
    return open_side_by_side(folder_ / name, {calibration_}, {.fps = fps});
  }
  [[nodiscard]] std::string fault(const std::string& name) const {
    return test::error_of<std::runtime_error>([&] { open(name); });
  }

  test::TemporaryFolder folder_;
  std::string calibration_ = folder_.add("calib.txt", kCalibration);
};

class SideBySideVideo : public SideBySide, public ::testing::WithParamInterface<std::pair<const char*, const char*>> {};

TEST_P(SideBySideVideo, IsCutInTwoHalves) {
  const auto [name, codec] = GetParam();
  write_video(path(name), codec);
  const Sequence sequence = open(name);
  ASSERT_EQ(sequence.size(), kFrames);
  EXPECT_EQ(sequence.camera().focal, 70);
  for (int number = 0; number < kFrames; ++number) {
    const FrameReading reading = sequence.read(number);
    expect_frame(reading, number);
    EXPECT_DOUBLE_EQ(reading.frame.time, number / 20.0);
  }
  EXPECT_THROW((void)sequence.read(kFrames), std::out_of_range);
  ASSERT_EQ(sequence.remarks().size(), 1U);
  test::expect_line_with(sequence.remarks()[0],
                         "side-by-side video, 12 frames of 2 x 64x48 px, 20 a second; calibration: KITTI, P0 and P1");
}

INSTANTIATE_TEST_SUITE_P(Containers, SideBySideVideo,
                         ::testing::Values(std::pair("walk.avi", "MJPG"), std::pair("lossless.avi", "FFV1"),
                                           std::pair("walk.mkv", "FFV1"), std::pair("walk.mp4", "mp4v"),
                                           std::pair("walk.mov", "MJPG")));

TEST_F(SideBySide, VideoGivesTheSameFramesInAnyOrder) {
  write_video(path("walk.avi"), "FFV1");
  const Sequence sequence = open("walk.avi");
  for (const int number : {7, 3, 3, 11, 0, 1}) expect_frame(sequence.read(number), number);
}

TEST_F(SideBySide, VideoOfOneFrame) {
  write_video(path("walk.avi"), "FFV1", 1);
  const Sequence sequence = open("walk.avi");
  ASSERT_EQ(sequence.size(), 1);
  expect_frame(sequence.read(0), 0);
}

TEST_F(SideBySide, VideoTakesTheFrameRateThatIsGiven) {
  write_video(path("walk.avi"), "FFV1");
  EXPECT_DOUBLE_EQ(open("walk.avi", 8.0).stamps()[4].time, 0.5);
  test::expect_line_with(test::error_of<std::invalid_argument>([&] { open("walk.avi", -1.0); }),
                         "fps = -1, must be more than 0");
}

// Every frame that the file announced is told; those before the cut are whole.
TEST_F(SideBySide, TruncatedVideoTellsItsMissingFrames) {
  write_video(path("whole.mkv"), "FFV1");
  const std::string bytes = read_file(path("whole.mkv"));
  (void)folder_.add("cut.mkv", bytes.substr(0, bytes.size() / 2));
  const Sequence sequence = open("cut.mkv");
  ASSERT_EQ(sequence.size(), kFrames);
  int good = 0;
  while (good < kFrames && sequence.read(good).status == FrameStatus::ok) {
    expect_frame(sequence.read(good), good);
    ++good;
  }
  EXPECT_GT(good, 2);
  ASSERT_LT(good, kFrames - 2);
  for (int number = good; number < kFrames; ++number) {
    const FrameReading reading = sequence.read(number);
    EXPECT_EQ(reading.status, FrameStatus::no_picture);
    EXPECT_EQ(reading.frame.index, number);
    test::expect_line_with(reading.reason, fmt::format("cut.mkv: {} of its 12 frames can be decoded: it is truncated", good));
  }
  expect_frame(sequence.read(0), 0);
}

// An MP4 keeps what it is made of at its end.
TEST_F(SideBySide, RefusesWhatIsNoVideo) {
  write_video(path("whole.mp4"), "mp4v");
  const std::string bytes = read_file(path("whole.mp4"));
  (void)folder_.add("cut.mp4", bytes.substr(0, bytes.size() / 2));
  (void)folder_.add("empty.mp4", "");
  (void)folder_.add("prose.mp4", "this is no video\n");
  (void)folder_.add("prose.txt", "this is no video\n");
  for (const std::string name : {"cut.mp4", "empty.mp4", "prose.mp4", "prose.txt"}) {
    test::expect_line_with(fault(name), name + ": cannot be read as a video");
  }
  test::expect_line_with(fault("nowhere.mp4"), "nowhere.mp4: no such file");
  test::expect_line_with(test::error_of<std::runtime_error>([&] { open_side_by_side("/dev/null", {calibration_}); }),
                         "/dev/null: is no regular file, expected a video");
}

TEST_F(SideBySide, RefusesAVideoThatDoesNotFitTheCalibration) {
  write_video(path("walk.avi"), "FFV1");
  const std::string numbers = "P1: {data: [70,0,32,0, 0,70,24,0, 0,0,1,0]}\nP2: {data: [70,0,32,-7, 0,70,24,0, 0,0,1,0]}\n";
  const auto refusal = [&](const std::string& size) {
    const std::string file = folder_.add("calib.yaml", "%YAML:1.0\n" + numbers + size);
    return test::error_of<std::runtime_error>([&] { open_side_by_side(path("walk.avi"), {file}); });
  };
  test::expect_line_with(refusal("image_width: 128\nimage_height: 48\n"),
                         "calib.yaml: is for pictures of 128x48 px, these have 64x48");
  test::expect_line_with(refusal("image_width: wide\nimage_height: 48\n"), "image_width = wide, expected a whole number");
  const std::string fitting = folder_.add("calib.yaml", "%YAML:1.0\n" + numbers + "image_width: 64\nimage_height: 48\n");
  EXPECT_EQ(open_side_by_side(path("walk.avi"), {fitting}).size(), kFrames);
}

TEST_F(SideBySide, FolderOfPicturesIsCutInTwoHalves) {
  for (const int number : {10, 9, 11}) (void)folder_.add(fmt::format("walk/{}.png", number), encode_png(both_eyes(number)));
  const Sequence sequence = open("walk");
  ASSERT_EQ(sequence.size(), 3);
  for (const int position : {0, 1, 2}) expect_frame(sequence.read(position), 9 + position);
  EXPECT_EQ(sequence.stamps()[0].time, 9.0);
  EXPECT_EQ(open("walk", 18.0).stamps()[0].time, 0.5);
  ASSERT_EQ(sequence.remarks().size(), 1U);
  test::expect_line_with(sequence.remarks()[0], "side-by-side pictures, 3 frames; calibration: KITTI, P0 and P1");
  (void)folder_.add("walk/times.txt", "0\n1\n2\n3\n4\n5\n6\n7\n8\n8.5\n8.75\n9\n");
  EXPECT_EQ(open("walk").stamps()[1].time, 8.75);
  test::expect_line_with(test::error_of<std::invalid_argument>([&] { open("walk", 18.0); }), "times.txt tells the times");
}

TEST_F(SideBySide, FolderTellsBadPicturesAndGoesOn) {
  (void)folder_.add("walk/0.png", encode_png(both_eyes(0)));
  (void)folder_.add("walk/2.png", encode_png(cv::Mat1b(48, 127, uchar{9})));
  (void)folder_.add("walk/3.png", "no picture");
  (void)folder_.add("walk/4.png", encode_png(both_eyes(4, {16, 48})));
  (void)folder_.add("walk/5.png", encode_png(both_eyes(5)));
  const Sequence sequence = open("walk");
  ASSERT_EQ(sequence.size(), 6);
  expect_frame(sequence.read(0), 0);
  EXPECT_EQ(sequence.read(1).status, FrameStatus::no_picture);
  test::expect_line_with(sequence.read(1).reason, "000001.png: no such file");
  const std::array<const char*, 3> reasons{"2.png: 127x48 px, expected an even width: two pictures side by side",
                                           "3.png: is not a PNG or JPEG picture",
                                           "4.png: 16x48 px, expected those of the calibration and the other pictures, 64x48"};
  for (int position = 2; position < 5; ++position) {
    const FrameReading reading = sequence.read(position);
    EXPECT_EQ(reading.status, FrameStatus::bad_frame);
    test::expect_line_with(reading.reason, reasons.at(static_cast<std::size_t>(position - 2)));
  }
  expect_frame(sequence.read(5), 5);
  std::filesystem::create_directories(path("empty"));
  test::expect_line_with(fault("empty"), "empty: holds no PNG or JPEG pictures");
}

}  // namespace
}  // namespace brink
