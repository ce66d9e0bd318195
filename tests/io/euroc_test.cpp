#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "brink/files.hpp"
#include "brink/pictures.hpp"
#include "brink/sequence.hpp"
#include "expect_error.hpp"
#include "temporary_folder.hpp"
#include "test_data.hpp"

namespace brink {
namespace {

const char* const kRawCamera =
    "%YAML:1.0\nsensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [{}]\nresolution: [64, 48]\ncamera_model: pinhole\n"
    "intrinsics: [50, 50, 31.5, 23.5]\ndistortion_model: {}\ndistortion_coefficients: [0, 0, 0, 0]\n";
// Body axes are those of a vehicle (x forward, y left, z up); the camera looks forward.
const char* const kLeftPlace = "0,0,1,0.1, -1,0,0,0.05, 0,-1,0,0, 0,0,0,1";
const char* const kRightPlace = "0,0,1,0.1, -1,0,0,-0.05, 0,-1,0,0, 0,0,0,1";

std::string camera(const char* place, const char* lens = "radial-tangential") {
  return fmt::format(fmt::runtime(kRawCamera), place, lens);
}

std::string picture(int level, cv::Size size = {64, 48}) { return encode_png(cv::Mat1b(size, static_cast<uchar>(level))); }

constexpr const char* kTimes = "#timestamp [ns],filename\r\n1403715273262142976,a.png\r\n1403715273312143104,b.png\r\n";

// Two frames 0.050000128 s apart, and an IMU turned against the vehicle by half a turn around its z.
void fill(const test::TemporaryFolder& folder) {
  (void)folder.add("mav0/cam0/sensor.yaml", camera(kLeftPlace));
  (void)folder.add("mav0/cam1/sensor.yaml", camera(kRightPlace));
  for (const std::string name : {"cam0", "cam1"}) {
    (void)folder.add("mav0/" + name + "/data.csv", kTimes);
    (void)folder.add("mav0/" + name + "/data/a.png", picture(10));
    (void)folder.add("mav0/" + name + "/data/b.png", picture(20));
  }
  (void)folder.add("mav0/imu0/sensor.yaml", "%YAML:1.0\nT_BS:\n  data: [-1,0,0,0, 0,-1,0,0, 0,0,1,0, 0,0,0,1]\n");
  (void)folder.add("mav0/imu0/data.csv",
                   "#timestamp,...\n1403715273262142975,1,2,3,0.5,0.25,9.81\n1403715273262142977,0,0,0,0,0,9.81\n");
}

std::string fault(const test::TemporaryFolder& folder) {
  return test::error_of<std::runtime_error>([&] { open_sequence(folder / ""); });
}

TEST(Euroc, IsRecognisedAndRectified) {
  const test::TemporaryFolder folder;
  fill(folder);
  const Sequence sequence = open_sequence(folder / "");
  ASSERT_EQ(sequence.size(), 2);
  EXPECT_NEAR(sequence.camera().focal, 50, 1e-9);
  EXPECT_NEAR(sequence.camera().baseline, 0.1, 1e-12);
  const FrameReading reading = sequence.read(1);
  EXPECT_EQ(reading.reason, "");
  EXPECT_EQ(reading.frame.index, 1);
  EXPECT_EQ(reading.frame.left.size(), cv::Size(64, 48));
  EXPECT_EQ(reading.frame.left(20, 30), 20);
  ASSERT_EQ(sequence.remarks().size(), 1U);
  test::expect_line_with(
      sequence.remarks()[0],
      "EuRoC/ASL, 2 frames, 2 IMU readings; calibration: EuRoC sensor.yaml pair, no distortion, 64x48 px, focal "
      "length 50.00 px, baseline 0.1000 m, field of view 65 x 51 degrees, rectified already");
}

TEST(Euroc, KeepsTimesToTheNanosecond) {
  const test::TemporaryFolder folder;
  fill(folder);
  const Sequence sequence = open_sequence(folder / "");
  EXPECT_EQ(sequence.stamps()[0].time, 0.0);
  EXPECT_NEAR(sequence.stamps()[1].time, 0.050000128, 1e-15);
  EXPECT_NEAR(sequence.imu()[0].time, -1e-9, 1e-20);
  EXPECT_NEAR(sequence.imu()[1].time, 1e-9, 1e-20);
}

// IMU to vehicle: (-x, -y, z). Vehicle to camera: x right = -left, y down = -up, z forward.
TEST(Euroc, TurnsTheImuIntoTheCamera) {
  const test::TemporaryFolder folder;
  fill(folder);
  const ImuSample sample = open_sequence(folder / "").imu().at(0);
  EXPECT_TRUE(sample.angular_rate.isApprox(Eigen::Vector3d(2, -3, -1), 1e-9)) << sample.angular_rate.transpose();
  EXPECT_TRUE(sample.specific_force.isApprox(Eigen::Vector3d(0.25, -9.81, -0.5), 1e-9)) << sample.specific_force.transpose();
}

TEST(Euroc, DoesWithoutAnImu) {
  const test::TemporaryFolder folder;
  fill(folder);
  std::filesystem::remove_all(folder / "mav0/imu0");
  const Sequence sequence = open_sequence(folder / "");
  EXPECT_TRUE(sequence.imu().empty());
  EXPECT_EQ(sequence.read(0).frame.gravity, std::nullopt);
}

TEST(Euroc, KeepsAFrameWhosePartnerIsMissing) {
  const test::TemporaryFolder folder;
  fill(folder);
  (void)folder.add("mav0/cam1/data.csv", "1403715273312143104,b.png\n");
  const Sequence sequence = open_sequence(folder / "");
  ASSERT_EQ(sequence.size(), 2);
  EXPECT_EQ(sequence.read(0).status, FrameStatus::no_picture);
  test::expect_line_with(sequence.read(0).reason, "cam0/data/a.png: has no partner in the other eye");
  EXPECT_EQ(sequence.read(1).status, FrameStatus::ok);
  ASSERT_EQ(sequence.remarks().size(), 2U);
  test::expect_line_with(sequence.remarks()[1],
                         "2 left and 1 right pictures: frames without a partner: 1, the first is frame 0");
  std::filesystem::remove(folder / "mav0/cam1/data/b.png");
  EXPECT_EQ(sequence.read(1).status, FrameStatus::no_picture);
}

TEST(Euroc, RefusesALensThatItDoesNotKnow) {
  const test::TemporaryFolder folder;
  fill(folder);
  (void)folder.add("mav0/cam1/sensor.yaml", camera(kRightPlace, "fov"));
  test::expect_line_with(fault(folder), "cam1/sensor.yaml: distortion_model = fov, expected radial-tangential, rational");
}

TEST(Euroc, RefusesFaultyFiles) {
  const test::TemporaryFolder folder;
  fill(folder);
  const auto expect = [&](const std::string& file, const std::string& bytes, const std::string& part) {
    const std::string before = read_file(folder / file);
    (void)folder.add(file, bytes);
    test::expect_line_with(fault(folder), file + ": " + part);
    (void)folder.add(file, before);
  };
  expect("mav0/cam0/sensor.yaml", "%YAML:1.0\n", "holds no fields");
  expect("mav0/cam0/sensor.yaml", "camera_model: omni\n", "camera_model = omni, expected pinhole");
  expect("mav0/cam0/sensor.yaml", "camera_model: pinhole\ndistortion_model: radtan\n", "intrinsics is missing");
  const std::string good = camera(kRightPlace);
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    return text.replace(text.find(from), from.size(), to);
  };
  expect("mav0/cam1/sensor.yaml", changed("[64, 48]", "[64.5, 48]"), "resolution = 64.5, expected whole numbers");
  expect("mav0/cam1/sensor.yaml", changed("[64, 48]", "[32, 48]"),
         "EuRoC sensor.yaml pair: the right camera has 32x48 px, expected those of the left one, 64x48");
  expect("mav0/cam1/sensor.yaml", changed("[50, 50,", "[-50, 50,"), "focal length = -50, expected 1 to");
  expect("mav0/cam1/sensor.yaml", changed("[0, 0, 0, 0]", "[0, 0, 0]"),
         "distortion_model radial-tangential has 3 numbers, expected 4");
  expect("mav0/cam1/sensor.yaml", camera("1,2,3"), "T_BS has 3 numbers, expected 16");
  expect("mav0/cam1/sensor.yaml", camera("2,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1"), "T_BS is no rotation");
  expect("mav0/cam1/sensor.yaml", camera("0,0,1,0.1, -1,0,0,0.15, 0,-1,0,0, 0,0,0,1"),
         "EuRoC sensor.yaml pair: the right camera is at (-0.1, 0, 0) m from the left one, expected on its right: are they "
         "swapped?");
  expect("mav0/cam1/data.csv", "1,a.png\n", "shares no time with that of cam0");
  expect("mav0/cam1/data.csv", "#nothing\n", "lists no pictures");
  expect("mav0/cam1/data.csv", "1.5,a.png\n", "line 1 = 1.5,a.png, expected 2 fields, the first one a time in ns");
  expect("mav0/cam1/data.csv", "5,a.png\n5,b.png\n", "line 2: time 5 is there twice");
  const std::string cam0 = read_file(folder / "mav0/cam0/data.csv");
  expect("mav0/cam0/data.csv", cam0 + "1,c.png\n2,d.png\n1403715273312143105,e.png\n",
         "time 1403715273312143105 is 1403715273 s after the first one and cannot be told from the one before");
  expect("mav0/imu0/data.csv", "1,2,3\n", "line 1 = 1,2,3, expected 7 fields");
  expect("mav0/imu0/data.csv", "1,0,0,x,0,0,0\n", "line 1, number 4 = x, expected a finite number");
  expect("mav0/imu0/data.csv", "2,0,0,0,0,0,0\n1,0,0,0,0,0,0\n", "line 2: time 1, expected more than the one before");
  test::expect_line_with(test::error_of<std::invalid_argument>([&] { open_sequence(folder / "", {.fps = 20.0}); }),
                         "fps = 20, must not be given");
}

TEST(Euroc, TellsAPictureOfAnotherSize) {
  const test::TemporaryFolder folder;
  fill(folder);
  (void)folder.add("mav0/cam1/data/b.png", picture(20, {62, 48}));
  const FrameReading reading = open_sequence(folder / "").read(1);
  EXPECT_EQ(reading.status, FrameStatus::bad_frame);
  test::expect_line_with(reading.reason, "cam1/data/b.png: pictures differ in size: left 64x48, right 62x48 px");
  (void)folder.add("mav0/cam0/data/b.png", picture(20, {62, 48}));
  test::expect_line_with(open_sequence(folder / "").read(1).reason,
                         "62x48 px, expected those of the calibration and the other pictures, 64x48");
}

/// Rows that corners of the left picture lie lower than in the right one, found by optical flow there and back.
std::vector<double> row_differences(const Frame& frame) {
  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(frame.left, corners, 500, 0.01, 8);
  std::vector<cv::Point2f> there;
  std::vector<cv::Point2f> back;
  std::vector<uchar> found;
  std::vector<uchar> returned;
  std::vector<float> errors;
  const cv::TermCriteria exactly(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 50, 1e-4);
  cv::calcOpticalFlowPyrLK(frame.left, frame.right, corners, there, found, errors, {21, 21}, 4, exactly);
  cv::calcOpticalFlowPyrLK(frame.right, frame.left, there, back, returned, errors, {21, 21}, 4, exactly);
  std::vector<double> differences;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const bool same = found[i] != 0 && returned[i] != 0 && cv::norm(corners[i] - back[i]) < 0.1;
    if (same) differences.push_back(corners[i].y - there[i].y);
  }
  return differences;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

TEST(Euroc, RectifiesTheRealOneToAThirdOfAPixel) {
  BRINK_REQUIRE_DATA(standing, "euroc_standing");
  const Sequence sequence = open_sequence(standing);
  ASSERT_EQ(sequence.size(), 10);
  EXPECT_NEAR(sequence.camera().baseline, 0.11, 0.001);
  std::vector<double> magnitudes;
  std::vector<double> signed_rows;
  for (int position = 0; position < sequence.size(); ++position) {
    const FrameReading reading = sequence.read(position);
    ASSERT_EQ(reading.reason, "");
    for (const double rows : row_differences(reading.frame)) {
      signed_rows.push_back(rows);
      magnitudes.push_back(std::abs(rows));
    }
  }
  ASSERT_GT(magnitudes.size(), 1000U);
  constexpr double kThird = 0.3;
  const auto within = std::count_if(magnitudes.begin(), magnitudes.end(), [](double rows) { return rows < kThird; });
  const double share = static_cast<double>(within) / static_cast<double>(magnitudes.size());
  EXPECT_LT(median(magnitudes), kThird);
  EXPECT_GT(share, 0.8);  // the rest is what optical flow finds at edges along rows and in repeated patterns
  EXPECT_LT(std::abs(median(signed_rows)), 0.3);
  RecordProperty("share_within_third", fmt::format("{:.4f} of {}", share, magnitudes.size()));
  RecordProperty("median_dy_px", fmt::format("{:.4f}", median(magnitudes)));
  RecordProperty("median_signed_dy_px", fmt::format("{:.4f}", median(signed_rows)));
}

// The vehicle stands on a level floor: what the IMU feels points into the ground that the pictures show. Frame 0 is told no
// gravity yet, so the ground is found by the pictures alone.
TEST(Euroc, FeelsGravityAcrossTheGroundThatItSees) {
  BRINK_REQUIRE_DATA(standing, "euroc_standing");
  const Sequence sequence = open_sequence(standing);
  const Frame frame = sequence.read(0).frame;
  ASSERT_FALSE(frame.gravity);
  const Detection detection = Detector(DetectorParams::brink()).process(frame);
  ASSERT_EQ(detection.ground.state, GroundState::seen);
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  int count = 0;
  for (const ImuSample& sample : sequence.imu()) {
    if (sample.time > sequence.stamps()[5].time) break;  // then the rotors start
    force += sample.specific_force;
    ++count;
  }
  force /= count;
  EXPECT_NEAR(force.norm(), kGravity, 0.1);
  constexpr double kMostDegrees = 1.5;
  const auto angle_to_ground = [&](const Eigen::Vector3d& down) {
    return std::acos(down.normalized().dot(detection.ground.pose.down)) * 180.0 / CV_PI;
  };
  EXPECT_LT(angle_to_ground(-force), kMostDegrees);
  const std::optional<Eigen::Vector3d> gravity = sequence.read(9).frame.gravity;
  ASSERT_TRUE(gravity);
  EXPECT_LT(angle_to_ground(*gravity), kMostDegrees);
  RecordProperty("gravity_to_ground_deg", fmt::format("{:.3f} at rest, {:.3f} in frame 9; force {:.4f} m/s^2",
                                                      angle_to_ground(-force), angle_to_ground(*gravity), force.norm()));
}

}  // namespace
}  // namespace brink
