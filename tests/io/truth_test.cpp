#include "brink/truth.hpp"

#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "brink/ground.hpp"
#include "brink/pictures.hpp"
#include "brink/sequence_writer.hpp"
#include "expect_error.hpp"
#include "temporary_folder.hpp"
#include "test_data.hpp"

namespace brink {
namespace {

const cv::Size kSize(640, 360);
const StereoCamera kCamera{350.0, 319.5, 179.5, 0.15};

// A camera 1.6 m over flat ground that looks down by 30 degrees; y of the ground frame points down, z ahead.
const double kHeight = 1.6;
Eigen::Isometry3d camera_from_ground() {
  return Eigen::Isometry3d(Eigen::AngleAxisd(std::numbers::pi / 6.0, Eigen::Vector3d::UnitX()));
}

// Points on the ground, given by what is to the right and ahead of the camera's foot, in the camera frame.
std::vector<Eigen::Vector3d> on_ground(const std::vector<Eigen::Vector2d>& right_and_ahead, double height = kHeight) {
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector2d& p : right_and_ahead)
    points.push_back(camera_from_ground() * Eigen::Vector3d(p.x(), height, p.y()));
  return points;
}

RimSighting sight(const std::vector<Eigen::Vector2d>& opening, const cv::Mat1f& disparity = {}) {
  return find_nearest_rim(on_ground(opening), kCamera, kSize, disparity);
}

TEST(FindNearestRim, MeasuresOnTheGroundFromTheFootOfTheCamera) {
  const RimSighting rim = sight({{-0.5, 3.0}, {0.5, 3.0}, {0.5, 4.0}, {-0.5, 4.0}});
  EXPECT_TRUE(rim.visible);
  EXPECT_NEAR(rim.distance_m, 3.0, 1e-9);
  EXPECT_NEAR(rim.bearing_deg, 0.0, 1e-6);
}

TEST(FindNearestRim, TellsBearingsPositiveToTheRight) {
  // The corner (1, 2) is nearest: 26.565 degrees to the right, sqrt(5) m away.
  const RimSighting rim = sight({{1.0, 2.0}, {2.0, 2.0}, {2.0, 3.0}, {1.0, 3.0}});
  EXPECT_NEAR(rim.distance_m, std::sqrt(5.0), 1e-9);
  EXPECT_NEAR(rim.bearing_deg, 26.565, 1e-3);
  EXPECT_NEAR(sight({{-1.0, 2.0}, {-2.0, 2.0}, {-2.0, 3.0}, {-1.0, 3.0}}).bearing_deg, -26.565, 1e-3);
}

TEST(FindNearestRim, DoesNotDependOnTheOrderOfThePoints) {
  const std::vector<Eigen::Vector2d> opening{{0.3, 2.0}, {1.0, 2.6}, {0.4, 3.1}, {-0.2, 2.7}};
  const RimSighting rim = sight(opening);
  EXPECT_NEAR(sight({opening.rbegin(), opening.rend()}).distance_m, rim.distance_m, 1e-12);
  EXPECT_NEAR(sight({opening[2], opening[3], opening[0], opening[1]}).bearing_deg, rim.bearing_deg, 1e-9);
}

TEST(FindNearestRim, MeasuresAHoleWithALevelHeadAlike) {
  std::vector<Eigen::Vector3d> opening{{-0.5, 1.6, 4.5}, {0.5, 1.6, 4.5}, {0.5, 1.6, 5.5}, {-0.5, 1.6, 5.5}};
  const RimSighting rim = find_nearest_rim(opening, kCamera, kSize, {});
  EXPECT_TRUE(rim.visible);
  EXPECT_NEAR(rim.distance_m, 4.5, 1e-9);
}

TEST(FindNearestRim, StopsAtTheEdgeOfThePicture) {
  // A trench along the path, from far behind to far ahead. The lowest row, 359.5, sees the ground in the middle at
  // 1.6 / tan(30 + atan(180/350) degrees) = 1.0305 m; at 0.2 m to the right the row is the same.
  const RimSighting rim = sight({{0.2, -50.0}, {0.2, 50.0}, {1.0, 50.0}, {1.0, -50.0}});
  EXPECT_TRUE(rim.visible);
  EXPECT_NEAR(rim.distance_m, std::hypot(0.2, 1.0305), 0.005);
  EXPECT_NEAR(rim.bearing_deg, std::atan2(0.2, 1.0305) * 180.0 / std::numbers::pi, 0.3);
}

TEST(FindNearestRim, TellsTheNearestPointAtAllWhenNoneIsInView) {
  const RimSighting behind = sight({{-0.5, -3.0}, {0.5, -3.0}, {0.5, -2.0}, {-0.5, -2.0}});
  EXPECT_FALSE(behind.visible);
  EXPECT_NEAR(behind.distance_m, 2.0, 1e-9);
  EXPECT_NEAR(std::abs(behind.bearing_deg), 180.0, 1e-6);
  const RimSighting around = sight({{-0.3, -0.4}, {0.3, -0.4}, {0.3, 0.5}, {-0.3, 0.5}});  // standing over the hole
  EXPECT_FALSE(around.visible);
  EXPECT_NEAR(around.distance_m, 0.3, 1e-9);
}

// Disparities of the ground, with a box of one depth in front of a part of the picture.
cv::Mat1f ground_with_box(const cv::Rect& box, double box_depth) {
  const GroundPlane ground = make_ground_plane(kHeight, 30.0, 0.0, kCamera);
  cv::Mat1f disparity(kSize, 0.0F);
  for (int v = 0; v < kSize.height; ++v) {
    for (int u = 0; u < kSize.width; ++u) disparity(v, u) = static_cast<float>(std::max(0.0, ground.disparity(u, v)));
  }
  disparity(box) = static_cast<float>(kCamera.focal * kCamera.baseline / box_depth);
  return disparity;
}

TEST(FindNearestRim, LooksPastWhatStandsInFront) {
  // The front edge spans 2 m at 3 m ahead: 2.598 + 0.8 = 3.398 m deep, so columns 216.5 to 422.5, row 150.
  const std::vector<Eigen::Vector2d> opening{{-1.0, 3.0}, {1.0, 3.0}, {1.0, 4.0}, {-1.0, 4.0}};
  const RimSighting clear = sight(opening, ground_with_box({0, 0, 1, 1}, 1.0));
  EXPECT_NEAR(clear.distance_m, 3.0, 1e-9);
  // A person stands 2 m away before columns 280 to 369: the nearest end of the rest is left of it, 40.5 px from the middle,
  // -0.393 m at that depth.
  const RimSighting rim = sight(opening, ground_with_box({280, 0, 90, 360}, 2.0));
  EXPECT_TRUE(rim.visible);
  EXPECT_NEAR(rim.bearing_deg, std::atan2(-0.393, 3.0) * 180.0 / std::numbers::pi, 0.3);
  EXPECT_NEAR(rim.distance_m, std::hypot(0.393, 3.0), 0.01);
}

TEST(FindNearestRim, DoesNotMindWhatStandsBehindOrHardlyInFront) {
  const std::vector<Eigen::Vector2d> opening{{-1.0, 3.0}, {1.0, 3.0}, {1.0, 4.0}, {-1.0, 4.0}};
  EXPECT_NEAR(sight(opening, ground_with_box({0, 0, 640, 360}, 3.398 - 0.06)).distance_m, 3.0, 1e-9);  // 2 % are 0.068 m
  EXPECT_FALSE(sight(opening, ground_with_box({0, 0, 640, 360}, 3.398 - 0.08)).visible);
  EXPECT_TRUE(sight(opening, ground_with_box({0, 0, 640, 360}, 20.0)).visible);
  EXPECT_TRUE(sight(opening, cv::Mat1f(kSize, 0.0F)).visible);  // nothing there
}

TEST(FindNearestRim, SeesBetweenThinBars) {
  // Every second column is a bar: in 3x3 pixels there is always one that is free.
  cv::Mat1f disparity = ground_with_box({0, 0, 1, 1}, 1.0);
  for (int u = 0; u < kSize.width; u += 2) disparity.col(u) = 50.0F;
  EXPECT_TRUE(sight({{-1.0, 3.0}, {1.0, 3.0}, {1.0, 4.0}, {-1.0, 4.0}}, disparity).visible);
}

TEST(FindNearestRim, FindsTheSmallestDistanceOfAllPointsInView) {
  // Its twin without any shortcut: every point of the edges, a millimetre apart.
  const cv::Mat1f disparity = ground_with_box({200, 0, 150, 360}, 1.2);
  const std::vector<std::vector<Eigen::Vector2d>> openings{{{-0.6, 2.1}, {0.9, 1.7}, {1.4, 3.0}, {0.0, 3.6}},
                                                           {{-2.0, 1.2}, {0.3, 1.1}, {0.4, 1.5}},
                                                           {{-4.0, 0.5}, {3.0, 1.5}, {6.0, 9.0}, {-6.0, 8.0}}};
  for (const auto& opening : openings) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < opening.size(); ++i) {
      const Eigen::Vector2d along = opening[(i + 1) % opening.size()] - opening[i];
      const int steps = static_cast<int>(along.norm() * 1000.0);
      for (int step = 0; step <= steps; ++step) {
        const Eigen::Vector2d point = opening[i] + along * step / steps;
        const Eigen::Vector3d seen = on_ground({point})[0];
        const Eigen::Vector3d pixel = kCamera.project(seen);
        const int u = static_cast<int>(std::lround(pixel.x()));
        const int v = static_cast<int>(std::lround(pixel.y()));
        if (seen.z() < 0.05 || u < 0 || v < 0 || u >= kSize.width || v >= kSize.height) continue;
        bool is_free = false;
        for (int row = std::max(v - 1, 0); row <= std::min(v + 1, kSize.height - 1); ++row) {
          for (int column = std::max(u - 1, 0); column <= std::min(u + 1, kSize.width - 1); ++column) {
            const double depth = kCamera.focal * kCamera.baseline / disparity(row, column);
            is_free = is_free || depth >= seen.z() - std::max(0.05, 0.02 * seen.z());
          }
        }
        if (is_free) nearest = std::min(nearest, point.norm());
      }
    }
    const RimSighting rim = sight(opening, disparity);
    EXPECT_TRUE(rim.visible);
    EXPECT_NEAR(rim.distance_m, nearest, 0.01);
  }
}

