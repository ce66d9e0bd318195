#include "brink/sequence.hpp"

#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "brink/pictures.hpp"
#include "expect_error.hpp"
#include "temporary_folder.hpp"
#include "test_data.hpp"

namespace brink {
namespace {

const char* const kCalibration =
    "P0: 700 0 600 0 0 700 180 0 0 0 1 0\nP1: 700 0 600 -350 0 700 180 0 0 0 1 0\n"
    "P2: 710 0 610 0 0 710 190 0 0 0 1 0\nP3: 710 0 610 -142 0 710 190 0 0 0 1 0\n";

std::string picture(int level, int type = CV_8UC1, cv::Size size = {48, 40}) {
  return encode_png(cv::Mat(size, type, cv::Scalar::all(level)));
}

// A sequence of three grey frames.
void fill(const test::TemporaryFolder& folder, const std::string& left = "image_0", const std::string& right = "image_1") {
  (void)folder.add("calib.txt", kCalibration);
  for (const std::string name : {"000000.png", "000001.png", "000002.png"}) {
    (void)folder.add(fmt::format("{}/{}", left, name), picture(10));
    (void)folder.add(fmt::format("{}/{}", right, name), picture(20));
  }
}

std::string fault(const test::TemporaryFolder& folder) {
  return test::error_of<std::runtime_error>([&] { open_sequence(folder / ""); });
}

TEST(OpenSequence, ReadsEveryFrameWithItsTime) {
  const test::TemporaryFolder folder;
  fill(folder);
  (void)folder.add("times.txt", "0.5\n0.75\n1e0\n\n");
  const Sequence sequence = open_sequence(folder / "");
  ASSERT_EQ(sequence.size(), 3);
  EXPECT_EQ(sequence.camera().focal, 700);
  const FrameReading reading = sequence.read(2);
  EXPECT_EQ(reading.status, FrameStatus::ok);
  EXPECT_EQ(reading.reason, "");
  EXPECT_EQ(reading.frame.index, 2);
  EXPECT_EQ(reading.frame.time, 1.0);
  EXPECT_EQ(reading.frame.left(0, 0), 10);
  EXPECT_EQ(reading.frame.right(0, 0), 20);
  EXPECT_THROW((void)sequence.read(3), std::out_of_range);
}

TEST(OpenSequence, PrefersColour) {
  const test::TemporaryFolder folder;
  fill(folder);
  (void)folder.add("image_2/000000.png", picture(30, CV_8UC3));
  (void)folder.add("image_3/000000.png", picture(40));  // grey on the right: as in the pothole set
  const Sequence sequence = open_sequence(folder / "");
  EXPECT_EQ(sequence.size(), 1);
  EXPECT_EQ(sequence.camera().focal, 710);
  const Frame frame = sequence.read(0).frame;
  EXPECT_EQ(frame.left_color(0, 0), cv::Vec3b(30, 30, 30));
  EXPECT_EQ(frame.right(0, 0), 40);
}

TEST(OpenSequence, TakesTheNumberAsTimeWithoutTimes) {
  const test::TemporaryFolder folder;
  fill(folder);
  EXPECT_EQ(open_sequence(folder / "").read(2).frame.time, 2.0);
}

TEST(OpenSequence, TakesTheTimeFromTheFrameRateThatIsGiven) {
  const test::TemporaryFolder folder;
  fill(folder);
  EXPECT_EQ(open_sequence(folder / "", {.fps = 8.0}).read(2).frame.time, 0.25);
  const auto refusal = [&](double fps) {
    return test::error_of<std::invalid_argument>([&] { open_sequence(folder / "", {.fps = fps}); });
  };
  test::expect_line_with(refusal(0.0), "fps = 0, must be more than 0");
  test::expect_line_with(refusal(std::nan("")), "fps = nan, must be more than 0");
  (void)folder.add("times.txt", "0\n0.1\n0.2\n");
  test::expect_line_with(refusal(8.0), "times.txt tells the times");
}

TEST(OpenSequence, SortsNamesByNumber) {
  const test::TemporaryFolder folder;
  (void)folder.add("calib.txt", kCalibration);
  for (const int number : {10, 9, 11}) {  // as text, 9 comes last
    (void)folder.add(fmt::format("image_0/{}.png", number), picture(number));
    (void)folder.add(fmt::format("image_1/{}.png", number), picture(number));
  }
  const Sequence sequence = open_sequence(folder / "");
  ASSERT_EQ(sequence.size(), 3);
  for (const int position : {0, 1, 2}) EXPECT_EQ(sequence.read(position).frame.left(0, 0), 9 + position);
}

TEST(OpenSequence, TellsUnequalCounts) {
  const test::TemporaryFolder folder;
  fill(folder);
  ASSERT_EQ(open_sequence(folder / "").remarks().size(), 1U);
  test::expect_line_with(open_sequence(folder / "").remarks()[0],
                         ": KITTI layout, 3 frames; calibration: KITTI, P0 and P1, 48x40 px, focal length 700.00 px");
  (void)folder.add("image_0/000003.png", picture(10));
  (void)folder.add("image_0/000004.png", picture(10));
  const Sequence tail = open_sequence(folder / "");
  ASSERT_EQ(tail.remarks().size(), 2U);
  test::expect_line_with(tail.remarks()[1], ": 5 left and 3 right pictures: from frame 3 on the right ones are missing");
  EXPECT_EQ(tail.read(2).status, FrameStatus::ok);
  EXPECT_EQ(tail.read(3).status, FrameStatus::no_picture);
  EXPECT_EQ(tail.read(4).status, FrameStatus::no_picture);
  std::filesystem::remove(folder / "image_0/000001.png");
  test::expect_line_with(open_sequence(folder / "").remarks().at(1),
                         ": 4 left and 3 right pictures: frames without a partner: 3, the first is frame 1");
}

TEST(OpenSequence, KeepsAFrameForEveryMissingPicture) {
  const test::TemporaryFolder folder;
  fill(folder);
  std::filesystem::remove(folder / "image_0/000001.png");
  (void)folder.add("image_1/000004.png", picture(20));  // one eye runs on, and 3 is missing in both
  const Sequence sequence = open_sequence(folder / "");
  ASSERT_EQ(sequence.size(), 5);
  for (const int position : {1, 3, 4}) {
    const FrameReading reading = sequence.read(position);
    EXPECT_EQ(reading.status, FrameStatus::no_picture);
    EXPECT_EQ(reading.frame.index, position);
    test::expect_line_with(reading.reason, "image_0/00000" + std::to_string(position) + ".png: no such file");
  }
  EXPECT_EQ(sequence.read(2).status, FrameStatus::ok);
}

TEST(OpenSequence, StartsAtTheSmallestNumber) {
  const test::TemporaryFolder folder;
  (void)folder.add("calib.txt", kCalibration);
  (void)folder.add("times.txt", "0\n0.1\n0.2\n0.3\n");
  (void)folder.add("image_0/000003.png", picture(1));
  (void)folder.add("image_1/000003.png", picture(1));
  const Sequence sequence = open_sequence(folder / "");
  ASSERT_EQ(sequence.size(), 1);
  EXPECT_EQ(sequence.read(0).frame.index, 3);
  EXPECT_EQ(sequence.read(0).frame.time, 0.3);
}

TEST(OpenSequence, TellsABadFrameAndGoesOn) {
  const test::TemporaryFolder folder;
  fill(folder);
  (void)folder.add("image_1/000000.png", "no picture");
  (void)folder.add("image_1/000001.png", picture(20, CV_8UC1, {50, 40}));
  const Sequence sequence = open_sequence(folder / "");
  EXPECT_EQ(sequence.read(0).status, FrameStatus::bad_frame);
  test::expect_line_with(sequence.read(0).reason, "image_1/000000.png: is not a PNG or JPEG picture");
  EXPECT_EQ(sequence.read(1).status, FrameStatus::bad_frame);
  test::expect_line_with(sequence.read(1).reason, "image_1/000001.png: pictures differ in size: left 48x40, right 50x40 px");
  EXPECT_EQ(sequence.read(2).status, FrameStatus::ok);
}

TEST(OpenSequence, IgnoresOtherFiles) {
  const test::TemporaryFolder folder;
  fill(folder);
  (void)folder.add("image_0/notes.txt", "x");
  (void)folder.add("image_0/.000009.png", "x");
  EXPECT_EQ(open_sequence(folder / "").size(), 3);
}

TEST(OpenSequence, RefusesAFolderThatIsNoSequence) {
  test::expect_line_with(test::error_of<std::runtime_error>([] { open_sequence("/nowhere"); }), "/nowhere: no such folder");
  const test::TemporaryFolder folder;
  test::expect_line_with(
      fault(folder),
      "no pictures, expected folders image_2 and image_3 (colour), image_0 and image_1 (grey), or mav0 (EuRoC/ASL)");
  std::filesystem::create_directories(folder / "image_0");
  std::filesystem::create_directories(folder / "image_1");
  test::expect_line_with(fault(folder), "image_0: holds no PNG or JPEG pictures");
  (void)folder.add("image_0/000000.png", picture(1));
  test::expect_line_with(fault(folder), "calib.txt: no such file");
}

TEST(OpenSequence, RefusesNamesThatAreNoNumbers) {
  const test::TemporaryFolder folder;
  fill(folder);
  (void)folder.add("image_0/left3.png", "x");
  test::expect_line_with(fault(folder), "left3.png: name is not a frame number, expected one like 000012.png");
}

TEST(OpenSequence, RefusesTwoPicturesOfOneNumber) {
  const test::TemporaryFolder folder;
  fill(folder);
  (void)folder.add("image_0/2.jpg", "x");
  test::expect_line_with(fault(folder), "frame 2 has another picture");
}

TEST(OpenSequence, RefusesAJumpInTheNumbers) {
  const test::TemporaryFolder folder;
  fill(folder);
  (void)folder.add("image_0/900000.png", "x");
  test::expect_line_with(fault(folder), "frame numbers jump from 2 to 900000");
}

TEST(OpenSequence, RefusesWrongTimes) {
  const test::TemporaryFolder folder;
  fill(folder);
  (void)folder.add("times.txt", "0\n1\n");
  test::expect_line_with(fault(folder), "times.txt: has 2 times, expected one for each frame from 0 to 2");
  (void)folder.add("times.txt", "");
  test::expect_line_with(fault(folder), "times.txt: has 0 times");
  (void)folder.add("times.txt", "0\nsoon\n2\n");
  test::expect_line_with(fault(folder), "times.txt: time 2 = soon, expected seconds");
  (void)folder.add("times.txt", "0\nnan\n2\n");
  test::expect_line_with(fault(folder), "times.txt: time 2 = nan, expected seconds");
  (void)folder.add("times.txt", "0\n2\n2\n");
  test::expect_line_with(fault(folder), "times.txt: time 3 = 2, expected more than the one before, 2");
  (void)folder.add("times.txt", "0\n2\n1\n");
  test::expect_line_with(fault(folder), "times.txt: time 3 = 1, expected more than the one before, 2");
}

TEST(OpenPair, IsASequenceOfOneFrame) {
  const test::TemporaryFolder folder;
  const Sequence sequence =
      open_pair(folder.add("l.png", picture(1)), folder.add("r.png", picture(2)), {folder.add("calib.txt", kCalibration)});
  ASSERT_EQ(sequence.size(), 1);
  EXPECT_EQ(sequence.read(0).status, FrameStatus::ok);
  EXPECT_EQ(sequence.camera().focal, 710);
}

TEST(OpenSequence, OpensTheRealOnes) {
  BRINK_REQUIRE_DATA(potholes, "pothole_a");
  const Sequence sequence = open_sequence(potholes);
  ASSERT_EQ(sequence.size(), 8);
  for (int i = 0; i < sequence.size(); ++i) EXPECT_EQ(sequence.read(i).reason, "");
  EXPECT_FALSE(sequence.read(0).frame.left_color.empty());
  BRINK_REQUIRE_DATA(kitti, "kitti_straight");
  EXPECT_EQ(open_sequence(kitti).size(), 51);
  EXPECT_EQ(open_sequence(kitti).read(50).reason, "");
}

}  // namespace
}  // namespace brink
