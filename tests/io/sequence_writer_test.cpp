#include "brink/sequence_writer.hpp"

#include <stdexcept>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "brink/files.hpp"
#include "expect_error.hpp"
#include "temporary_folder.hpp"

namespace brink {
namespace {

using test::TemporaryFolder;

constexpr const char* kRecipe = "made: by a test\n";

TEST(SequenceWriter, StoresDisparitiesTimes256AndNoneAs0) {
  const TemporaryFolder folder;
  SequenceWriter writer(folder / "walk", kRecipe, Existing::refuse);
  EXPECT_FALSE(writer.has_frame(7));
  writer.write_truth(7, (cv::Mat1f(1, 5) << 0.0F, 10.5F, 0.001F, 255.5F, 256.0F), (cv::Mat1b(1, 5) << 0, 1, 254, 255, 0));
  EXPECT_TRUE(writer.has_frame(7));
  writer.commit();
  const cv::Mat1w disparity = cv::imread(folder / "walk/disparity/000007.png", cv::IMREAD_UNCHANGED);
  EXPECT_EQ(cv::norm(disparity, cv::Mat1w((cv::Mat1w(1, 5) << 0, 2688, 1, 65408, 0)), cv::NORM_INF), 0.0);
  const cv::Mat1b negative = cv::imread(folder / "walk/negative/000007.png", cv::IMREAD_UNCHANGED);
  EXPECT_EQ(cv::norm(negative, cv::Mat1b((cv::Mat1b(1, 5) << 0, 1, 254, 255, 0)), cv::NORM_INF), 0.0);
}

TEST(SequenceWriter, WritesTextAsDocumented) {
  const TemporaryFolder folder;
  SequenceWriter writer(folder / "walk", kRecipe, Existing::refuse);
  writer.write_calibration({100.0, 3.5, 2.0, 0.15});
  writer.write_times({0.0, 1.0 / 15.0});
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() << 1.0, -2.0, 0.25;
  writer.write_poses({pose});
  writer.write_imu({{0.005, {1.0, 2.0, 3.0}, {0.0, -kGravity, 0.5}}});
  writer.write_instances({{3, "manhole", 0.75, {{1, 2, 3}, {4, 5, 6}}}});
  writer.commit();
  const auto text = [&](const char* name) { return read_file(folder / (std::string("walk/") + name)); };
  EXPECT_EQ(text("simulation.yaml"), kRecipe);
  EXPECT_EQ(text("calib.txt"),
            "P0: 100 0 3.5 0 0 100 2 0 0 0 1 0\nP1: 100 0 3.5 -15 0 100 2 0 0 0 1 0\n"
            "P2: 100 0 3.5 0 0 100 2 0 0 0 1 0\nP3: 100 0 3.5 -15 0 100 2 0 0 0 1 0\n");
  EXPECT_EQ(text("times.txt"), "0.000000\n0.066667\n");
  EXPECT_EQ(text("poses.txt"),
            "1.000000000 0.000000000 0.000000000 1.000000000 0.000000000 1.000000000 0.000000000 -2.000000000 "
            "0.000000000 0.000000000 1.000000000 0.250000000\n");
  EXPECT_EQ(text("imu.csv"), "t,gx,gy,gz,ax,ay,az\n0.005000,1.0000000,2.0000000,3.0000000,0.000000,-9.810000,0.500000\n");
  EXPECT_EQ(text("instances.yaml"),
            "- id: 3\n  type: manhole\n  depth_m: 0.7500\n  opening:\n"
            "    - [1.000000, 2.000000, 3.000000]\n    - [4.000000, 5.000000, 6.000000]\n");
}

TEST(SequenceWriter, WithoutCommitNothingIsThereUnderItsName) {
  const TemporaryFolder folder;
  {
    const SequenceWriter writer(folder / "walk", kRecipe, Existing::refuse);
    writer.write_instances({});
  }
  EXPECT_FALSE(folder.list().contains("walk"));
  EXPECT_EQ(read_file(folder / "walk.part/instances.yaml"), "[]\n");
}

TEST(SequenceWriter, ReplacesTheOldSequenceOnlyByAWholeNewOne) {
  const TemporaryFolder folder;
  const std::string old = folder.add("walk/simulation.yaml", "old\n");
  SequenceWriter writer(folder / "walk", kRecipe, Existing::replace);
  EXPECT_EQ(read_file(old), "old\n");
  writer.commit();
  EXPECT_EQ(read_file(old), kRecipe);
  for (const std::string& name : folder.list()) EXPECT_EQ(name.find(".part"), std::string::npos) << name;
}

TEST(SequenceWriter, ResumingForgetsFilesThatWereHalfWritten) {
  const TemporaryFolder folder;
  (void)folder.add("walk.part/simulation.yaml", kRecipe);
  (void)folder.add("walk.part/image_2/.000000.png.123.0.part", "half");
  (void)folder.add("walk.part/negative/000000.png", "there");
  SequenceWriter writer(folder / "walk", kRecipe, Existing::resume);
  EXPECT_FALSE(writer.is_complete());
  EXPECT_TRUE(writer.has_frame(0));
  EXPECT_FALSE(folder.list().contains("walk.part/image_2/.000000.png.123.0.part"));
}

TEST(SequenceWriter, NamesTheFirstLineThatDiffersFromTheRecipe) {
  const TemporaryFolder folder;
  (void)folder.add("walk/simulation.yaml", "a: 1\nb: 2\n");
  const auto resume = [&](const char* recipe) {
    return test::error_of<std::runtime_error>([&] { (void)SequenceWriter(folder / "walk", recipe, Existing::resume); });
  };
  test::expect_line_with(resume("a: 1\nb: 3\n"), "walk: cannot be resumed, it was made with \"b: 2\", not \"b: 3\"");
  test::expect_line_with(resume("a: 1\n"), "it was made with \"b: 2\", not \"\"");
  test::expect_line_with(resume("a: 1\nb: 2\nc: 3\n"), "it was made with \"\", not \"c: 3\"");
  EXPECT_TRUE(SequenceWriter(folder / "walk", "a: 1\nb: 2\n", Existing::resume).is_complete());
}

}  // namespace
}  // namespace brink
