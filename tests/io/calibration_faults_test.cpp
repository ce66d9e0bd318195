#include <cmath>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "brink/calibration.hpp"
#include "expect_error.hpp"
#include "io/calibration_writer.hpp"
#include "temporary_folder.hpp"

namespace brink {
namespace {

const cv::Size kSize(672, 376);

test::StereoRig make_rig() {
  test::StereoRig rig = test::make_rig({350.0, 335.5, 187.5, 0.12}, kSize);
  rig.left.distortion = {-0.17, 0.02, 1e-4, -1e-4, 1e-3};
  rig.right.distortion = {-0.16, 0.02, 1e-4, -1e-4, 1e-3};
  return rig;
}

test::StereoRig moved_to(const Eigen::Vector3d& place) {
  test::StereoRig rig = make_rig();
  rig.right_from_left.translation() = -place;
  return rig;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  EXPECT_NE(text.find(from), std::string::npos) << from;
  return text.replace(text.find(from), from.size(), to);
}

/// What reading a file of this text is refused with.
std::string fault(const std::string& text, cv::Size pictures = kSize) {
  const test::TemporaryFolder folder;
  const std::string path = folder.add("file", text);
  return test::error_of<std::runtime_error>([&] { read_calibration({path}, pictures); });
}

/// The same for the two files of a ROS pair.
class RosFiles {
 public:
  RosFiles() : rig_(make_rig()) { write({-0.12 * 350}); }
  void write(double tx) {
    (void)folder_.add("right.yaml", test::ros_text(rig_.right, Eigen::Matrix3d::Identity(), {350, 335.5, 187.5, tx}));
    (void)folder_.add("left.yaml", test::ros_text(rig_.left, Eigen::Matrix3d::Identity(), {350, 335.5, 187.5, 0}));
  }
  StereoCalibration read(std::optional<PictureState> pictures) const {
    return read_calibration({folder_ / "left.yaml", "", pictures}, kSize);
  }
  [[nodiscard]] std::string fault() const {
    return test::error_of<std::runtime_error>([&] { (void)read(PictureState::rectified); });
  }

