#include "brink/calibration.hpp"

#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "expect_error.hpp"
#include "temporary_folder.hpp"
#include "test_data.hpp"

namespace brink {
namespace {

const char* const kGrey =
    "P0: 700 0 600 0 0 700 180 0 0 0 1 0\n"
    "P1: 700 0 600 -350 0 700 180 0 0 0 1 0\n";
const char* const kColor =
    "P2: 710 0 610 71 0 710 190 0.2 0 0 1 0.004\n"
    "P3: 710 0 610 -71 0 710 190 0.2 0 0 1 0.003\n";

StereoCalibration read(const std::string& text, CameraPair pair = CameraPair::any) {
  const test::TemporaryFolder folder;
  return read_calibration({folder.add("calib.txt", text)}, {}, pair);
}

std::string fault(const std::string& text, CameraPair pair = CameraPair::any) {
  return test::error_of<std::runtime_error>([&] { read(text, pair); });
}

std::string opencv_matrix(const std::string& name, int rows, const std::string& data) {
  return name + ": !!opencv-matrix\n   rows: " + std::to_string(rows) + "\n   cols: 4\n   dt: d\n   data: [ " + data + " ]\n";
}

void expect_camera(const StereoCamera& camera, double focal, double cx, double cy, double baseline) {
  EXPECT_DOUBLE_EQ(camera.focal, focal);
  EXPECT_DOUBLE_EQ(camera.cx, cx);
  EXPECT_DOUBLE_EQ(camera.cy, cy);
  EXPECT_NEAR(camera.baseline, baseline, 1e-12);
}

TEST(ReadCalibration, TakesTheColourPairOfKittiWhenBothAreThere) {
  const StereoCalibration calibration = read(std::string(kGrey) + kColor + "Tr: 1 0 0 0 0 1 0 0 0 0 1 0\n");
  expect_camera(calibration.camera, 710, 610, 190, 0.2);
  EXPECT_EQ(calibration.source, "KITTI, P2 and P3");
}

TEST(ReadCalibration, TakesTheGreyPairOfKittiWhenItIsAloneOrAskedFor) {
  expect_camera(read(kGrey).camera, 700, 600, 180, 0.5);
  expect_camera(read(std::string(kGrey) + kColor, CameraPair::grey).camera, 700, 600, 180, 0.5);
}

TEST(ReadCalibration, ReadsLinesThatEndAsOnWindows) {
  expect_camera(read("P0: 700 0 600 0 0 700 180 0 0 0 1 0\r\nP1: 700 0 600 -350 0 700 180 0 0 0 1 0\r\n").camera, 700, 600, 180,
                0.5);
}

TEST(ReadCalibration, ReadsTheProjectionsOfOpenCv) {
  const StereoCalibration calibration =
      read("%YAML:1.0\n---\n" + opencv_matrix("P1", 3, "700, 0, 600, 0, 0, 700, 180, 0, 0, 0, 1, 0") +
           opencv_matrix("P2", 3, "700., 0., 600., -350., 0., 700., 180., 0., 0., 0., 1., 0."));
  expect_camera(calibration.camera, 700, 600, 180, 0.5);
  EXPECT_EQ(calibration.source, "OpenCV, P1 and P2");
}

TEST(ReadCalibration, ReadsTheReprojectionMatrixOfOpenCv) {
  const StereoCalibration calibration =
      read("%YAML:1.0\n---\n" + opencv_matrix("Q", 4, "1, 0, 0, -600, 0, 1, 0, -180, 0, 0, 0, 700, 0, 0, 2.0, 0"));
  expect_camera(calibration.camera, 700, 600, 180, 0.5);
  EXPECT_EQ(calibration.source, "OpenCV, Q");
}

TEST(ReadCalibration, NamesTheFaultOfAKittiFile) {
  const std::string left = "P0: 700 0 600 0 0 700 180 0 0 0 1 0\n";
  const auto with_right = [&left](const std::string& numbers) { return fault(left + "P1: " + numbers + "\n"); };
  test::expect_line_with(fault(left), "calib.txt: P1 is missing, expected P0 and P1 of 12 numbers each");
  test::expect_line_with(fault(kGrey, CameraPair::color), "P2 is missing");
  test::expect_line_with(with_right("700 0 600 -350 0 700 180 0 0 0 1"), "P1 has 11 numbers, expected 12");
  test::expect_line_with(with_right("700 0 600 -350m 0 700 180 0 0 0 1 0"), "P1, number 4 = -350m, expected a finite number");
  test::expect_line_with(with_right("700 0 600 nan 0 700 180 0 0 0 1 0"), "P1, number 4 = nan, expected a finite number");
  test::expect_line_with(with_right("inf 0 600 -350 0 700 180 0 0 0 1 0"), "P1, number 1 = inf");
  test::expect_line_with(with_right("700 0 600 350 0 700 180 0 0 0 1 0"),
                         "baseline = -0.5 m, expected more than 0: are left and right");
  test::expect_line_with(with_right("700 0 600 0 0 700 180 0 0 0 1 0"), "baseline = 0 m");
  test::expect_line_with(with_right("-700 0 600 -350 0 700 180 0 0 0 1 0"), "P1 focal length = -700, expected more than 0 px");
  test::expect_line_with(with_right("0 0 600 -350 0 0 180 0 0 0 1 0"), "P1 focal length = 0");
  test::expect_line_with(with_right("700 0 600 -350000 0 700 180 0 0 0 1 0"), "is it in millimetres?");
  test::expect_line_with(with_right("700 0 600 -350 0 650 180 0 0 0 1 0"), "P1 focal lengths along x and y = 700 and 650");
  test::expect_line_with(with_right("710 0 600 -350 0 710 180 0 0 0 1 0"), "P0 and P1 focal lengths = 700 and 710");
  test::expect_line_with(with_right("700 0 620 -350 0 700 180 0 0 0 1 0"), "principal columns = 600 and 620");
  test::expect_line_with(with_right("700 0 600 -350 0 700 185 0 0 0 1 0"), "principal rows = 180 and 185");
  test::expect_line_with(with_right("700 0 600 0 0 700 180 -350 0 0 1 0"), "0.5 m apart vertically");
  test::expect_line_with(with_right("700 3 600 -350 0 700 180 0 0 0 1 0"), "P1 is not the projection of a rectified camera");
}

TEST(ReadCalibration, NamesTheFaultOfAnOpenCvFile) {
  const std::string start = "%YAML:1.0\n---\n";
  const std::string p1 = opencv_matrix("P1", 3, "700, 0, 600, 0, 0, 700, 180, 0, 0, 0, 1, 0");
  test::expect_line_with(fault(start + p1), "P2 is missing, expected P1 and P2, or Q");
  test::expect_line_with(fault(start + p1 + opencv_matrix("P2", 3, "1, 2, 3")), "P2 has 3 numbers, expected 12");
  test::expect_line_with(fault(start + p1 + opencv_matrix("P2", 3, "700, 0, 600, .NaN, 0, 700, 180, 0, 0, 0, 1, 0")),
                         "P2, number 4 = .NaN, expected a finite number");
  test::expect_line_with(fault(start + p1 + "P2: 3\n"), "P2 has no data");
  test::expect_line_with(fault(start + "P1: [1, 2\n"), "is not YAML: line ");
  test::expect_line_with(fault(start + "- 1\n"), "holds no fields");
  test::expect_line_with(fault(start + opencv_matrix("Q", 4, "1, 0, 0, -600, 0, 1, 0, -180, 0, 0, 0, 700, 0, 0, -2.0, 0")),
                         "baseline = -0.5 m");
  test::expect_line_with(fault(start + opencv_matrix("Q", 4, "1, 0, 0, -600, 0, 1, 0, -180, 0, 0, 0, 700, 0, 0, 2.0, 40")),
                         "OpenCV, Q: principal columns differ by 20 px, expected pictures of a size that is known");
}

TEST(ReadCalibration, RefusesWhatIsNoCalibration) {
  test::expect_line_with(test::error_of<std::runtime_error>([] { read_calibration({"/nowhere/calib.txt"}); }),
                         "/nowhere/calib.txt: no such file");
  test::expect_line_with(test::error_of<std::runtime_error>([] { read_calibration({"/tmp"}); }), "/tmp: is a folder");
  test::expect_line_with(fault(""), "is not a calibration that this version knows");
  test::expect_line_with(fault("hello: world\n"), "is not a calibration that this version knows");
}

TEST(ReadCalibration, ReadsTheRealOnes) {
  BRINK_REQUIRE_DATA(potholes, "pothole_a");
  expect_camera(read_calibration({potholes + "/calib.txt"}, {}, CameraPair::color).camera, 690.8755, 532.65, 286.65,
                82.516788 / 690.8755);
  BRINK_REQUIRE_DATA(kitti, "kitti_straight");
  expect_camera(read_calibration({kitti + "/calib.txt"}, {}, CameraPair::grey).camera, 707.0912, 601.8873, 183.1104,
                379.8145 / 707.0912);
}

}  // namespace
}  // namespace brink
