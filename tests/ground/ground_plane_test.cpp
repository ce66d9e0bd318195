#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "brink/ground.hpp"
#include "ground/elevation_simd.hpp"
#include "reference/elevation.hpp"
#include "simd_targets.hpp"
#include "synthetic_scene.hpp"

namespace brink {
namespace {

TEST(GroundPlane, LevelCameraAtOneMetreIsTheClassicVDisparityLine) {
  // By hand: N = (0, b f, b cy + c) must point along y, so c = -b cy; height = f B / (b f) = B / b.
  const StereoCamera camera{100.0, 50.0, 40.0, 0.2};
  const GroundPose pose = compute_ground_pose({0.0, 0.2, -8.0}, camera);
  EXPECT_NEAR(pose.height_m, 1.0, 1e-12);
  EXPECT_NEAR(pose.pitch_deg, 0.0, 1e-12);
  EXPECT_NEAR(pose.roll_deg, 0.0, 1e-12);
  EXPECT_TRUE(pose.down.isApprox(Eigen::Vector3d(0.0, 1.0, 0.0)));
  EXPECT_TRUE(pose.forward.isApprox(Eigen::Vector3d(0.0, 0.0, 1.0)));
  EXPECT_TRUE(pose.right.isApprox(Eigen::Vector3d(1.0, 0.0, 0.0)));
}

TEST(GroundPlane, PoseAndPlaneAreInverse) {
  const StereoCamera camera = test::half_size_camera();
  for (const double height : {0.3, 1.6, 2.5}) {
    for (const double pitch : {-10.0, 0.0, 25.0, 60.0}) {
      for (const double roll : {-25.0, 0.0, 10.0}) {
        const GroundPose pose = compute_ground_pose(make_ground_plane(height, pitch, roll, camera), camera);
        EXPECT_NEAR(pose.height_m, height, 1e-9);
        EXPECT_NEAR(pose.pitch_deg, pitch, 1e-9);
        EXPECT_NEAR(pose.roll_deg, roll, 1e-9);
      }
    }
  }
}

TEST(GroundPlane, HeadTiltedToTheRightHasPositiveRoll) {
  const StereoCamera camera = test::half_size_camera();
  const GroundPlane plane = make_ground_plane(1.6, 25.0, 10.0, camera);
  // Tilting the head to the right turns the picture's right side towards the ground, which is nearer there.
  EXPECT_GT(plane.disparity(600, 300), plane.disparity(40, 300));
}

TEST(GroundPlane, ExampleOfTheFileFormatIsConsistent) {
  // docs/formats.md: rim_nearest (0.41, 0.66, 2.47) under height 1.64, pitch 24.9 lies 2.00 m away at 11.7 degrees.
  const StereoCamera camera = test::half_size_camera();
  const GroundPose pose = compute_ground_pose(make_ground_plane(1.64, 24.9, 0.0, camera), camera);
  const Eigen::Vector3d rim(0.41, 0.66, 2.47);
  EXPECT_NEAR(pose.elevation(rim), 0.0, 0.005);
  EXPECT_NEAR(pose.distance(rim), 2.00, 0.006);
  EXPECT_NEAR(pose.bearing_deg(rim), 11.7, 0.15);
}

TEST(GroundPlane, RayThroughAPixelMeetsTheGroundWhereItsDisparitySays) {
  const StereoCamera camera = test::half_size_camera();
  const GroundPlane plane = make_ground_plane(1.5, 20.0, -7.0, camera);
  const GroundPose pose = compute_ground_pose(plane, camera);
  const auto point = pose.intersect(500.0, 300.0, camera);
  ASSERT_TRUE(point);
  EXPECT_TRUE(point->isApprox(camera.triangulate(500.0, 300.0, plane.disparity(500.0, 300.0)), 1e-9));
  EXPECT_NEAR(pose.elevation(*point), 0.0, 1e-9);
  EXPECT_FALSE(pose.intersect(320.0, -10000.0, camera)) << "above the horizon";
}

TEST(GroundMotion, MovesAPointOfTheGroundToItself) {
  const StereoCamera camera = test::half_size_camera();
  const auto pose = [&](double height, double pitch, double roll) {
    return compute_ground_pose(make_ground_plane(height, pitch, roll, camera), camera);
  };
  const GroundPose before = pose(1.5, 20.0, -7.0);
  const GroundPose after = pose(1.7, 31.0, 4.0);
  const Eigen::Isometry3d motion = compute_ground_motion(before, after);
  for (const auto& [ahead, aside] : {std::pair(2.0, 0.0), std::pair(3.0, -1.0)}) {
    const Eigen::Vector3d point = before.height_m * before.down + ahead * before.forward + aside * before.right;
    EXPECT_TRUE((motion * point).isApprox(after.height_m * after.down + ahead * after.forward + aside * after.right, 1e-9));
  }
  EXPECT_NEAR(motion.linear().determinant(), 1.0, 1e-12);
  EXPECT_TRUE(compute_ground_motion(before, before).isApprox(Eigen::Isometry3d::Identity(), 1e-12));
}

TEST(GroundMotion, OfALevelCameraThatRisesIsDown) {
  // By hand: y points down; from 1 m to 1.2 m everything is 0.2 m farther down.
  const StereoCamera camera{100.0, 50.0, 40.0, 0.2};
  const auto motion = compute_ground_motion(compute_ground_pose(make_ground_plane(1.0, 0.0, 0.0, camera), camera),
                                            compute_ground_pose(make_ground_plane(1.2, 0.0, 0.0, camera), camera));
  EXPECT_TRUE(motion.linear().isApprox(Eigen::Matrix3d::Identity(), 1e-12));
  EXPECT_TRUE(motion.translation().isApprox(Eigen::Vector3d(0.0, 0.2, 0.0), 1e-9));
}

TEST(GroundPlane, LookingStraightDownHasAForwardDirection) {
  const StereoCamera camera = test::half_size_camera();
  const GroundPose pose = compute_ground_pose({0.0, 0.0, 50.0}, camera);
  EXPECT_NEAR(pose.pitch_deg, 90.0, 1e-9);
  EXPECT_TRUE(pose.forward.isApprox(Eigen::Vector3d(0.0, -1.0, 0.0)));
}

TEST(GroundPlane, ImpossiblePlanesAreRefused) {
  const StereoCamera camera = test::half_size_camera();
  EXPECT_THROW(compute_ground_pose({0.0, 0.0, 0.0}, camera), std::invalid_argument);
  EXPECT_THROW(compute_ground_pose({std::nan(""), 0.1, 0.0}, camera), std::invalid_argument);
  EXPECT_THROW(make_ground_plane(0.0, 0.0, 0.0, camera), std::invalid_argument);
}

TEST(Elevation, IsTheHeightOfTheTriangulatedPoint) {
  const StereoCamera camera = test::half_size_camera();
  const GroundPlane plane = make_ground_plane(1.6, 25.0, 5.0, camera);
  const GroundPose pose = compute_ground_pose(plane, camera);
  cv::Mat1f disparity(37, 41);
  cv::randu(disparity, 1.0F, 100.0F);
  const cv::Mat1f elevation = compute_elevation(disparity, plane, camera);
  for (int v = 0; v < disparity.rows; ++v) {
    for (int u = 0; u < disparity.cols; ++u) {
      const double expected = pose.elevation(camera.triangulate(u, v, disparity(v, u)));
      EXPECT_NEAR(elevation(v, u), expected, 1e-4 * std::max(1.0, std::abs(expected)));
    }
  }
}

TEST(Elevation, IsNanWhereThereIsNoDisparity) {
  const StereoCamera camera = test::half_size_camera();
  const GroundPlane plane = make_ground_plane(1.6, 25.0, 0.0, camera);
  const cv::Mat1f elevation = compute_elevation((cv::Mat1f(1, 3) << kInvalidDisparity, 0.0F, 10.0F), plane, camera);
  EXPECT_TRUE(std::isnan(elevation(0, 0)));
  EXPECT_TRUE(std::isnan(elevation(0, 1)));
  EXPECT_FALSE(std::isnan(elevation(0, 2)));
  EXPECT_TRUE(compute_elevation(cv::Mat1f(), plane, camera).empty());
}

TEST(Elevation, EqualsItsTwinOnEveryTarget) {
  cv::RNG random(5);
  for (const int width : {1, 3, 8, 67}) {
    std::vector<float> disparity(static_cast<std::size_t>(width), kInvalidDisparity);
    for (std::size_t u = 0; u < disparity.size(); ++u) {
      if (u % 5 != 0) disparity[u] = random.uniform(0.0F, 60.0F);
    }
    const std::vector<float> expected = reference::naive_elevation_row(disparity, 1.62F, 21.3F, -0.031F);
    test::for_each_target([&] {
      std::vector<float> elevation(disparity.size());
      compute_elevation_row(disparity.data(), width, 1.62F, 21.3F, -0.031F, elevation.data());
      for (std::size_t u = 0; u < elevation.size(); ++u) {
        EXPECT_TRUE(elevation[u] == expected[u] || (std::isnan(elevation[u]) && std::isnan(expected[u]))) << u;
      }
    });
  }
}

}  // namespace
}  // namespace brink
