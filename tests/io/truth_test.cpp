#include "brink/truth.hpp"

#include <cmath>
#include <filesystem>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "brink/pictures.hpp"
#include "brink/sequence_writer.hpp"
#include "expect_error.hpp"
#include "io/rim_scene.hpp"
#include "temporary_folder.hpp"
#include "test_data.hpp"

namespace brink {
namespace {

using test::camera_from_ground;
using test::ground_with_box;
using test::kCamera;
using test::kSize;
using test::on_ground;

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

TEST_F(WrittenTruth, TellsTheOpeningAsTheCameraSeesIt) {
  const FrameTruth frame = open().read(2);  // 0.5 m on
  EXPECT_EQ(frame.camera.value().focal, kCamera.focal);
  const std::vector<Eigen::Vector3d> expected = on_ground({{-0.3, 2.5}, {0.3, 2.5}, {0.3, 3.1}, {-0.3, 3.1}});
  ASSERT_EQ(frame.instances[0].opening.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_LT((frame.instances[0].opening[i] - expected[i]).norm(), 1e-5) << i;
  }
}

TEST_F(WrittenTruth, LocatesTheRimsOfAllInstancesSeenOrNot) {
  const FrameTruth frame = open().read(2);  // 0.5 m on
  ASSERT_EQ(frame.rims.size(), 2U);
  EXPECT_EQ(frame.rims[0].id, 7);
  EXPECT_EQ(frame.rims[0].depth_m, 0.9);
  EXPECT_NEAR(frame.rims[0].distance_m, 2.5, 1e-5);
  EXPECT_NEAR(frame.rims[0].height_m, 1.6, 1e-5);
  EXPECT_EQ(frame.rims[1].id, 2);  // the curb, which no frame shows
  EXPECT_NEAR(frame.rims[1].distance_m, std::hypot(5.0, 29.5), 1e-4);
}

TEST_F(WrittenTruth, LocatesTheRimsOfFramesThatShowNone) {
  replace("negative/000001.png", encode_png(cv::Mat1b(kSize, uchar{0})));
  const FrameTruth frame = open().read(1);
  EXPECT_TRUE(frame.instances.empty());
  EXPECT_EQ(frame.rims.size(), 2U);
}

TEST_F(WrittenTruth, LocatesNoRimsWithoutPosesOrOpenings) {
  replace("instances.yaml", "- {id: 7, type: pothole, depth_m: 0.5}\n");
  EXPECT_TRUE(open().read(1).rims.empty());
  std::filesystem::remove(path("poses.txt"));
  EXPECT_TRUE(open().read(1).rims.empty());
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
  EXPECT_FALSE(frame.camera.has_value());
  EXPECT_TRUE(frame.instances[0].opening.empty());
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

TEST_F(WrittenTruth, KnowsTheKindOfEveryType) {
  const std::vector<std::pair<std::string, ObstacleKind>> kinds{{"stairs_down", ObstacleKind::stairs_down},
                                                                {"platform_edge", ObstacleKind::edge},
                                                                {"curb", ObstacleKind::edge},
                                                                {"manhole", ObstacleKind::hole},
                                                                {"trench", ObstacleKind::hole},
                                                                {"pothole", ObstacleKind::hole},
                                                                {"lower_ground", ObstacleKind::hole}};
  for (const auto& [type, kind] : kinds) {
    replace("instances.yaml", "- {id: 7, type: " + type + ", depth_m: 0.5}\n");
    EXPECT_EQ(open().read(0).instances[0].kind, kind) << type;
  }
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
