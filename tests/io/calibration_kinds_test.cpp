#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/core/eigen.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "brink/detector.hpp"
#include "brink/pictures.hpp"
#include "brink/sequence.hpp"
#include "brink/sim/render.hpp"
#include "io/calibration_writer.hpp"
#include "sim/small_scenes.hpp"
#include "temporary_folder.hpp"

namespace brink {
namespace {

// The smallest size that a ZED knows, so that it can be one of the kinds.
const cv::Size kSize(672, 376);
const StereoCamera kIdeal{350.0, 335.5, 187.5, 0.12};
// From which pictures with lenses are made: more pixels, and wide enough for a fisheye.
const cv::Size kLargeSize(1900, 1300);
const StereoCamera kLarge{480.0, 949.5, 649.5, 0.12};

struct Eyes {
  cv::Mat3b left;
  cv::Mat3b right;
};

/// Gravel with a hole 1.2 m long and wide and 0.6 m deep, 2.4 m ahead of someone whose eyes are 1.6 m up.
sim::Scene make_scene() {
  constexpr int kGravel = 6;
  sim::Scene scene = sim::test::make_street(0.0F);
  scene.meshes.clear();
  scene.instances.clear();
  sim::test::add_ground_with_hole(scene, 2.4F, 3.6F, -0.6F, 0.6F, 0.6F, kGravel, kGravel);
  return scene;
}

Eyes render(const StereoCamera& camera, cv::Size size) {
  sim::Renderer renderer(make_scene());
  const sim::CameraMotion standing = sim::test::standing(sim::test::make_pose(1.6, 30.0));
  std::vector<cv::Mat3f> light;
  for (const int eye : {0, 1}) light.push_back(renderer.render(camera, size, standing, 0.0, eye, {}, 1));
  const double gain = sim::compute_auto_gain(light[0]);
  return {sim::expose(light[0], gain, 0, {}, 1), sim::expose(light[1], gain, 1, {}, 2)};
}

const Eyes& ideal_pictures() {
  static const Eyes eyes = render(kIdeal, kSize);
  return eyes;
}

const Eyes& large_pictures() {
  static const Eyes eyes = render(kLarge, kLargeSize);
  return eyes;
}

/// What a camera with a lens makes of a large ideal picture. @param camera_from_ideal how it is turned.
cv::Mat3b with_lens(const cv::Mat3b& large, const LensCamera& camera, const Eigen::Matrix3d& camera_from_ideal) {
  std::vector<cv::Point2d> pixels;
  for (int v = 0; v < camera.size.height; ++v) {
    for (int u = 0; u < camera.size.width; ++u) pixels.emplace_back(u, v);
  }
  cv::Matx33d ideal_from_camera;
  const Eigen::Matrix3d back = camera_from_ideal.transpose();
  cv::eigen2cv(back, ideal_from_camera);
  const cv::Matx33d lens(camera.focal_x, 0, camera.cx, 0, camera.focal_y, camera.cy, 0, 0, 1);
  const cv::Matx33d ideal(kLarge.focal, 0, kLarge.cx, 0, kLarge.focal, kLarge.cy, 0, 0, 1);
  std::vector<cv::Point2d> sources;
  if (camera.model == LensModel::fisheye) {
    cv::fisheye::undistortPoints(pixels, sources, lens, camera.distortion, ideal_from_camera, ideal);
  } else {
    const cv::TermCriteria exactly(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-9);
    cv::undistortPoints(pixels, sources, lens, camera.distortion, ideal_from_camera, ideal, exactly);
  }
  cv::Mat2f places(camera.size);
  std::transform(sources.begin(), sources.end(), places.begin(),
                 [](const cv::Point2d& place) { return cv::Vec2f(static_cast<float>(place.x), static_cast<float>(place.y)); });
  cv::Mat3b picture;
  cv::remap(large, picture, places, cv::noArray(), cv::INTER_CUBIC);
  return picture;
}

/// Cameras that are turned and stand as no factory would let them, and their pictures.
struct RawPair {
  test::StereoRig rig;
  Eyes pictures;
};

RawPair make_raw_pair(LensModel model, const std::vector<double>& left_lens, const std::vector<double>& right_lens) {
  const auto turn = [](double x, double y, double z) {
    const double degree = CV_PI / 180.0;
    return (Eigen::AngleAxisd(x * degree, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(y * degree, Eigen::Vector3d::UnitY()) *
            Eigen::AngleAxisd(z * degree, Eigen::Vector3d::UnitZ()))
        .toRotationMatrix();
  };
  const Eigen::Matrix3d left_from_ideal = turn(0.6, -0.8, 0.4);
  const Eigen::Matrix3d right_from_ideal = turn(-0.5, 0.9, -0.7);
  RawPair raw;
  raw.rig.left = {352.0, 351.0, 341.0, 183.0, model, left_lens, kSize};
  raw.rig.right = {349.0, 350.0, 330.0, 190.0, model, right_lens, kSize};
  raw.rig.right_from_left.linear() = right_from_ideal * left_from_ideal.transpose();
  raw.rig.right_from_left.translation() = right_from_ideal * Eigen::Vector3d(-kLarge.baseline, 0.0, 0.0);
  raw.pictures = {with_lens(large_pictures().left, raw.rig.left, left_from_ideal),
                  with_lens(large_pictures().right, raw.rig.right, right_from_ideal)};
  return raw;
}

/// What is reported of the only frame.
std::vector<NegativeObstacle> obstacles_of(const Sequence& sequence) {
  const FrameReading reading = sequence.read(0);
  EXPECT_EQ(reading.reason, "");
  DetectorParams params = DetectorParams::brink();
  params.stills = true;
  return Detector(params).process(reading.frame).obstacles;
}

void expect_same(const std::vector<NegativeObstacle>& found, const std::vector<NegativeObstacle>& expected,
                 const std::string& name) {
  ASSERT_EQ(found.size(), expected.size()) << name;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Candidate& candidate = found[i].candidate;
    const Candidate& same = expected[i].candidate;
    constexpr double kRounding = 1e-4;  // m, degrees: what a detection is written with
    EXPECT_NEAR(candidate.distance_m, same.distance_m, kRounding) << name;
    EXPECT_NEAR(candidate.bearing_deg, same.bearing_deg, kRounding) << name;
    EXPECT_LT((candidate.rim_nearest - same.rim_nearest).norm(), kRounding) << name;
    EXPECT_EQ(candidate.contour, same.contour) << name;
  }
}

std::string side_by_side(const Eyes& eyes) {
  cv::Mat3b both;
  cv::hconcat(eyes.left, eyes.right, both);
  return encode_png(both);
}

/// The scene in every layout of pictures, each with the same calibration.
std::vector<Sequence> open_every_layout(const test::TemporaryFolder& folder, const Eyes& eyes, const CalibrationFiles& files) {
  const std::string left = folder.add("kitti/image_2/000000.png", encode_png(eyes.left));
  const std::string right = folder.add("kitti/image_3/000000.png", encode_png(eyes.right));
  (void)folder.add("both/000000.png", side_by_side(eyes));
  cv::Mat3b both;
  cv::hconcat(eyes.left, eyes.right, both);
  cv::VideoWriter video(folder / "both.avi", cv::CAP_FFMPEG, cv::VideoWriter::fourcc('p', 'n', 'g', ' '), 15.0, both.size());
  video.write(both);
  video.release();
  std::vector<Sequence> sequences;
  sequences.push_back(open_pair(left, right, files));
  sequences.push_back(open_sequence(folder / "kitti", {}, files));
  sequences.push_back(open_side_by_side(folder / "both", files));
  sequences.push_back(open_side_by_side(folder / "both.avi", files));
  return sequences;
}

// The scene of issue 6: as a pair, a KITTI folder, side-by-side pictures and a video, with every kind of calibration.
TEST(CalibrationKinds, OneSceneIsFoundTheSameThroughEveryLayoutAndKind) {
  const test::TemporaryFolder folder;
  const Sequence plain(kIdeal, {{0, 0.0, folder.add("l.png", encode_png(ideal_pictures().left)),
                                 folder.add("r.png", encode_png(ideal_pictures().right))}});
  const std::vector<NegativeObstacle> expected = obstacles_of(plain);
  ASSERT_EQ(expected.size(), 1U);
  EXPECT_NEAR(expected[0].candidate.distance_m, 2.4, 0.1);
  const std::vector<test::WrittenCalibration> kinds = test::write_rectified_kinds(folder, kIdeal, kSize);
  EXPECT_EQ(kinds.size(), 10U);
  for (const test::WrittenCalibration& written : kinds) {
    for (const Sequence& sequence : open_every_layout(folder, ideal_pictures(), written.files)) {
      const std::string told = sequence.remarks().at(0);
      EXPECT_NE(told.find("; calibration: " + written.kind), std::string::npos) << told;
      EXPECT_NE(
          told.find("672x376 px, focal length 350.00 px, baseline 0.1200 m, field of view 88 x 56 degrees, rectified already"),
          std::string::npos)
          << told;
      expect_same(obstacles_of(sequence), expected, told);
    }
  }
}

TEST(CalibrationKinds, EurocFolderFindsTheSameScene) {
  const test::TemporaryFolder folder;
  const Sequence plain(kIdeal, {{0, 0.0, folder.add("l.png", encode_png(ideal_pictures().left)),
                                 folder.add("r.png", encode_png(ideal_pictures().right))}});
  const test::StereoRig rig = test::make_rig(kIdeal, kSize);
  (void)folder.add("mav0/cam0/sensor.yaml", test::euroc_text(rig.left, Eigen::Isometry3d::Identity()));
  (void)folder.add("mav0/cam1/sensor.yaml", test::euroc_text(rig.right, rig.right_from_left.inverse()));
  for (const auto& [name, picture] : {std::pair("cam0", ideal_pictures().left), std::pair("cam1", ideal_pictures().right)}) {
    (void)folder.add(fmt::format("mav0/{}/data.csv", name), "#t,name\n0,a.png\n");
    (void)folder.add(fmt::format("mav0/{}/data/a.png", name), encode_png(picture));
  }
  expect_same(obstacles_of(open_sequence(folder / "")), obstacles_of(plain), "EuRoC");
}

/// A folder whose calib.txt, calib.yaml or calib.conf is of any kind.
TEST(CalibrationKinds, KittiFolderTakesAnyKindInPlaceOfItsOwn) {
  const test::TemporaryFolder folder;
  (void)folder.add("image_2/000000.png", encode_png(ideal_pictures().left));
  (void)folder.add("image_3/000000.png", encode_png(ideal_pictures().right));
  const test::StereoRig rig = test::make_rig(kIdeal, kSize);
  (void)folder.add("calib.conf", test::zed_text(rig));
  EXPECT_NE(open_sequence(folder / "").remarks().at(0).find("calibration: ZED, VGA"), std::string::npos);
  (void)folder.add("calib.yaml", test::kalibr_text(rig));
  EXPECT_NE(open_sequence(folder / "").remarks().at(0).find("calibration: Kalibr"), std::string::npos);
  (void)folder.add("calib.txt", test::opencv_text(rig));
  EXPECT_NE(open_sequence(folder / "").remarks().at(0).find("calibration: OpenCV, M1 and M2"), std::string::npos);
}

// The IMU reads in the axes of the camera as it stands; the frame is that of the rectified one.
TEST(CalibrationKinds, ImuOfARawKittiFolderIsTurnedWithThePictures) {
  const test::TemporaryFolder folder;
  const RawPair raw = make_raw_pair(LensModel::radial_tangential, {-0.28, 0.07, 0, 0}, {-0.28, 0.07, 0, 0});
  (void)folder.add("image_2/000000.png", encode_png(raw.pictures.left));
  (void)folder.add("image_3/000000.png", encode_png(raw.pictures.right));
  (void)folder.add("calib.yaml", test::kalibr_text(raw.rig));
  (void)folder.add("imu.csv", "0.5,0.1,0.2,0.3,1,-9,2\n");
  const ImuSample sample = open_sequence(folder / "").imu().at(0);
  const Eigen::Matrix3d rectified_from_left =
      make_rectification(raw.rig.left, raw.rig.right, raw.rig.right_from_left).rectified_from_left;
  EXPECT_FALSE(rectified_from_left.isIdentity(1e-3));
  EXPECT_TRUE(sample.angular_rate.isApprox(rectified_from_left * Eigen::Vector3d(0.1, 0.2, 0.3), 1e-9));
  EXPECT_TRUE(sample.specific_force.isApprox(rectified_from_left * Eigen::Vector3d(1, -9, 2), 1e-9));
}

struct Lens {
  const char* name;
  LensModel model;
  std::vector<double> left;
  std::vector<double> right;
  std::size_t kinds;  ///< that can describe it
};

class RawPictures : public ::testing::TestWithParam<Lens> {};

/// Rectified and seen by other pixels than the ideal cameras', the scene is the same within what the matcher tells: 0.1 px of
/// disparity are 1.5 cm at 2.5 m.
TEST_P(RawPictures, AreRectifiedToTheSameSceneByEveryKind) {
  const Lens& lens = GetParam();
  const test::TemporaryFolder folder;
  const Sequence plain(kIdeal, {{0, 0.0, folder.add("l.png", encode_png(ideal_pictures().left)),
                                 folder.add("r.png", encode_png(ideal_pictures().right))}});
  const Candidate expected = obstacles_of(plain).at(0).candidate;
  const RawPair raw = make_raw_pair(lens.model, lens.left, lens.right);
  const std::vector<test::WrittenCalibration> kinds = test::write_lens_kinds(folder, raw.rig);
  EXPECT_EQ(kinds.size(), lens.kinds);
  const std::string left = folder.add("left.png", encode_png(raw.pictures.left));
  const std::string right = folder.add("right.png", encode_png(raw.pictures.right));
  std::optional<std::vector<NegativeObstacle>> first;
  for (const test::WrittenCalibration& written : kinds) {
    const Sequence sequence = open_pair(left, right, written.files);
    const std::string told = sequence.remarks().at(0);
    EXPECT_NE(told.find(fmt::format("{}, {}", written.kind, lens.name)), std::string::npos) << told;
    EXPECT_TRUE(told.ends_with("rectified on the fly")) << told;
    EXPECT_NEAR(sequence.camera().baseline, kIdeal.baseline, 1e-6) << told;
    const std::vector<NegativeObstacle> found = obstacles_of(sequence);
    if (!first) first = found;
    expect_same(found, *first, told);
    ASSERT_EQ(found.size(), 1U) << told;
    const Candidate& candidate = found[0].candidate;
    EXPECT_NEAR(candidate.distance_m, expected.distance_m, 0.04) << told;
    EXPECT_NEAR(candidate.centroid.x(), expected.centroid.x(), 0.04) << told;  // the x axis is the baseline's in all
    EXPECT_NEAR(candidate.width_m, expected.width_m, 0.08) << told;
    EXPECT_NEAR(candidate.depth_m.value_or(0.0), expected.depth_m.value_or(1.0), 0.06) << told;
  }
  RecordProperty("found", fmt::format("{:.3f} m, ideal {:.3f} m", first->at(0).candidate.distance_m, expected.distance_m));
}

INSTANTIATE_TEST_SUITE_P(
    Lenses, RawPictures,
    ::testing::Values(
        Lens{"radial-tangential", LensModel::radial_tangential, {-0.28, 0.07, 4e-4, -3e-4}, {-0.27, 0.06, -2e-4, 5e-4}, 5},
        Lens{"radial-tangential",
             LensModel::radial_tangential,
             {-0.17, 0.026, 7e-5, -1.5e-4, 1e-3},
             {-0.17, 0.027, 2e-4, 1e-5, 1e-3},
             5},
        Lens{"rational",
             LensModel::radial_tangential,
             {0.5, 0.1, 2e-4, -1e-4, 0.005, 0.85, 0.22, 0.02},
             {0.52, 0.1, 1e-4, 2e-4, 0.005, 0.86, 0.23, 0.02},
             4},
        Lens{"fisheye", LensModel::fisheye, {-0.013, 0.05, -0.045, 0.012}, {-0.0135, 0.052, -0.049, 0.0135}, 4}));

// The right pictures of a Middlebury pair are cut so that nothing is at infinity.
TEST(CalibrationKinds, OffsetOfPrincipalColumnsIsMadeUpFor) {
  const test::TemporaryFolder folder;
  constexpr int kOffset = 20;  // px
  const Eyes& eyes = ideal_pictures();
  cv::Mat3b moved(kSize, cv::Vec3b());  // the principal column of these is kOffset farther right
  eyes.right.colRange(0, kSize.width - kOffset).copyTo(moved.colRange(kOffset, kSize.width));
  const std::string left = folder.add("l.png", encode_png(eyes.left));
  const std::string right = folder.add("r.png", encode_png(moved));
  const std::string text = fmt::format(
      "cam0=[350 0 335.5; 0 350 187.5; 0 0 1]\ncam1=[350 0 355.5; 0 350 187.5; 0 0 1]\ndoffs={}\nbaseline=120\nwidth=672\n"
      "height=376\nndisp=64\n",
      kOffset);
  const std::string projections = "%YAML:1.0\n---\n" +
                                  test::opencv_matrix("P1", 3, 4, {350, 0, 335.5, 0, 0, 350, 187.5, 0, 0, 0, 1, 0}) +
                                  test::opencv_matrix("P2", 3, 4, {350, 0, 355.5, -42, 0, 350, 187.5, 0, 0, 0, 1, 0});
  const std::string reprojection =
      "%YAML:1.0\n---\n" +
      test::opencv_matrix("Q", 4, 4, {1, 0, 0, -335.5, 0, 1, 0, -187.5, 0, 0, 0, 350, 0, 0, 1 / 0.12, kOffset / 0.12});
  const cv::Rect all_but_the_rim(0, 0, kSize.width - kOffset, kSize.height);
  for (const std::string& file :
       {folder.add("calib.txt", text), folder.add("p.yaml", projections), folder.add("q.yaml", reprojection)}) {
    const Sequence sequence = open_pair(left, right, {file});
    EXPECT_NE(sequence.remarks().at(0).find("right pictures moved by -20.00 px"), std::string::npos)
        << sequence.remarks().at(0);
    const Frame frame = sequence.read(0).frame;
    const Frame plain = make_frame(eyes.left, eyes.right, kIdeal);
    EXPECT_EQ(cv::norm(frame.right(all_but_the_rim), plain.right(all_but_the_rim), cv::NORM_INF), 0.0) << file;
    EXPECT_EQ(cv::norm(frame.left, plain.left, cv::NORM_INF), 0.0) << file;
  }
}

}  // namespace
}  // namespace brink