TEST(FindNearestRim, IsDoneAtOnceWithARimOfAThousandKilometres) {
  const RimSighting rim = sight({{-5e5, 3.0}, {5e5, 3.0}, {5e5, 1e6}, {-5e5, 1e6}}, cv::Mat1f(kSize, 300.0F));
  EXPECT_FALSE(rim.visible);
  EXPECT_NEAR(rim.distance_m, 3.0, 1e-6);
}

TEST(FindNearestRim, ComesNearerByNoMoreThanTheStepThatTheCameraWalks) {
  double before = 0.0;
  for (int step = 0; step <= 70; ++step) {  // the whole rim stays in view
    const double ahead = 5.0 - 0.05 * step;
    const RimSighting rim = sight({{-0.4, ahead}, {0.5, ahead + 0.2}, {0.3, ahead + 1.0}, {-0.5, ahead + 0.9}});
    EXPECT_TRUE(rim.visible) << ahead;
    if (step > 0) {
      EXPECT_LT(rim.distance_m, before);
      EXPECT_GE(rim.distance_m, before - 0.05 - 1e-9);
    }
    before = rim.distance_m;
  }
}

TEST(FindNearestRim, RefusesWhatHasNoPlane) {
  const auto fault = [](const std::vector<Eigen::Vector3d>& opening, const cv::Mat1f& disparity = {}) {
    return test::error_of<std::invalid_argument>([&] { find_nearest_rim(opening, kCamera, kSize, disparity); });
  };
  test::expect_line_with(fault({}), "opening of 0 points has no plane");
  test::expect_line_with(fault({{0, 1, 2}, {0, 1, 3}}), "opening of 2 points");
  test::expect_line_with(fault({{0, 1, 2}, {0, 1, 3}, {0, 1, 4}}), "opening of 3 points has no plane");
  test::expect_line_with(fault({{0, 1, 2}, {0, 1, 3}, {std::nan(""), 1, 4}}), "has no plane");
  test::expect_line_with(fault(on_ground({{0, 2}, {1, 2}, {1, 3}}), cv::Mat1f(2, 3, 0.0F)),
                         "disparity is 3x2 px, must be 640x360");
}

