#include "brink/sim/render.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>
#include <tbb/global_control.h>

#include "brink/ground.hpp"
#include "expect_error.hpp"
#include "sim/small_scenes.hpp"

namespace brink::sim {
namespace {

using test::make_camera;
using test::make_pose;
using test::standing;

Scene make_scene(const Material& material) {
  Scene scene;
  scene.materials = {material, {}};
  scene.light.to_sun = Eigen::Vector3f::UnitZ();
  return scene;
}

Scene make_plain_scene() { return make_scene({.pattern = Pattern::plain, .color = {0.5F, 0.5F, 0.5F}}); }

Scene make_asphalt() {
  Scene scene = make_scene({Pattern::asphalt, {0.10F, 0.10F, 0.10F}, {0.25F, 0.25F, 0.25F}, 0.012F});
  scene.meshes.push_back(test::make_floor(-100.0F, 100.0F, -100.0F, 100.0F, 0.0F));
  return scene;
}

cv::Mat3f render_left(const Scene& scene, const StereoCamera& camera, const cv::Size& size, const Eigen::Isometry3d& pose,
                      const RenderParams& params = {}) {
  return Renderer(scene).render(camera, size, standing(pose), 0.0, 0, params, 1);
}

bool are_equal(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && a.isContinuous() && b.isContinuous() &&
         std::memcmp(a.data, b.data, a.total() * a.elemSize()) == 0;
}

/// Mean of the green channel around a point of the ground that is seen by the camera.
double radiance_at(const cv::Mat3f& picture, const StereoCamera& camera, const Eigen::Isometry3d& pose,
                   const Eigen::Vector3d& point) {
  const Eigen::Vector3d uv = camera.project(pose.inverse() * point);
  const int u = static_cast<int>(std::lround(uv.x()));
  const int v = static_cast<int>(std::lround(uv.y()));
  return cv::mean(picture(cv::Rect(u - 1, v - 1, 3, 3)))[1];
}

TEST(Trace, PlaneHasTheDisparitiesOfTheGroundPlane) {
  Scene scene = make_plain_scene();
  scene.meshes.push_back(test::make_floor(-500.0F, 500.0F, -500.0F, 500.0F, 0.0F));
  const StereoCamera camera = make_camera(321, 181, 175.0);
  Renderer renderer(scene);
  for (const double roll : {-12.0, 0.0, 5.0}) {
    const Truth truth = renderer.trace(camera, {321, 181}, make_pose(1.62, 25.0, roll), 0.0);
    const GroundPlane plane = make_ground_plane(1.62, 25.0, roll, camera);
    int ground = 0;
    for (int v = 0; v < 181; ++v) {
      for (int u = 0; u < 321; ++u) {
        const double expected = plane.disparity(u, v);
        if (expected < 0.1) continue;
        ASSERT_NEAR(truth.disparity(v, u), expected, 1e-3) << u << ", " << v << ", roll " << roll;
        ASSERT_EQ(truth.obstacle(v, u), 0);
        ++ground;
      }
    }
    EXPECT_GT(ground, 321 * 181 / 2);
  }
}

TEST(Trace, StepDownIsWhereItIsByHand) {
  // A camera 1.5 m high that looks straight ahead; ground to x = 3, then 1 m lower. The row of the edge is f 1.5 / 3 below the
  // middle; just above it the ray comes down at x = 3 (1 + 1 / 1.5) = 5 on the lower ground.
  Scene scene = make_plain_scene();
  scene.meshes.push_back(test::make_floor(-50.0F, 3.0F, -50.0F, 50.0F, 0.0F));
  scene.meshes.push_back(test::make_floor(3.0F, 50.0F, -50.0F, 50.0F, -1.0F, 0, 7));
  scene.meshes.push_back(test::make_quad({3.0F, -50.0F, -1.0F}, {0.0F, 100.0F, 0.0F}, {0.0F, 0.0F, 1.0F}, 0, 7));
  scene.instances.push_back({7, "platform_edge", 1.0, {{3, -50, 0}, {3, 50, 0}, {50, 50, 0}, {50, -50, 0}}});
  const StereoCamera camera{100.0, 20.0, 20.5, 0.15};
  const Truth truth = Renderer(scene).trace(camera, {41, 101}, make_pose(1.5, 0.0), 0.0);
  for (int u = 0; u < 41; ++u) {
    // Row 71 is 50.5 below the middle: depth 150 / 50.5 on the ground. Row 70 is 49.5 below: 250 / 49.5 on the lower ground.
    EXPECT_NEAR(truth.disparity(71, u), 100.0 * 0.15 * 50.5 / 150.0, 1e-3);
    EXPECT_NEAR(truth.disparity(70, u), 100.0 * 0.15 * 49.5 / 250.0, 1e-3);
    EXPECT_EQ(truth.obstacle(71, u), 0);
    EXPECT_EQ(truth.obstacle(70, u), 7);
  }
}

TEST(Trace, BoxSeenThroughAPinholeIsWhereItIsByHand) {
  // A screen 2 m ahead with an opening of 0.2 x 0.1 m, a wall 5 m ahead. Focal length 200: the opening covers 20 x 10 px.
  Scene scene = make_plain_scene();
  const float far = 9.0F;
  scene.meshes.push_back(test::make_quad({2.0F, 0.1F, -far}, {0, far, 0}, {0, 0, 2 * far}));
  scene.meshes.push_back(test::make_quad({2.0F, -0.1F - far, -far}, {0, far, 0}, {0, 0, 2 * far}));
  scene.meshes.push_back(test::make_quad({2.0F, -0.1F, 0.05F}, {0, 0.2F, 0}, {0, 0, far}));
  scene.meshes.push_back(test::make_quad({2.0F, -0.1F, -0.05F - far}, {0, 0.2F, 0}, {0, 0, far}));
  scene.meshes.push_back(test::make_quad({5.0F, -far, -far}, {0, 2 * far, 0}, {0, 0, 2 * far}));
  const StereoCamera camera{200.0, 31.5, 23.5, 0.15};
  const Truth truth = Renderer(scene).trace(camera, {64, 48}, make_pose(0.0, 0.0), 0.0);
  for (int v = 0; v < 48; ++v) {
    for (int u = 0; u < 64; ++u) {
      const bool through = std::abs(u - 31.5) < 10.0 && std::abs(v - 23.5) < 5.0;
      ASSERT_NEAR(truth.disparity(v, u), 200.0 * 0.15 / (through ? 5.0 : 2.0), 1e-3) << u << ", " << v;
    }
  }
}

TEST(Trace, EmptySceneHasNoDisparity) {
  Renderer renderer(make_plain_scene());
  const Truth truth = renderer.trace(make_camera(33, 17, 20.0), {33, 17}, make_pose(1.6, 20.0), 0.0);
  EXPECT_EQ(cv::countNonZero(truth.disparity), 0);
  EXPECT_EQ(cv::countNonZero(truth.obstacle), 0);
}

TEST(Trace, MovingBodyIsWhereItsVelocityBringsIt) {
  Scene scene = make_plain_scene();
  scene.bodies = {{{0.5F, 1.0F, 0.0F}}};
  scene.meshes.push_back(test::make_quad({4.0F, -0.5F, -0.5F}, {0, 1, 0}, {0, 0, 1}));
  scene.meshes.back().body = 0;
  const StereoCamera camera{100.0, 60.0, 20.0, 0.2};
  Renderer renderer(scene);
  for (const double time : {0.0, 1.0, 2.0, 0.5}) {
    const Truth truth = renderer.trace(camera, {121, 41}, make_pose(0.0, 0.0), time);
    const double x = 4.0 + 0.5 * time;
    const double middle = 60.0 - 100.0 * time / x;  // y is to the left
    for (int u = 0; u < 121; ++u) {
      const double off = std::abs(u - middle) - 50.0 / x;
      if (std::abs(off) < 1e-3) continue;
      ASSERT_NEAR(truth.disparity(20, u), off < 0.0 ? 20.0 / x : 0.0, 1e-3) << "u " << u << " at " << time;
    }
  }
}

TEST(GroundHeight, IsThatOfTheHighestSurfaceWithinReach) {
  Scene scene = make_plain_scene();
  scene.bodies = {{}};
  scene.meshes.push_back(test::make_floor(-5.0F, 5.0F, -5.0F, 5.0F, 0.25F));
  scene.meshes.push_back(test::make_floor(-5.0F, 0.0F, -5.0F, 5.0F, 0.5F));
  scene.meshes.push_back(test::make_quad({-5.0F, 10.0F, 0.0F}, {10.0F, 0.0F, 1.0F}, {0.0F, 10.0F, 0.0F}));
  scene.meshes.push_back(test::make_floor(-5.0F, 5.0F, -5.0F, 5.0F, 0.3F));
  scene.meshes.back().body = 0;
  const Renderer renderer(scene);
  EXPECT_NEAR(renderer.ground_height(1.0, 1.0, 0.0), 0.25, 1e-9);
  EXPECT_NEAR(renderer.ground_height(-1.0, 1.0, 0.0), 0.5, 1e-9);
  EXPECT_NEAR(renderer.ground_height(-1.0, 1.0, -0.2), 0.25, 1e-9) << "the upper one is more than 0.6 m above";
  EXPECT_NEAR(renderer.ground_height(2.0, 15.0, 0.4), 0.7, 1e-6) << "a ramp of 1 in 10";
  EXPECT_TRUE(std::isnan(renderer.ground_height(1.0, 1.0, 3.3))) << "more than 3 m below";
  EXPECT_TRUE(std::isnan(renderer.ground_height(100.0, 1.0, 0.0)));
}

TEST(Render, PlainGroundUnderAnEvenSkyHasTheRadianceOfItsReflectance) {
  // Radiance r E / pi with E = pi (a free horizontal surface under sky 1): r. With the sun in the zenith: r (1 + sun / pi).
  Scene scene = make_plain_scene();
  scene.meshes.push_back(test::make_floor(-500.0F, 500.0F, -500.0F, 500.0F, 0.0F));
  const StereoCamera camera = make_camera(40, 40, 60.0);
  const cv::Mat3f overcast = render_left(scene, camera, {40, 40}, make_pose(1.5, 60.0));
  EXPECT_NEAR(cv::mean(overcast)[1], 0.5, 0.005);
  scene.light.sun = {10.0F, 10.0F, 10.0F};
  const cv::Mat3f sunny = render_left(scene, camera, {40, 40}, make_pose(1.5, 60.0));
  EXPECT_NEAR(cv::mean(sunny)[1], 0.5 * (1.0 + 10.0 / 3.14159265), 0.03);
}

TEST(Render, EmptySceneShowsASkyThatChangesFromTheHorizonUp) {
  const cv::Mat3f picture = render_left(make_plain_scene(), make_camera(64, 64, 50.0), {64, 64}, make_pose(1.5, 0.0));
  EXPECT_GT(picture(0, 32)[1], 1.1F * picture(28, 32)[1]) << "an overcast sky is brighter in the zenith";
  EXPECT_LT(picture(63, 32)[1], 0.5F * picture(28, 32)[1]) << "below the horizon is far ground";
}

TEST(Render, SmallAndOddSizesWork) {
  const Scene scene = make_asphalt();
  Renderer renderer(scene);
  for (const cv::Size size : {cv::Size(0, 0), cv::Size(1, 1), cv::Size(3, 5), cv::Size(67, 9)}) {
    RenderParams params;
    params.samples = 3;
    const StereoCamera camera = make_camera(size.width, size.height, 50.0);
    const cv::Mat3f picture = renderer.render(camera, size, standing(make_pose(1.5, 40.0)), 0.0, 1, params, 1);
    ASSERT_EQ(picture.size(), size);
    ASSERT_TRUE(cv::checkRange(picture));
    EXPECT_TRUE(size.empty() || cv::mean(picture)[0] > 0.02);
  }
}

TEST(Render, ShadowOfAWallEndsWhereTheSunsElevationSays) {
  // A wall 1 m high at x = 4 with the sun behind it at 45 degrees: shadow from x = 3 to x = 4, half of the disc at 3.
  Scene scene = make_plain_scene();
  scene.light.to_sun = Eigen::Vector3f(1.0F, 0.0F, 1.0F).normalized();
  scene.light.sun = {15.0F, 15.0F, 15.0F};
  scene.light.sky = {0.01F, 0.01F, 0.01F};
  scene.meshes.push_back(test::make_floor(-50.0F, 50.0F, -50.0F, 50.0F, 0.0F));
  scene.meshes.push_back(test::make_quad({4.0F, -50.0F, 0.0F}, {0, 100, 0}, {0, 0, 1}));
  const StereoCamera camera = make_camera(200, 400, 700.0);
  const Eigen::Isometry3d pose = make_pose(2.0, 33.7);  // looks at x = 3
  const cv::Mat3f picture = render_left(scene, camera, {200, 400}, pose);
  const double lit = radiance_at(picture, camera, pose, {2.97, 0.0, 0.0});
  EXPECT_NEAR(lit, 0.5 * 15.0 * std::sqrt(0.5) / 3.14159265, 0.03 * lit);
  EXPECT_LT(radiance_at(picture, camera, pose, {3.03, 0.0, 0.0}), 0.05 * lit);
  const double edge = camera.project(pose.inverse() * Eigen::Vector3d(3.0, 0.0, 0.0)).y();
  const int row = static_cast<int>(edge);
  const double share = edge - row;
  const double half = (1.0 - share) * cv::mean(picture.row(row))[1] + share * cv::mean(picture.row(row + 1))[1];
  EXPECT_NEAR(half / lit, 0.5, 0.1);
}

TEST(Render, WiderSunMakesSofterShadowEdges) {
  const auto count_soft_rows = [](float radius_deg) {
    Scene scene = make_plain_scene();
    scene.light.to_sun = Eigen::Vector3f(1.0F, 0.0F, 1.0F).normalized();
    scene.light.sun = {15.0F, 15.0F, 15.0F};
    scene.light.sky = {0.01F, 0.01F, 0.01F};
    scene.light.sun_radius_deg = radius_deg;
    scene.meshes.push_back(test::make_floor(-50.0F, 50.0F, -50.0F, 50.0F, 0.0F));
    scene.meshes.push_back(test::make_quad({4.0F, -50.0F, 0.0F}, {0, 100, 0}, {0, 0, 1}));
    const cv::Mat3f picture = render_left(scene, make_camera(64, 300, 700.0), {64, 300}, make_pose(2.0, 33.7));
    int rows = 0;
    for (int v = 0; v < 300; ++v) {
      const double share = cv::mean(picture.row(v))[1] / 1.688;  // of 0.5 x 15 x sqrt(0.5) / pi
      rows += share > 0.1 && share < 0.9 ? 1 : 0;
    }
    return rows;
  };
  const int sharp = count_soft_rows(0.27F);
  const int hazy = count_soft_rows(1.5F);
  EXPECT_GE(sharp, 1);
  EXPECT_GT(hazy, 3 * sharp);
}

/// Mean radiance of the floor of a hole of 0.6 x 0.6 m under an overcast sky, seen from right above.
double floor_radiance(float depth) {
  Scene scene = make_plain_scene();
  test::add_ground_with_hole(scene, -0.3F, 0.3F, -0.3F, 0.3F, depth, 0, 0);
  const double focal = 40.0 * (1.5 + depth) / 0.6;
  RenderParams params;
  params.sky_rays = 64;
  const cv::Mat3f picture = render_left(scene, make_camera(32, 32, focal), {32, 32}, make_pose(1.5, 90.0), params);
  return cv::mean(picture(cv::Rect(12, 12, 8, 8)))[1];
}

TEST(Render, DeepHoleIsDarkerThanAShallowOneAndNearlyBlack) {
  const double open = 0.5;  // radiance of the ground around it
  const double shallow = floor_radiance(0.1F);
  const double middle = floor_radiance(0.6F);
  const double deep = floor_radiance(3.0F);
  EXPECT_GT(shallow, 0.7 * open);
  EXPECT_LT(middle, 0.6 * shallow);
  EXPECT_LT(deep, 0.06 * open);
  EXPECT_GT(deep, 0.0);
}

TEST(Render, FloorOfADeepHoleSeesAsMuchSkyAsItsOpeningCovers) {
  // Without bounces (black walls) the floor's middle gets the form factor of the opening: for a square of half side a at
  // distance h, F = 4 / pi * a / sqrt(a^2 + h^2) * atan(a / sqrt(a^2 + h^2)); the overcast sky's zenith is 9 / 7 of its mean.
  Scene scene = make_plain_scene();
  scene.materials.push_back({.pattern = Pattern::plain, .color = {0.0F, 0.0F, 0.0F}});
  test::add_ground_with_hole(scene, -0.3F, 0.3F, -0.3F, 0.3F, 1.5F, 0, 2);
  for (Mesh& mesh : scene.meshes) {
    if (mesh.vertices[0].z() < -1.0F && mesh.vertices[2].z() < -1.0F) mesh.material = 0;  // the floor
  }
  RenderParams params;
  params.sky_rays = 64;
  const cv::Mat3f picture = render_left(scene, make_camera(32, 32, 200.0), {32, 32}, make_pose(1.5, 90.0), params);
  const double side = std::sqrt(0.3 * 0.3 + 1.5 * 1.5);
  const double expected = 0.5 * 9.0 / 7.0 * 4.0 / 3.14159265 * 0.3 / side * std::atan(0.3 / side);
  EXPECT_NEAR(cv::mean(picture(cv::Rect(12, 12, 8, 8)))[1], expected, 0.15 * expected);
}

TEST(Render, ShutterBlursAlongTheMotionOnly) {
  const auto roughness = [](const cv::Mat3f& picture, int dx, int dy) {
    const cv::Rect first(0, 0, picture.cols - dx, picture.rows - dy);
    return cv::norm(picture(first), picture(first + cv::Point(dx, dy)), cv::NORM_L1);
  };
  const StereoCamera camera = make_camera(80, 60, 400.0);
  const CameraMotion motion = [](double time) {
    Eigen::Isometry3d pose = make_pose(2.0, 90.0);
    pose.translation().y() -= time;  // 1 m/s along the rows: 10 px in 0.05 s
    return pose;
  };
  RenderParams params;
  params.samples = 64;
  Renderer renderer(make_asphalt());
  const cv::Mat3f sharp = renderer.render(camera, {80, 60}, motion, 0.0, 0, params, 1);
  params.shutter_s = 0.05;
  const cv::Mat3f blurred = renderer.render(camera, {80, 60}, motion, 0.0, 0, params, 1);
  EXPECT_LT(roughness(blurred, 1, 0), 0.45 * roughness(sharp, 1, 0));
  EXPECT_GT(roughness(blurred, 0, 1), 1.5 * roughness(blurred, 1, 0));
}

TEST(Render, BytesAreEqualFromRunToRunAndForAnyNumberOfThreads) {
  const Scene scene = test::make_street(0.8F);
  const StereoCamera camera = make_camera(161, 91, 90.0);
  const CameraMotion motion = [](double time) {
    Eigen::Isometry3d pose = make_pose(1.6, 25.0, 2.0);
    pose.translation().x() += 1.2 * time;
    return pose;
  };
  RenderParams params;
  params.shutter_s = 0.01;
  const auto render_with = [&](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return Renderer(scene).render(camera, {161, 91}, motion, 0.3, 1, params, 5);
  };
  const cv::Mat3f one = render_with(1);
  EXPECT_TRUE(are_equal(one, render_with(2)));
  EXPECT_TRUE(are_equal(one, render_with(2)));
  EXPECT_TRUE(are_equal(one, render_with(1)));
}

TEST(Render, SeedChangesTheSamplesButNotTheScene) {
  Renderer renderer(make_asphalt());
  const StereoCamera camera = make_camera(80, 60, 100.0);
  const CameraMotion pose = standing(make_pose(1.6, 40.0));
  const cv::Mat3f a = renderer.render(camera, {80, 60}, pose, 0.0, 0, {}, 1);
  const cv::Mat3f b = renderer.render(camera, {80, 60}, pose, 0.0, 0, {}, 2);
  EXPECT_FALSE(are_equal(a, b));
  EXPECT_NEAR(cv::mean(a)[1], cv::mean(b)[1], 0.01 * cv::mean(a)[1]);
}

TEST(Render, GlossyGroundMirrorsMoreAtGrazingAngles) {
  const auto mirrored = [](double pitch_deg) {
    Scene scene = make_scene({.pattern = Pattern::plain, .color = {0.0F, 0.0F, 0.0F}, .gloss = 0.1F});
    scene.light.sun = {1e-6F, 1e-6F, 1e-6F};  // a clear sky, which differs by less than 2 from the zenith to the horizon
    scene.meshes.push_back(test::make_floor(-500.0F, 500.0F, -500.0F, 500.0F, 0.0F));
    return cv::mean(render_left(scene, make_camera(8, 8, 200.0), {8, 8}, make_pose(1.5, pitch_deg)))[1];
  };
  EXPECT_NEAR(mirrored(90.0), 0.1 * 0.8, 0.01);
  EXPECT_GT(mirrored(8.0), 4.0 * mirrored(90.0));
}

TEST(Render, BadArgumentsThrow) {
  Renderer renderer(make_asphalt());
  const StereoCamera camera = make_camera(8, 8, 10.0);
  const CameraMotion pose = standing(make_pose(1.5, 40.0));
  const auto message = [&](const RenderParams& params, int eye) {
    return brink::test::error_of<std::invalid_argument>([&] {
      (void)renderer.render(camera, {8, 8}, pose, 0.0, eye, params, 1);
    });
  };
  brink::test::expect_line_with(message({.samples = 0}, 0), "render.samples = 0");
  brink::test::expect_line_with(message({.shutter_s = -0.1}, 0), "render.shutter_s = -0.1");
  brink::test::expect_line_with(message({.sky_rays = 65}, 0), "render.sky_rays = 65");
  brink::test::expect_line_with(message({}, 2), "eye = 2");
  EXPECT_THROW((void)renderer.trace(camera, {-1, 8}, make_pose(1.5, 40.0), 0.0), std::invalid_argument);
  EXPECT_THROW((void)renderer.trace({}, {8, 8}, make_pose(1.5, 40.0), 0.0), std::invalid_argument);
  Scene broken = make_asphalt();
  broken.meshes[0].material = 9;
  EXPECT_THROW(Renderer{broken}, std::invalid_argument);
}

}  // namespace
}  // namespace brink::sim
