#include "brink/camera.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "expect_error.hpp"

namespace brink {
namespace {

// f b = 60 px m: a disparity of 20 px is 3 m away.
const StereoCamera kCamera{400.0, 320.0, 180.0, 0.15};

TEST(StereoCamera, TriangulatesACaseWorkedByHand) {
  const Eigen::Vector3d point = kCamera.triangulate(420.0, 80.0, 20.0);
  EXPECT_DOUBLE_EQ(point.x(), 0.75);   // 100 px / 400 px * 3 m
  EXPECT_DOUBLE_EQ(point.y(), -0.75);  // above the axis: y points down
  EXPECT_DOUBLE_EQ(point.z(), 3.0);
}

TEST(StereoCamera, ProjectsWhatItTriangulated) {
  for (const Eigen::Vector3d& pixel :
       {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(639, 359, 0.1), Eigen::Vector3d(17.5, 211.25, 63)}) {
    const Eigen::Vector3d again = kCamera.project(kCamera.triangulate(pixel.x(), pixel.y(), pixel.z()));
    EXPECT_NEAR((again - pixel).norm(), 0.0, 1e-9) << pixel.transpose();
  }
}

TEST(StereoCamera, PutsADisparityOfZeroAtInfinity) { EXPECT_TRUE(std::isinf(kCamera.triangulate(321.0, 181.0, 0.0).z())); }

TEST(StereoCamera, RefusesNumbersThatAreNoCamera) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const auto message = [](const StereoCamera& camera) {
    return test::error_of<std::invalid_argument>([&camera] { camera.validate(); });
  };
  EXPECT_NO_THROW(kCamera.validate());
  test::expect_line_with(message({0.0, 320.0, 180.0, 0.15}), "camera focal = 0, must be");
  test::expect_line_with(message({nan, 320.0, 180.0, 0.15}), "camera focal = nan, must be");
  test::expect_line_with(message({400.0, nan, 180.0, 0.15}), "camera cx = nan, must be");
  test::expect_line_with(message({400.0, 320.0, infinity, 0.15}), "camera cy = inf, must be");
  test::expect_line_with(message({400.0, 320.0, 180.0, -0.15}), "camera baseline = -0.15, must be");
  test::expect_line_with(message({400.0, 320.0, 180.0, 150.0}), "camera baseline = 150, must be");
}

}  // namespace
}  // namespace brink