// A flat place with one square hole ahead, four steps of 0.25 m towards it; the truth as a simulator would write it.
class WrittenTruth : public testing::Test {
 protected:
  WrittenTruth() {
    SequenceWriter writer(sequence_, "test\n", Existing::refuse);
    writer.write_calibration(kCamera);
    writer.write_times({0.0, 0.1, 0.2, 0.3});
    std::vector<Eigen::Isometry3d> poses;
    for (int frame = 0; frame < 4; ++frame) {
      poses.push_back(camera_from_ground() * Eigen::Translation3d(0.0, 0.0, 0.25 * frame) * camera_from_ground().inverse());
      const cv::Mat1b negative = mask(frame);
      writer.write_truth(frame, ground_with_box({0, 0, 1, 1}, 30.0), negative);
    }
    writer.write_poses(poses);
    writer.write_instances({{7, "manhole", 0.9, on_ground({{-0.3, 3.0}, {0.3, 3.0}, {0.3, 3.6}, {-0.3, 3.6}})},
                            {2, "curb", 0.2, on_ground({{5.0, 30.0}, {6.0, 30.0}, {6.0, 31.0}})}});
    writer.commit();
  }

  // The hole in the picture of a frame, with a corner that nobody labelled.
  static cv::Mat1b mask(int frame) {
    const double ahead = 3.0 - 0.25 * frame;
    std::vector<cv::Point> corners;
    for (const Eigen::Vector3d& point : on_ground({{-0.3, ahead}, {0.3, ahead}, {0.3, ahead + 0.6}, {-0.3, ahead + 0.6}})) {
      const Eigen::Vector3d pixel = kCamera.project(point);
      corners.emplace_back(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
    }
    cv::Mat1b negative(kSize, uchar{0});
    cv::fillPoly(negative, std::vector<std::vector<cv::Point>>{corners}, cv::Scalar(7));
    negative({0, 0, 20, 20}) = kNotLabelled;
    return negative;
  }

  [[nodiscard]] SequenceTruth open() const { return SequenceTruth(sequence_); }
  void replace(const std::string& name, const std::string& bytes) const { (void)folder_.add("sequence/" + name, bytes); }
  [[nodiscard]] std::string path(const std::string& name) const { return sequence_ + "/" + name; }
  [[nodiscard]] std::string fault() const {
    return test::error_of<std::runtime_error>([&] { (void)open(); });
  }
  [[nodiscard]] std::string fault_with(const std::string& name, const std::string& bytes) const {
    replace(name, bytes);
    return fault();
  }
  [[nodiscard]] std::string fault_of_frame(int position) const {
    const SequenceTruth truth = open();
    return test::error_of<std::runtime_error>([&] { (void)truth.read(position); });
  }

 private:
  test::TemporaryFolder folder_;
  std::string sequence_ = folder_ / "sequence";
};

TEST_F(WrittenTruth, TellsEachFrameWithItsInstances) {
  const SequenceTruth truth = open();
  EXPECT_EQ(truth.frames(), (std::vector<int>{0, 1, 2, 3}));
  ASSERT_EQ(truth.instances().size(), 2U);
  EXPECT_EQ(truth.instances()[0].type, "manhole");
  for (int position = 0; position < truth.size(); ++position) {
    const FrameTruth frame = truth.read(position);
    EXPECT_EQ(frame.frame, position);
    EXPECT_NEAR(frame.time, 0.1 * position, 1e-12);
    ASSERT_EQ(frame.instances.size(), 1U);  // the curb is not seen, 255 is no instance
    EXPECT_EQ(frame.instances[0].id, 7);
    EXPECT_EQ(frame.instances[0].visible_px, cv::countNonZero(mask(position) == 7));
    EXPECT_EQ(frame.instances[0].depth_m, 0.9);
    EXPECT_NEAR(frame.instances[0].distance_m.value(), 3.0 - 0.25 * position, 1e-5);
    EXPECT_NEAR(frame.instances[0].bearing_deg.value(), 0.0, 1e-3);
    EXPECT_NEAR(frame.world_from_camera.value().translation().norm(), 0.25 * position, 1e-8);
    EXPECT_EQ(cv::countNonZero(frame.negative != mask(position)), 0);
  }
  EXPECT_THROW((void)truth.read(4), std::out_of_range);
  EXPECT_THROW((void)truth.read(-1), std::out_of_range);
}

TEST_F(WrittenTruth, PutsTheNearestRimAtTheBorderOfTheMask) {
  const SequenceTruth truth = open();
  for (int position = 0; position < truth.size(); ++position) {
    const FrameTruth frame = truth.read(position);
    const double bearing = frame.instances[0].bearing_deg.value() * std::numbers::pi / 180.0;
    const double distance = frame.instances[0].distance_m.value();
    const Eigen::Vector3d pixel = kCamera.project(on_ground({{distance * std::sin(bearing), distance * std::cos(bearing)}})[0]);
    const int u = static_cast<int>(std::lround(pixel.x()));
    const int v = static_cast<int>(std::lround(pixel.y()));
    EXPECT_EQ(frame.negative(v - 2, u), 7);
    EXPECT_EQ(frame.negative(v + 2, u), 0);
  }
}

TEST_F(WrittenTruth, KnowsNoDistanceWithoutPosesOrCalibration) {
  std::filesystem::remove(path("poses.txt"));
  const FrameTruth frame = open().read(1);
  EXPECT_FALSE(frame.world_from_camera.has_value());
  EXPECT_EQ(frame.instances[0].depth_m, 0.9);
  EXPECT_FALSE(frame.instances[0].distance_m.has_value());
  EXPECT_FALSE(frame.instances[0].bearing_deg.has_value());
}

TEST_F(WrittenTruth, KnowsNoDistanceWithoutCalibration) {
  std::filesystem::remove(path("calib.txt"));
  const FrameTruth frame = open().read(1);
  EXPECT_TRUE(frame.world_from_camera.has_value());
  EXPECT_FALSE(frame.instances[0].distance_m.has_value());
}

TEST_F(WrittenTruth, KnowsNeitherDepthNorDistanceWithoutInstances) {
  std::filesystem::remove(path("instances.yaml"));
  const FrameTruth frame = open().read(2);
  ASSERT_EQ(frame.instances.size(), 1U);
  EXPECT_EQ(frame.instances[0].id, 7);
  EXPECT_FALSE(frame.instances[0].depth_m.has_value());
  EXPECT_FALSE(frame.instances[0].distance_m.has_value());
}

TEST_F(WrittenTruth, KnowsNoDistanceOfAnInstanceWithoutARim) {
  replace("instances.yaml", "- {id: 7, type: pothole, depth_m: 0.5}\n");
  const FrameTruth frame = open().read(2);
  EXPECT_EQ(frame.instances[0].depth_m, 0.5);
  EXPECT_FALSE(frame.instances[0].distance_m.has_value());
}

TEST_F(WrittenTruth, TakesTheNumberAsTimeWithoutTimes) {
  std::filesystem::remove(path("times.txt"));
  EXPECT_EQ(open().read(3).time, 3.0);
}

TEST_F(WrittenTruth, ReadsTheFramesThatHaveAMask) {
  std::filesystem::remove(path("negative/000001.png"));
  const SequenceTruth truth = open();
  EXPECT_EQ(truth.frames(), (std::vector<int>{0, 2, 3}));
  EXPECT_NEAR(truth.read(1).time, 0.2, 1e-12);
  EXPECT_NEAR(truth.read(1).instances[0].distance_m.value(), 2.5, 1e-5);
}

TEST_F(WrittenTruth, LooksPastWhatStandsInFrontWhenThereIsDisparity) {
  replace("disparity/000000.png", encode_disparity(ground_with_box({300, 0, 40, 360}, 1.0), DisparityFormat::png));
  EXPECT_GT(open().read(0).instances[0].distance_m.value(), 3.001);
  std::filesystem::remove_all(path("disparity"));
  EXPECT_NEAR(open().read(0).instances[0].distance_m.value(), 3.0, 1e-5);
}

TEST_F(WrittenTruth, RefusesASequenceWithoutMasks) {
  std::filesystem::remove_all(path("negative"));
  test::expect_line_with(fault(), "negative: no such folder, expected masks");
  std::filesystem::create_directory(path("negative"));
  test::expect_line_with(fault(), "negative: holds no masks");
}

TEST_F(WrittenTruth, RefusesMasksThatCannotHoldIds) {
  replace("negative/000001.png", encode_png(cv::Mat3b(kSize)));
  test::expect_line_with(fault_of_frame(1), "000001.png: is a colour picture, expected grey");
  replace("negative/000001.png", encode_png(cv::Mat1w(kSize)));
  test::expect_line_with(fault_of_frame(1), "000001.png: is a 16-bit picture");
  replace("negative/000001.png", encode_png(cv::Mat1b(10, 20, uchar{0})));
  test::expect_line_with(fault_of_frame(1), "000001.png: is 20x10 px, expected 640x360 like the first mask");
  replace("negative/000001.png", encode_png(cv::Mat1b(kSize, uchar{9})));
  test::expect_line_with(fault_of_frame(1), "000001.png: holds id 9, which instances.yaml lacks");
  replace("negative/000001.png", "");
  EXPECT_TRUE(fault_of_frame(1).starts_with(path("negative/000001.png") + ": "));
  std::filesystem::rename(path("negative/000001.png"), path("negative/000001.jpg"));
  test::expect_line_with(fault(), "000001.jpg: expected a PNG");
}

TEST_F(WrittenTruth, RefusesPosesThatContradictTheFrames) {
  const std::string pose = "1 0 0 0 0 1 0 0 0 0 1 0\n";
  test::expect_line_with(fault_with("poses.txt", pose + pose + pose), "has 3 poses, expected one for each frame from 0 to 3");
  test::expect_line_with(fault_with("poses.txt", pose + "1 0 0 nan 0 1 0 0 0 0 1 0\n"), "poses.txt: line 2 number 4 = nan");
  test::expect_line_with(fault_with("poses.txt", "0 0 0 0 0 0 0 1\n"), "poses.txt: has 8 numbers a line, expected 12");
}

TEST_F(WrittenTruth, RefusesOtherFilesThatAreAtFault) {
  test::expect_line_with(fault_with("times.txt", "0\n"), "times.txt: has 1 times");
  std::filesystem::remove(path("times.txt"));
  test::expect_line_with(fault_with("calib.txt", "x"), "calib.txt: is not a calibration");
}

TEST_F(WrittenTruth, RefusesDisparitiesThatContradictTheMasks) {
  replace("disparity/000002.png", encode_disparity(cv::Mat1f(10, 20, 1.0F), DisparityFormat::png));
  test::expect_line_with(fault_of_frame(2), "disparity/000002.png: is 20x10 px, expected 640x360");
  replace("disparity/000002.png", encode_png(cv::Mat1b(kSize)));
  test::expect_line_with(fault_of_frame(2), "000002.png: is a 8-bit picture of 1 channels, expected 16-bit grey");
  std::filesystem::remove(path("disparity/000002.png"));
  test::expect_line_with(fault(), "disparity: has no picture of frame 2, negative/ has");
}

TEST_F(WrittenTruth, NamesWhatIsWrongWithAnInstance) {
  const auto with = [&](const std::string& id, const std::string& type, const std::string& depth, const std::string& opening) {
    return fault_with("instances.yaml",
                      fmt::format("- id: 7\n  type: curb\n  depth_m: 1\n  opening: [[0, 1, 2], [1, 1, 2], [1, 1, 3]]\n"
                                  "- id: {}\n  type: {}\n  depth_m: {}\n  opening: {}\n",
                                  id, type, depth, opening));
  };
  const std::string good = "[[0, 1, 2], [1, 1, 2], [1, 1, 3]]";
  test::expect_line_with(with("7", "curb", "1", good), "instances.yaml: line 5: id = 7 is there already");
  for (const std::string id : {"0", "255", "1.5", "x", "-1"}) {
    test::expect_line_with(with(id, "curb", "1", good), "line 5: id = " + id + ", expected an integer from 1 to 254");
  }
  test::expect_line_with(with("[1]", "curb", "1", good), "line 5: id is missing or no value");
  test::expect_line_with(with("1", "pit", "1", good), "line 5: type = pit, expected one of stairs_down, platform_edge");
  for (const std::string depth : {"0", "-1", ".nan", "inf", "deep"}) {
    test::expect_line_with(with("1", "curb", depth, good), "line 5: depth_m = " + depth + ", expected more than 0");
  }
  test::expect_line_with(with("1", "curb", "1", "3"), "line 5: opening, expected a list of points");
  test::expect_line_with(with("1", "curb", "1", "[[0, 1, 2], [0, 1, .nan]]"),
                         "line 5: opening[1], expected three finite numbers");
  test::expect_line_with(with("1", "curb", "1", "[[0, 1, 2], [0, 1]]"), "line 5: opening[1], expected three finite numbers");
  test::expect_line_with(with("1", "curb", "1", "[[0, 1, 2], [0, 1, 3]]"), "opening of 2 points, expected at least 3");
  test::expect_line_with(with("1", "curb", "1", "[[0, 1, 2], [0, 1, 3], [0, 1, 4]]"),
                         "opening of 3 points, expected at least 3");
}

TEST_F(WrittenTruth, RefusesInstancesThatAreNoList) {
  test::expect_line_with(fault_with("instances.yaml", ""), "instances.yaml: is no list of negative obstacles");
  test::expect_line_with(fault_with("instances.yaml", "id: 1\n"), "instances.yaml: is no list of negative obstacles");
  test::expect_line_with(fault_with("instances.yaml", "- 3\n"), "line 1: expected id, type, depth_m and opening");
  test::expect_line_with(fault_with("instances.yaml", "- id: [1\n"), "instances.yaml: is not YAML: line ");
}

TEST_F(WrittenTruth, TakesAnEmptyListOfInstancesAtItsWord) {
  replace("instances.yaml", "[]\n");
  test::expect_line_with(fault_of_frame(0), "000000.png: holds id 7, which instances.yaml lacks");
}

TEST(SequenceTruth, RefusesAFolderThatIsNotThere) {
  const test::TemporaryFolder folder;
  test::expect_line_with(test::error_of<std::runtime_error>([&] { SequenceTruth{folder / "no"}; }),
                         "no/negative: no such folder");
}

TEST(SequenceTruth, ReadsRealPotholes) {
  BRINK_REQUIRE_DATA(data, "pothole_a");
  const SequenceTruth truth(data);
  EXPECT_EQ(truth.size(), 8);
  ASSERT_EQ(truth.instances().size(), 1U);
  EXPECT_TRUE(truth.instances()[0].opening.empty());  // nobody measured the rim
  for (int position = 0; position < truth.size(); ++position) {
    const FrameTruth frame = truth.read(position);
    ASSERT_EQ(frame.instances.size(), 1U);
    EXPECT_GT(frame.instances[0].visible_px, 1000);
    EXPECT_EQ(frame.instances[0].depth_m, 0.039);
    EXPECT_FALSE(frame.instances[0].distance_m.has_value());
    EXPECT_FALSE(frame.world_from_camera.has_value());
  }
}

}  // namespace
}  // namespace brink
