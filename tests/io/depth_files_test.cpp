// Sequences of disparity or depth images in place of right pictures.
#include <filesystem>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "brink/pictures.hpp"
#include "brink/sequence.hpp"
#include "expect_error.hpp"
#include "temporary_folder.hpp"

namespace brink {
namespace {

const char* const kCalibration =
    "P0: 700 0 600 0 0 700 180 0 0 0 1 0\nP1: 700 0 600 -350 0 700 180 0 0 0 1 0\n"
    "P2: 710 0 610 0 0 710 190 0 0 0 1 0\nP3: 710 0 610 -142 0 710 190 0 0 0 1 0\n";

std::string picture(int level, int type = CV_8UC1, cv::Size size = {48, 40}) {
  return encode_png(cv::Mat(size, type, cv::Scalar::all(level)));
}

/// Three frames: disparities of 5 px, depths of 1.4 m.
void fill(const test::TemporaryFolder& folder, const std::string& left) {
  (void)folder.add("calib.txt", kCalibration);
  (void)folder.add("times.txt", "0.5\n0.75\n1\n");
  for (int i = 0; i < 3; ++i) {
    if (!left.empty()) (void)folder.add(fmt::format("{}/{:06}.png", left, i), picture(10, CV_8UC3));
    (void)folder.add(fmt::format("disparity/{:06}.png", i), picture(5 * 256, CV_16UC1));
    (void)folder.add(fmt::format("depth/{:06}.png", i), picture(1400, CV_16UC1));
  }
}

TEST(OpenDepthSequence, PutsDisparitiesBesideTheLeftPictures) {
  const test::TemporaryFolder folder;
  fill(folder, "image_2");
  const Sequence sequence = open_depth_sequence(folder / "", DepthKind::disparity);
  ASSERT_EQ(sequence.size(), 3);
  EXPECT_EQ(sequence.camera().focal, 710);
  const FrameReading reading = sequence.read(2);
  ASSERT_EQ(reading.status, FrameStatus::ok) << reading.reason;
  EXPECT_EQ(reading.frame.index, 2);
  EXPECT_EQ(reading.frame.time, 1.0);
  EXPECT_EQ(reading.frame.left(3, 3), 10);
  EXPECT_TRUE(reading.frame.right.empty());
  EXPECT_EQ(reading.frame.disparity(3, 3), 5.0F);
  ASSERT_EQ(sequence.remarks().size(), 1U);
  test::expect_line_with(sequence.remarks()[0], "disparity images in place of right pictures; calibration: KITTI, P2 and P3");
}

TEST(OpenDepthSequence, TurnsDepthsIntoDisparitiesOfItsCamera) {
  const test::TemporaryFolder folder;
  fill(folder, "image_0");
  const Sequence sequence = open_depth_sequence(folder / "", DepthKind::depth);
  EXPECT_EQ(sequence.camera().focal, 700) << "image_0 goes with P0 and P1";
  EXPECT_EQ(sequence.read(0).frame.disparity(3, 3), kInvalidDisparity)
      << "f b / z = 350 / 1.4 = 250 px is more than the picture is wide";
  (void)folder.add("depth/000001.png", picture(35000, CV_16UC1));
  EXPECT_FLOAT_EQ(sequence.read(1).frame.disparity(3, 3), 10.0F) << "350 / 35";
}

TEST(OpenDepthSequence, DoesWithoutPicturesAndSaysWhatThatMeans) {
  const test::TemporaryFolder folder;
  fill(folder, "");
  const Sequence sequence = open_depth_sequence(folder / "", DepthKind::disparity);
  const FrameReading reading = sequence.read(0);
  ASSERT_EQ(reading.status, FrameStatus::ok) << reading.reason;
  EXPECT_TRUE(reading.frame.left.empty());
  EXPECT_EQ(reading.frame.size(), cv::Size(48, 40));
  test::expect_line_with(sequence.remarks().at(0), "no left pictures: drops without disparity (Type 2) are off");
}

TEST(OpenDepthSequence, TellsFramesThatLackAnImageAndImagesThatDoNotFit) {
  const test::TemporaryFolder folder;
  fill(folder, "image_2");
  std::filesystem::remove(folder / "disparity/000001.png");
  (void)folder.add("disparity/000002.png", picture(5, CV_16UC1, {50, 40}));
  const Sequence sequence = open_depth_sequence(folder / "", DepthKind::disparity);
  EXPECT_EQ(sequence.read(0).status, FrameStatus::ok);
  EXPECT_EQ(sequence.read(1).status, FrameStatus::no_picture);
  test::expect_line_with(sequence.read(1).reason, "disparity/000001.png: no such file");
  EXPECT_EQ(sequence.read(2).status, FrameStatus::bad_frame);
  test::expect_line_with(sequence.read(2).reason, "50x40 px, expected those of the calibration and the other pictures, 48x40");
  test::expect_line_with(sequence.remarks().at(0), "3 left and 2 disparity pictures");
}

TEST(OpenDepthSequence, RefusesAFolderWithoutSuchImages) {
  const test::TemporaryFolder folder;
  fill(folder, "image_2");
  std::filesystem::remove_all(folder / "depth");
  const auto fault = [&](DepthKind kind) {
    return test::error_of<std::runtime_error>([&] { open_depth_sequence(folder / "", kind); });
  };
  test::expect_line_with(fault(DepthKind::depth), "no depth images, expected them in the folder depth");
  std::filesystem::create_directory(folder / "depth");
  std::filesystem::remove_all(folder / "image_2");
  test::expect_line_with(fault(DepthKind::depth), "depth: holds no disparity or depth images");
}

TEST(OpenDepthFiles, ChecksTheSizeThatTheCalibrationTells) {
  const test::TemporaryFolder folder;
  const std::string calibration =
      folder.add("c.yaml",
                 "%YAML:1.0\n---\nimage_width: 64\nimage_height: 40\n"
                 "P1: !!opencv-matrix\n  rows: 3\n  cols: 4\n  dt: d\n  data: [70,0,30,0, 0,70,20,0, 0,0,1,0]\n"
                 "P2: !!opencv-matrix\n  rows: 3\n  cols: 4\n  dt: d\n  data: [70,0,30,-7, 0,70,20,0, 0,0,1,0]\n");
  const std::string fits = folder.add("fits.png", picture(256, CV_16UC1, {64, 40}));
  const std::string other = folder.add("other.png", picture(256, CV_16UC1));
  const auto open = [&](const std::string& first) {
    return open_depth_files({{0, 0.0, "", first}, {1, 1.0, "", other}}, DepthKind::disparity, {calibration});
  };
  const Sequence sequence = open(fits);
  EXPECT_EQ(sequence.read(0).status, FrameStatus::ok);
  EXPECT_EQ(sequence.read(1).status, FrameStatus::bad_frame);
  test::expect_line_with(sequence.read(1).reason, "48x40 px, expected those of the calibration and the other pictures, 64x40");
  test::expect_line_with(test::error_of<std::runtime_error>([&] { open(other); }), "64x40");
}

TEST(OpenDepthFiles, AFileWithoutAnyDisparityIsAFrameOfItsOwn) {
  const test::TemporaryFolder folder;
  const std::string image = folder.add("d.png", picture(0, CV_16UC1));
  const Sequence sequence = open_depth_files({{0, 0.0, "", image}}, DepthKind::depth, {folder.add("calib.txt", kCalibration)});
  const FrameReading reading = sequence.read(0);
  ASSERT_EQ(reading.status, FrameStatus::ok);
  DetectorParams params;
  params.stills = true;
  const Detection detection = Detector(params).process(reading.frame);
  EXPECT_EQ(detection.ground.state, GroundState::not_visible);
  EXPECT_FALSE(detection.ground.reason.empty());
}

}  // namespace
}  // namespace brink
