#include "brink/trajectory.hpp"

#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "expect_error.hpp"
#include "temporary_folder.hpp"
#include "test_data.hpp"

namespace brink {
namespace {

Trajectory example() {
  Trajectory trajectory;
  for (int i = 0; i < 20; ++i) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() = Eigen::Vector3d(0.1 * i, -0.02 * i, 3.0 * i);
    pose.rotate(Eigen::AngleAxisd(0.4 * i, Eigen::Vector3d(1.0, -2.0, 0.5).normalized()));  // beyond a whole turn
    trajectory.world_from_camera.push_back(pose);
    trajectory.times.push_back(0.25 * i);
  }
  return trajectory;
}

void expect_same_poses(const Trajectory& a, const Trajectory& b) {
  ASSERT_EQ(a.world_from_camera.size(), b.world_from_camera.size());
  for (std::size_t i = 0; i < a.world_from_camera.size(); ++i) {
    EXPECT_LT((a.world_from_camera[i].matrix() - b.world_from_camera[i].matrix()).norm(), 1e-8);
  }
}

Trajectory read_text(const std::string& text) {
  const test::TemporaryFolder folder;
  return read_trajectory(folder.add("poses.txt", text));
}

std::string fault_of(const std::string& text) {
  const test::TemporaryFolder folder;
  const std::string path = folder.add("poses.txt", text);
  const std::string fault = test::error_of<std::runtime_error>([&] { read_trajectory(path); });
  EXPECT_TRUE(fault.starts_with(path + ": ")) << fault;
  return fault;
}

TEST(Trajectory, OfKittiIsReadAsItWasWritten) {
  const Trajectory trajectory = read_text(to_kitti(example()));
  expect_same_poses(trajectory, example());
  EXPECT_TRUE(trajectory.times.empty());
}

TEST(Trajectory, OfTumIsReadAsItWasWritten) {
  const Trajectory trajectory = read_text(to_tum(example()));
  expect_same_poses(trajectory, example());
  EXPECT_EQ(trajectory.times, example().times);
}

TEST(Trajectory, IsWrittenRowByRowForKitti) {
  Trajectory quarter;  // a quarter turn about y
  quarter.world_from_camera.emplace_back(Eigen::Translation3d(1.0, 2.0, 3.5));
  quarter.world_from_camera[0].linear() << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  EXPECT_EQ(to_kitti(quarter),
            "0.000000000 0.000000000 1.000000000 1.000000000 0.000000000 1.000000000 0.000000000 2.000000000 "
            "-1.000000000 0.000000000 0.000000000 3.500000000\n");
}

TEST(Trajectory, IsWrittenWithTheScalarLastForTum) {
  Trajectory half;  // 90 degrees about y
  half.times = {12.5};
  half.world_from_camera.emplace_back(Eigen::Translation3d(1.0, 2.0, 3.5));
  half.world_from_camera[0].linear() << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  EXPECT_EQ(to_tum(half), "12.500000000 1.000000000 2.000000000 3.500000000 0.000000000 0.707106781 0.000000000 0.707106781\n");
}

TEST(Trajectory, WithoutPosesIsAnEmptyText) {
  EXPECT_EQ(to_kitti({}), "");
  EXPECT_EQ(to_tum({}), "");
}

TEST(Trajectory, WithoutTimesIsNoTum) {
  Trajectory trajectory = example();
  trajectory.times.clear();
  test::expect_line_with(test::error_of<std::invalid_argument>([&] { to_tum(trajectory); }),
                         "trajectory has 0 times, must be one for each of its 20 poses");
}

TEST(ReadTrajectory, LeavesOutRemarksAndEmptyLines) {
  const Trajectory trajectory =
      read_text("# timestamp tx ty tz qx qy qz qw\n\n1.0 0 0 0 0 0 0 1\r\n  # more\n 2\t0 0 1e0 0 0 0 -1\n");
  ASSERT_EQ(trajectory.times.size(), 2U);
  EXPECT_EQ(trajectory.world_from_camera[1].translation(), Eigen::Vector3d(0, 0, 1));
}

TEST(ReadTrajectory, MakesRotationsExact) {
  const Trajectory tum = read_text("0 0 0 0 0 0 0 0.5\n");  // a quaternion of another length is the same rotation
  EXPECT_EQ(tum.world_from_camera[0].matrix(), Eigen::Matrix4d::Identity());
  const Eigen::Matrix3d rotation = read_text("1 0.0003 0 0 0 1.0001 0 0 0 0 1 0\n").world_from_camera[0].linear();
  EXPECT_LT((rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).norm(), 1e-14);
}

TEST(ReadTrajectory, RefusesLinesThatAreNeither) {
  test::expect_line_with(fault_of("1 2 3\n"), "line 1 has 3 numbers, expected 12 (KITTI: row-major 3x4) or 8 (TUM:");
  test::expect_line_with(fault_of("# x\n1 0 0 0 0 1 0 0 0 0 1 x\n"), "line 2 number 12 = x, expected a finite number");
  test::expect_line_with(fault_of("1 0 0 nan 0 1 0 0 0 0 1 0\n"), "line 1 number 4 = nan, expected a finite number");
  test::expect_line_with(fault_of("1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0"), "line 2 has 10 numbers");  // cut off
}

TEST(ReadTrajectory, RefusesBothFormatsInOneFile) {
  test::expect_line_with(fault_of("1 0 0 0 0 1 0 0 0 0 1 0\n0 0 0 0 0 0 0 1\n"),
                         "line 2 has 8 numbers, expected 12 like the lines before");
  test::expect_line_with(fault_of("0 0 0 0 0 0 0 1\n1 0 0 0 0 1 0 0 0 0 1 0\n"),
                         "line 2 has 12 numbers, expected 8 like the lines before");
}

TEST(ReadTrajectory, RefusesWhatIsNoMotion) {
  test::expect_line_with(fault_of("1 0 0 0 0 1 0 0 0 0 1.01 0\n"), "line 1 is not a motion, expected columns 1 to 3");
  test::expect_line_with(fault_of("1 0 0 0 0 1 0 0 0 0 -1 0\n"), "line 1 is not a motion");  // a mirror
  test::expect_line_with(fault_of("0 0 0 0 0 0 0 0 0 0 0 0\n"), "line 1 is not a motion");
  test::expect_line_with(fault_of("0 0 0 0 0 0 0 0\n"), "line 1 is not a motion, expected a quaternion");
}

TEST(ReadTrajectory, RefusesTimesThatDoNotIncrease) {
  test::expect_line_with(fault_of("1 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n"), "line 2 time 1, expected more than the one before, 1");
}

TEST(ReadTrajectory, RefusesAFileWithoutPoses) {
  test::expect_line_with(fault_of(""), "holds no poses");
  test::expect_line_with(fault_of("# nothing\n"), "holds no poses");
  EXPECT_THROW(read_trajectory("/no/such/file"), std::runtime_error);
}

TEST(ReadTrajectory, ReadsRealPosesOfKitti) {
  BRINK_REQUIRE_DATA(path, "kitti_straight/poses.txt");
  const Trajectory trajectory = read_trajectory(path);
  EXPECT_EQ(trajectory.world_from_camera.size(), 51U);
  expect_same_poses(read_text(to_kitti(trajectory)), trajectory);
}

}  // namespace
}  // namespace brink