  test::TemporaryFolder folder_;
  test::StereoRig rig_;
};

TEST(Calibration, ForPicturesOfGigabytesIsRefused) {
  const auto of_size = [](int width, int height) {
    return fmt::format("%YAML:1.0\n---\nimage_width: {}\nimage_height: {}\n", width, height) +
           test::opencv_matrix("Q", 4, 4, {1, 0, 0, -335, 0, 1, 0, -187, 0, 0, 0, 350, 0, 0, 8, 0});
  };
  test::expect_line_with(fault(of_size(10000, 10000)), "is for pictures of 10000x10000 px, expected at most 64 megapixels");
  test::expect_line_with(fault(of_size(60000000, 1)), "60000000, expected whole numbers from 1 to 10000 px");
}

using Writer = std::string (*)(const test::StereoRig&);

/// The kinds that hold both cameras with their lenses in one file.
class LensKinds : public ::testing::TestWithParam<Writer> {};

TEST_P(LensKinds, CamerasThatDoNotStandSideBySideAreRefused) {
  const auto fault_at = [](const Eigen::Vector3d& place) { return fault(GetParam()(moved_to(place))); };
  test::expect_line_with(fault_at({-0.12, 0.0, 0.0}),
                         "the right camera is at (-0.12, 0, 0) m from the left one, expected on its right: are they swapped?");
  test::expect_line_with(fault_at({0.01, 0.12, 0.0}), "m from the left one, expected beside it");
  test::expect_line_with(fault_at({0.01, 0.0, -0.12}), "m from the left one, expected beside it");
  test::expect_line_with(fault_at({0.0, 0.0, 0.0}), "m from the left one, expected beside it");
  test::expect_line_with(fault_at({120.0, 0.0, 0.0}), "expected at most 10 m (is it in millimetres?)");
}

TEST_P(LensKinds, NumbersThatAreNoneAreRefused) {
  test::StereoRig rig = make_rig();
  rig.right.focal_x = std::nan("");
  test::expect_line_with(fault(GetParam()(rig)), "= nan, expected a finite number");
  rig.right.focal_x = 0.0;
  test::expect_line_with(fault(GetParam()(rig)), "focal length = 0, expected 1 to 1000000 px");
}

INSTANTIATE_TEST_SUITE_P(Files, LensKinds, ::testing::Values(test::opencv_text, test::kalibr_text, test::zed_text));

TEST(CalibrationFaults, PicturesOfAnotherSizeAreRefused) {
  const std::string kalibr = test::kalibr_text(make_rig());
  test::expect_line_with(fault(kalibr, {640, 360}), "is for pictures of 672x376 px, these have 640x360");
  test::expect_line_with(fault(kalibr, {336, 188}),
                         "these have 336x188 (0.5 times as large): scaled pictures need a calibration of their own");
  test::expect_line_with(fault(test::opencv_text(make_rig()), {1344, 752}), "these have 1344x752 (2 times as large)");
  test::expect_line_with(fault(test::zed_text(make_rig()), {640, 480}),
                         "ZED: is for pictures of 2208x1242, 1920x1080, 1280x720, 672x376 px, these have 640x480");
  test::expect_line_with(fault(test::zed_text(make_rig()), {}), "no picture that can be read tells which");
}

TEST(CalibrationFaults, OpenCv) {
  const std::string good = test::opencv_text(make_rig());
  test::expect_line_with(fault(replaced(good, "D2:", "D3:")), "D2 is missing");
  test::expect_line_with(fault(replaced(good, "R:", "r:")), "R is missing");
  test::expect_line_with(fault(replaced(good, "plumb_bob", "magic")), "D1 = magic, expected radial-tangential, rational");
  test::expect_line_with(fault(replaced(good, "image_width: 672", "image_width: wide")),
                         "image_width = wide, expected a whole");
  test::expect_line_with(fault(replaced(good, "-0.17, 0.02, ", "")), "D1 plumb_bob has 3 numbers, expected 4, 5, 8, 12");
  test::expect_line_with(fault(replaced(good, "[ 350, 0, 335.5", "[ 350, 2, 335.5")), "M1 is no camera matrix");
  test::expect_line_with(fault(replaced(good, "[ 1, 0, 0, 0, 1", "[ 1, 0, 0, 0, 2")), "R is no rotation");
}

TEST(CalibrationFaults, OpenCvTellsItsSizeOrThePicturesDo) {
  const test::TemporaryFolder folder;
  const std::string file =
      folder.add("stereo.yaml", replaced(test::opencv_text(make_rig()), "image_width: 672\nimage_height: 376\n", ""));
  EXPECT_EQ(read_calibration({file}, kSize).size, kSize);
  test::expect_line_with(test::error_of<std::runtime_error>([&] { read_calibration({file}); }), "tells no size");
}

TEST(CalibrationFaults, Kalibr) {
  const std::string good = test::kalibr_text(make_rig());
  const std::string first = "camera_model: pinhole";
  for (const std::string model : {"omni", "ds", "eucm"}) {
    test::expect_line_with(fault(replaced(good, first, "camera_model: " + model)),
                           fmt::format("cam0 camera_model = {}, expected pinhole", model));
  }
  test::expect_line_with(fault(replaced(good, "radtan", "fov")), "cam0 distortion_model = fov, expected radial-tangential");
  test::expect_line_with(fault(replaced(good, "radtan", "equidistant")), "equidistant has 5 numbers, expected 4");
  test::expect_line_with(fault(replaced(good, "T_cn_cnm1", "T_cam_imu")), "cam1 T_cn_cnm1 is missing");
  test::expect_line_with(fault(replaced(good, "resolution: [672, 376]", "resolution: [672]")), "cam0 resolution has 1 numbers");
  test::expect_line_with(fault(replaced(good, "resolution: [672, 376]", "resolution: [600, 376]")),
                         "the right camera has 672x376 px, expected those of the left one, 600x376");
  test::expect_line_with(fault("cam0:\n  camera_model: pinhole\n  intrinsics: [1, 2\n"), "is not YAML: line ");
}

TEST(CalibrationFaults, Middlebury) {
  const std::string good =
      "cam0=[350 0 300; 0 350 187; 0 0 1]\ncam1=[350 0 320; 0 350 187; 0 0 "
      "1]\ndoffs=20\nbaseline=120.5\nwidth=672\nheight=376\n";
  const test::TemporaryFolder folder;
  const StereoCalibration calibration = read_calibration({folder.add("calib.txt", good)});
  EXPECT_NEAR(calibration.camera.baseline, 0.1205, 1e-12);
  EXPECT_EQ(calibration.camera.cx, 300.0);
  ASSERT_NE(calibration.rectification, nullptr);
  test::expect_line_with(fault(replaced(good, "doffs=20", "doffs=-20")),
                         "doffs = -20, expected the difference of the principal columns, 20.000");
  test::expect_line_with(fault(replaced(good, "baseline=120.5\n", "")), "baseline is missing");
  test::expect_line_with(fault(replaced(good, "baseline=120.5", "baseline=-120.5")),
                         "baseline = -0.1205 m, expected more than 0");
  test::expect_line_with(fault(replaced(good, "0 350 187; 0 0 1]\ncam1", "0 300 187; 0 0 1]\ncam1")),
                         "cam0 focal lengths along x and y = 350 and 300, expected equal values");
  test::expect_line_with(fault(replaced(good, "width=672", "width=0")), "width, height = 0, expected whole numbers");
  test::expect_line_with(fault(good, {336, 188}), "0.5 times as large");
}

TEST(CalibrationFaults, Zed) {
  const std::string good = test::zed_text(make_rig());
  test::expect_line_with(fault(replaced(good, "Baseline=", "Base=")), "[STEREO] BASELINE is missing");
  test::expect_line_with(fault(replaced(good, "[RIGHT_CAM_VGA]", "[RIGHT_CAM_QVGA]")), "[RIGHT_CAM_VGA] FX is missing");
  test::expect_line_with(fault("[STEREO]\nBaseline\n"), "is no ZED calibration: line 2");
}

TEST(CalibrationFaults, Ros) {
  RosFiles files;
  EXPECT_NEAR(files.read(PictureState::rectified).camera.baseline, 0.12, 1e-12);
  files.write(0.12 * 350);
  test::expect_line_with(files.fault(),
                         "right.yaml: ROS camera_info, left.yaml and right.yaml: baseline = -0.12 m, expected more");
  files.write(0.0);
  test::expect_line_with(files.fault(), "baseline = 0 m, expected more than 0: are left and right the same camera?");
  files.rig_.right.size = {640, 376};
  files.write(-0.12 * 350);
  test::expect_line_with(files.fault(), "right.yaml: is for 640x376 px, expected the size of ");
  (void)files.folder_.add("right.yaml", "image_width: 672\n");
  test::expect_line_with(files.fault(), "right.yaml: image_height is missing");
  (void)files.folder_.add("right.yaml", "camera_info: 3\n");
  test::expect_line_with(files.fault(), "right.yaml: camera_info holds no fields");
}

// The same files, and two answers: only who made the pictures knows.
TEST(CalibrationFaults, FilesThatDescribeRawAndRectifiedPicturesNeedToBeTold) {
  const RosFiles files;
  test::expect_line_with(test::error_of<std::invalid_argument>([&] { (void)files.read(std::nullopt); }),
                         "pictures = not told, must be raw or rectified: ");
  EXPECT_EQ(files.read(PictureState::rectified).rectification, nullptr);
  EXPECT_NE(files.read(PictureState::raw).rectification, nullptr);
  const test::TemporaryFolder folder;
  const std::string both =
      folder.add("both.yaml", test::opencv_text(make_rig()) +
                                  test::opencv_matrix("P1", 3, 4, {300, 0, 330, 0, 0, 300, 180, 0, 0, 0, 1, 0}) +
                                  test::opencv_matrix("P2", 3, 4, {300, 0, 330, -36, 0, 300, 180, 0, 0, 0, 1, 0}));
  test::expect_line_with(test::error_of<std::invalid_argument>([&] { read_calibration({both}); }),
                         "pictures = not told, must be");
  EXPECT_EQ(read_calibration({both, "", PictureState::rectified}).camera.focal, 300.0);
  EXPECT_EQ(read_calibration({both, "", PictureState::raw}).source, "OpenCV, M1 and M2, radial-tangential");
}

TEST(CalibrationFaults, PictureStateThatTheFileDoesNotDescribeIsRefused) {
  const test::TemporaryFolder folder;
  const std::string kalibr = folder.add("camchain.yaml", test::kalibr_text(make_rig()));
  const std::string kitti =
      folder.add("calib.txt", "P0: 700 0 600 0 0 700 180 0 0 0 1 0\nP1: 700 0 600 -350 0 700 180 0 0 0 1 0\n");
  test::expect_line_with(test::error_of<std::invalid_argument>([&] {
                           read_calibration({kalibr, "", PictureState::rectified});
                         }),
                         "pictures = rectified, must be raw or not told: ");
  test::expect_line_with(test::error_of<std::invalid_argument>([&] {
                           read_calibration({kitti, "", PictureState::raw});
                         }),
                         "pictures = raw, must be rectified or not told: ");
  test::expect_line_with(test::error_of<std::invalid_argument>([&] { read_calibration({kitti, kalibr}); }), "calib-right = ");
}

// Undistorted cameras side by side: the pictures are raw and rectified.
TEST(CalibrationFaults, IdealCamerasMayBeCalledBoth) {
  const test::TemporaryFolder folder;
  const std::string file = folder.add("camchain.yaml", test::kalibr_text(test::make_rig({350, 335.5, 187.5, 0.12}, kSize)));
  for (const PictureState state : {PictureState::raw, PictureState::rectified}) {
    EXPECT_EQ(read_calibration({file, "", state}).rectification, nullptr);
  }
}

TEST(CalibrationFiles, PartnerIsFoundByNameOrTold) {
  RosFiles files;
  const std::string left = files.folder_ / "left.yaml";
  EXPECT_EQ(files.read(PictureState::rectified).source, "ROS camera_info, left.yaml and right.yaml");
  std::filesystem::rename(files.folder_ / "right.yaml", files.folder_ / "other.yaml");
  test::expect_line_with(files.fault(),
                         "left.yaml: ROS camera_info is about one camera, expected another file with the right one");
  EXPECT_EQ(read_calibration({left, files.folder_ / "other.yaml", PictureState::rectified}).source,
            "ROS camera_info, left.yaml and other.yaml");
}

// OpenCV's example for stereo cameras writes two files.
TEST(CalibrationFiles, OpenCvMayTellLensesAndPlacesInTwoFiles) {
  const test::TemporaryFolder folder;
  const std::string text = test::opencv_text(make_rig());
  const std::size_t places = text.find("R: ");
  const std::string lenses = folder.add("intrinsics.yml", text.substr(0, places));
  test::expect_line_with(test::error_of<std::runtime_error>([&] { read_calibration({lenses}); }), "R is missing");
  const std::string places_file = folder.add("extrinsics.yml", "%YAML:1.0\n---\n" + text.substr(places));
  EXPECT_NEAR(read_calibration({lenses}).camera.baseline, 0.12, 1e-9);
  EXPECT_NEAR(read_calibration({lenses, places_file}).camera.baseline, 0.12, 1e-9);
}

/// A single camera as each kind tells it.
TEST(SingleCamera, IsForDepthsOnly) {
  const test::TemporaryFolder folder;
  const LensCamera eye = test::make_rig({350.0, 335.5, 187.5, 0.12}, kSize).left;
  const Eigen::Matrix3d straight = Eigen::Matrix3d::Identity();
  const std::string opencv = fmt::format("%YAML:1.0\n---\nimage_width: 672\nimage_height: 376\n{}{}",
                                         test::opencv_matrix("camera_matrix", 3, 3, test::matrix_of(eye)),
                                         test::opencv_matrix("distortion_coefficients", 1, 5, {0, 0, 0, 0, 0}));
  for (const std::string& file :
       {folder.add("info.yaml", test::ros_text(eye, straight, {350, 335.5, 187.5, 0})),
        folder.add("sensor.yaml", test::euroc_text(eye, Eigen::Isometry3d::Identity())),
        folder.add("chain.yaml", test::kalibr_camera("cam0", eye)), folder.add("opencv.yaml", opencv)}) {
    test::expect_line_with(test::error_of<std::runtime_error>([&] { read_calibration({file}); }), " is about one camera");
    const StereoCalibration calibration = read_depth_calibration({file}, kSize);
    EXPECT_TRUE(calibration.single) << file;
    EXPECT_EQ(calibration.camera.focal, 350.0);
    EXPECT_EQ(calibration.camera.cx, 335.5);
    EXPECT_EQ(calibration.camera.baseline, kNominalBaseline);
    EXPECT_EQ(calibration.rectification, nullptr);
    EXPECT_NE(describe(calibration).find("baseline 0.1000 m (in name only: one camera)"), std::string::npos)
        << describe(calibration);
    test::expect_line_with(test::error_of<std::runtime_error>([&] {
                             read_depth_calibration({file}, {640, 360});
                           }),
                           "is for pictures of 672x376 px, these have 640x360");
  }
}

TEST(SingleCamera, WithALensIsRefused) {
  const test::TemporaryFolder folder;
  const LensCamera eye = make_rig().left;
  const auto refusal = [&](const std::string& text) {
    const std::string file = folder.add("file", text);
    return test::error_of<std::runtime_error>([&] { read_depth_calibration({file}); });
  };
  test::expect_line_with(refusal(test::kalibr_camera("cam0", eye)),
                         "Kalibr, cam0: the lens is radial-tangential, expected none: a single picture is not corrected");
  LensCamera oblong = eye;
  oblong.distortion.clear();
  oblong.focal_y = 400.0;
  test::expect_line_with(refusal(test::kalibr_camera("cam0", oblong)), "focal lengths along x and y = 350 and 400");
}

// What was rectified by ROS has the camera of P, whatever its lens was.
TEST(SingleCamera, OfRosIsThatOfItsRectifiedPictures) {
  const test::TemporaryFolder folder;
  const std::string file =
      folder.add("info.yaml", test::ros_text(make_rig().left, Eigen::Matrix3d::Identity(), {300, 330, 180, 0}));
  test::expect_line_with(test::error_of<std::invalid_argument>([&] { read_depth_calibration({file}); }), "pictures = not told");
  EXPECT_EQ(read_depth_calibration({file, "", PictureState::rectified}).camera.focal, 300.0);
}

// The whole pair tells the true baseline.
TEST(SingleCamera, OfAPairIsThatOfThePair) {
  const test::TemporaryFolder folder;
  const std::string file = folder.add("camchain.yaml", test::kalibr_text(test::make_rig({350, 335.5, 187.5, 0.12}, kSize)));
  const StereoCalibration calibration = read_depth_calibration({file}, kSize);
  EXPECT_FALSE(calibration.single);
  EXPECT_NEAR(calibration.camera.baseline, 0.12, 1e-12);
}

TEST(Describe, TellsWhatWasUnderstood) {
  StereoCalibration calibration{{350.0, 335.5, 187.5, 0.12}, "Somebody's", {}};
  EXPECT_EQ(describe(calibration), "Somebody's, focal length 350.00 px, baseline 0.1200 m, rectified already");
  calibration.size = {700, 376};
  EXPECT_EQ(
      describe(calibration),
      "Somebody's, 700x376 px, focal length 350.00 px, baseline 0.1200 m, field of view 90 x 56 degrees, rectified already");
  calibration.size = {320, 188};
  EXPECT_NE(describe(calibration).find("; its principal point (336, 188) is outside the pictures: is it of another size?"),
            std::string::npos);
}

}  // namespace
}  // namespace brink
