#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "brink/disparity.hpp"
#include "brink/ground.hpp"
#include "ground/cells_simd.hpp"
#include "reference/cells.hpp"
#include "select_nth.hpp"
#include "simd_targets.hpp"
#include "synthetic_scene.hpp"

namespace brink {
namespace {

/// Surfaces that depend on the distance ahead only, seen by a camera 1.6 m up, pitched down by 30 degrees.
class FollowGround : public testing::Test {
 protected:
  /// @param height of the surface at a distance ahead, m. Rays are followed in small steps.
  void see(const std::function<double(double)>& height) {
    disparity_ = cv::Mat1f(test::half_size(), kInvalidDisparity);
    for (int v = 0; v < disparity_.rows; ++v) {
      const Eigen::Vector3d ray(0.0, (v - camera_.cy) / camera_.focal, 1.0);
      const double descent = pose_.down.dot(ray);
      if (descent <= 0.0) continue;
      constexpr double kStep = 0.002;  // m along the ray
      constexpr double kFarthest = 20.0;
      for (int i = 0; 0.5 + i * kStep < kFarthest; ++i) {
        const Eigen::Vector3d point = (0.5 + i * kStep) * ray;
        if (pose_.elevation(point) > height(pose_.forward.dot(point))) continue;
        disparity_.row(v).setTo(camera_.focal * camera_.baseline / point.z());
        break;
      }
    }
    plain_ = compute_elevation(disparity_, plane_, camera_);
    follow();
  }
  void follow() { followed_ = compute_elevation(disparity_, follow_ground(disparity_, flat(), camera_, params_), camera_); }
  [[nodiscard]] GroundSurface flat() const {
    GroundSurface flat;
    flat.plane = plane_;
    flat.pose = pose_;
    flat.disparity_sd_px = 0.15;
    return flat;
  }
  /// The elevations up to a distance, in the middle of the picture.
  [[nodiscard]] std::vector<float> elevations(const cv::Mat1f& elevation, double until_m) const {
    std::vector<float> all;
    for (int v = 0; v < elevation.rows; ++v) {
      const double d = disparity_(v, kMiddle);
      if (d > 0.0 && pose_.distance(camera_.triangulate(camera_.cx, v, d)) <= until_m) all.push_back(elevation(v, kMiddle));
    }
    return all;
  }
  [[nodiscard]] float lowest(const cv::Mat1f& elevation, double until_m) const {
    return std::ranges::min(elevations(elevation, until_m));
  }
  [[nodiscard]] float highest(const cv::Mat1f& elevation, double until_m) const {
    return std::ranges::max(elevations(elevation, until_m));
  }

  static constexpr int kMiddle = 320;
  StereoCamera camera_ = test::half_size_camera();
  GroundPlane plane_ = make_ground_plane(1.6, 30.0, 0.0, camera_);
  GroundPose pose_ = compute_ground_pose(plane_, camera_);
  GroundParams params_;
  cv::Mat1f disparity_;
  cv::Mat1f plain_;
  cv::Mat1f followed_;
};

double tangent(double degrees) { return std::tan(degrees * std::numbers::pi / 180.0); }

TEST_F(FollowGround, LeavesAPlaneAlone) {
  see([](double) { return 0.0; });
  EXPECT_GT(lowest(plain_, 8.0), -0.02F);
  EXPECT_GT(lowest(followed_, 8.0), -0.02F);
}

TEST_F(FollowGround, GoesDownARamp) {
  for (const double slope : {3.0, 5.0, 8.0}) {
    SCOPED_TRACE(slope);
    see([slope](double ahead) { return ahead < 2.5 ? 0.0 : -tangent(slope) * (ahead - 2.5); });
    EXPECT_LT(lowest(plain_, 7.0), -tangent(slope) * 4.3);
    EXPECT_GT(lowest(followed_, 7.0), -0.05F);
  }
}

TEST_F(FollowGround, GoesUpARamp) {
  see([](double ahead) { return ahead < 2.5 ? 0.0 : tangent(6.0) * (ahead - 2.5); });
  EXPECT_GT(highest(plain_, 7.0), 0.4F);
  EXPECT_LT(highest(followed_, 7.0), 0.06F);
}

TEST_F(FollowGround, StopsAtAStep) {
  for (const double depth : {0.15, 0.3, 1.0}) {
    for (const double rim : {1.5, 3.0, 4.5}) {
      SCOPED_TRACE(testing::Message() << depth << " m down at " << rim << " m");
      see([&](double ahead) { return ahead < rim ? 0.0 : -depth; });
      EXPECT_NEAR(lowest(followed_, 8.0), -depth, 0.03);
    }
  }
}

TEST_F(FollowGround, StopsAtStairs) {
  see([](double ahead) { return ahead < 2.0 ? 0.0 : -0.16 * (1.0 + std::floor((ahead - 2.0) / 0.33)); });
  EXPECT_LT(lowest(followed_, 4.0), -0.7F);
}

TEST_F(FollowGround, StopsAtAKerbBelowARamp) {
  see([](double ahead) {
    return ahead < 1.8 ? 0.0 : -tangent(6.0) * (std::min(ahead, 3.5) - 1.8) - (ahead < 3.5 ? 0.0 : 0.2);
  });
  EXPECT_NEAR(lowest(followed_, 5.0), -0.2, 0.04);
}

// Matchers smooth a kerb into a slope of half a metre; behind it the road goes on level.
TEST_F(FollowGround, StopsAtAKerbThatIsSmoothed) {
  for (const double rim : {2.0, 3.0, 4.0}) {
    SCOPED_TRACE(rim);
    see([&](double ahead) { return -0.16 * std::clamp((ahead - rim) / 0.5, 0.0, 1.0); });
    EXPECT_NEAR(lowest(followed_, 6.0), -0.16, 0.02);
  }
}

TEST_F(FollowGround, MeetsRaysWhereTheSurfaceIs) {
  see([](double ahead) { return ahead < 2.5 ? 0.0 : -tangent(6.0) * (ahead - 2.5); });
  const GroundSurface surface = follow_ground(disparity_, flat(), camera_, params_);
  for (const double v : {60.0, 100.0, 150.0, 300.0}) {
    const auto on_plane = flat().intersect(kMiddle, v, camera_);
    const auto on_surface = surface.intersect(kMiddle, v, camera_);
    ASSERT_TRUE(on_plane && on_surface);
    // A ray that falls by s a metre meets the plane at h / s and the ramp where h - s x = -t (x - 2.5).
    const double plane_m = pose_.distance(*on_plane);
    const double fall = pose_.height_m / plane_m;
    const double ramp_m = (pose_.height_m - tangent(6.0) * 2.5) / (fall - tangent(6.0));
    const double expected = std::max(plane_m, plane_m < 2.5 ? 0.0 : ramp_m);
    if (expected < 6.0) {
      EXPECT_NEAR(pose_.distance(*on_surface), expected, 0.02 * expected) << v;
    }
    EXPECT_NEAR(surface.relief(*on_surface), pose_.elevation(*on_surface), 0.02);
  }
  EXPECT_EQ(flat().relief(Eigen::Vector3d(0.0, 1.0, 2.0)), 0.0);
  EXPECT_EQ(surface.relief(Eigen::Vector3d(-1e300, 1e300, 1e300) * 1e300), 0.0) << "where nothing can be";
  EXPECT_FALSE(surface.intersect(kMiddle, -300.0, camera_)) << "above the horizon";
}

// Noise of matching is alike over a few pixels; bends count up to twice the noise.
TEST(GroundSurface, TellsTheNoiseOnIt) {
  const StereoCamera camera = test::half_size_camera();
  GroundEstimate ground;
  ground.plane = make_ground_plane(1.6, 30.0, 0.0, camera);
  ground.pose = compute_ground_pose(*ground.plane, camera);
  cv::Mat1f disparity = test::make_disparity(camera, test::half_size(), *ground.plane);
  EXPECT_EQ(make_flat_surface(ground, disparity, camera).roughness_px, 0.03);
  cv::Mat1f noise(disparity.size());
  cv::RNG(4).fill(noise, cv::RNG::NORMAL, 0.0, 0.06);
  disparity += noise;
  const GroundSurface surface = make_flat_surface(ground, disparity, camera);
  EXPECT_NEAR(surface.roughness_px, 0.06, 0.01);
  EXPECT_NEAR(surface.disparity_sd_px, 3.3 * surface.roughness_px, 1e-9);
  ground.residual_px = 5.0;
  EXPECT_NEAR(make_flat_surface(ground, disparity, camera).disparity_sd_px, 6.6 * surface.roughness_px, 1e-9);
  EXPECT_THROW(make_flat_surface({}, disparity, camera), std::invalid_argument);
}

TEST_F(FollowGround, LeavesAShallowBowlWhatItIs) {
  see([](double ahead) { return ahead < 2.0 || ahead > 2.7 ? 0.0 : -0.05 * std::sin((ahead - 2.0) / 0.7 * std::numbers::pi); });
  EXPECT_NEAR(lowest(followed_, 8.0), -0.05, 0.01);
}

TEST_F(FollowGround, HasNoElevationWhereThereIsNone) {
  see([](double) { return 0.0; });
  disparity_(cv::Rect(100, 200, 50, 50)).setTo(kInvalidDisparity);
  plain_ = compute_elevation(disparity_, plane_, camera_);
  follow();
  EXPECT_EQ(cv::countNonZero(cv::Mat1b(followed_ == followed_) != cv::Mat1b(plain_ == plain_)), 0);
  disparity_.setTo(kInvalidDisparity);
  follow();
  EXPECT_EQ(cv::countNonZero(followed_ == followed_), 0);
  disparity_.release();
  follow();
  EXPECT_TRUE(followed_.empty());
}

TEST_F(FollowGround, RefusesWhatDoesNotFit) {
  params_.follow_cell_m = 0.0;
  EXPECT_THROW(follow(), std::invalid_argument);
}

TEST(SelectNth, PutsEachValueInItsPlace) {
  cv::RNG random(21);
  for (const int count : {1, 2, 8, 9, 30, 200}) {
    for (const int levels : {1, 3, 1000}) {
      std::vector<float> values(static_cast<std::size_t>(count));
      for (float& value : values) value = static_cast<float>(random.uniform(0, levels)) - 7.5F;
      std::vector<float> sorted = values;
      std::ranges::sort(sorted);
      for (std::size_t n = 0; n < values.size(); ++n) {
        std::vector<float> some = values;
        select_nth(some.data(), some.data() + n, some.data() + some.size());
        EXPECT_EQ(some[n], sorted[n]);
        EXPECT_TRUE(
            std::all_of(some.begin(), some.begin() + static_cast<std::ptrdiff_t>(n), [&](float x) { return x <= some[n]; }));
        std::ranges::sort(some);
        EXPECT_EQ(some, sorted) << "none is lost";
      }
    }
  }
}

TEST(CellPlaces, EqualTheirTwinOnEveryTarget) {
  cv::RNG random(13);
  const StereoCamera camera{.focal = 350.0, .cx = 161.5, .cy = 90.2, .baseline = 0.15};
  const GroundPose pose = compute_ground_pose(make_ground_plane(1.5, 25.0, 4.0, camera), camera);
  const CellGrid grid{0.2, -5.0, 50, 25};
  std::vector<float> disparity(320);
  for (float& d : disparity) d = random.uniform(0, 5) == 0 ? kInvalidDisparity : random.uniform(3.0F, 50.0F);
  int told = 0;
  for (const int step : {1, 2, 3}) {
    for (const int count : {0, 1, 3, 17, 106}) {
      for (const int v : {0, 60, 120, 179}) {
        const PixelRow row{disparity.data(), v, step / 2, step, count};
        const auto expected = reference::naive_cells(row, camera, pose, grid, 1.0);
        told += static_cast<int>(std::ranges::count_if(expected, [](const auto& place) { return place.cell >= 0; }));
        test::for_each_target([&] {
          std::vector<int> cells(expected.size());
          std::vector<float> elevation_m(expected.size());
          place_in_cells(row, camera, pose, grid, 1.0, cells.data(), elevation_m.data());
          std::vector<reference::CellPlace> places;
          for (std::size_t i = 0; i < cells.size(); ++i) places.push_back({cells[i], cells[i] < 0 ? 0.0F : elevation_m[i]});
          EXPECT_TRUE(places == expected) << step << ' ' << count << ' ' << v;
        });
      }
    }
  }
  EXPECT_GT(told, 100);
}

}  // namespace
}  // namespace brink
