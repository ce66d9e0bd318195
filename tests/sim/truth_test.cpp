// The truth of simulated walks against itself: pictures, disparities, poses and rims tell of the same world.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "brink/ground.hpp"
#include "brink/sim/simulate.hpp"

namespace brink::sim {
namespace {

SimulationParams small_walk(const std::string& family) {
  SimulationParams params;
  params.family = family;
  params.width = 640;
  params.height = 360;
  params.focal_px = 350.0;
  params.frames = 10;
  params.fps = 1.0;
  params.noise = 0.0;
  params.light = "overcast";
  return params;
}

double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Pixels that something nearer hides from the right eye, by projecting the row onto it.
cv::Mat1b hidden_from_right(const cv::Mat1f& disparity) {
  cv::Mat1b hidden(disparity.size(), uchar{0});
  for (int v = 0; v < disparity.rows; ++v) {
    std::vector<float> nearest(static_cast<std::size_t>(disparity.cols), 0.0F);
    const auto column = [&](int u) { return static_cast<int>(std::lround(static_cast<float>(u) - disparity(v, u))); };
    for (int u = 0; u < disparity.cols; ++u) {
      for (int at = column(u) - 1; at <= column(u) + 1; ++at) {
        if (at < 0 || at >= disparity.cols) continue;
        float& known = nearest[static_cast<std::size_t>(at)];
        known = std::max(known, disparity(v, u));
      }
    }
    for (int u = 0; u < disparity.cols; ++u) {
      const int at = column(u);
      if (at < 2 || at >= disparity.cols - 2 || nearest[static_cast<std::size_t>(at)] > disparity(v, u) + 1.0F)
        hidden(v, u) = 1;
    }
  }
  return hidden;
}

// Bilinear; the caller keeps inside.
double sample(const cv::Mat1f& image, double u, double v) {
  const int column = static_cast<int>(u);
  const int row = static_cast<int>(v);
  const double x = u - column;
  const double y = v - row;
  return (1.0 - y) * ((1.0 - x) * image(row, column) + x * image(row, column + 1)) +
         y * ((1.0 - x) * image(row + 1, column) + x * image(row + 1, column + 1));
}

cv::Mat1f to_grey(const cv::Mat3b& picture) {
  cv::Mat1b grey8;
  cv::cvtColor(picture, grey8, cv::COLOR_BGR2GRAY);
  cv::Mat1f grey;
  grey8.convertTo(grey, CV_32F);
  return grey;
}

// Mean absolute difference of the left picture to the right one, fetched by the disparities plus an error, over pixels that
// both eyes see, with texture along the row; the eyes' different gains are taken out.
double warped_difference(const StereoPictures& pictures, const cv::Mat1f& disparity, double error) {
  const cv::Mat1f left = to_grey(pictures.left);
  const cv::Mat1f right = to_grey(pictures.right);
  const double gain = cv::mean(left)[0] / cv::mean(right)[0];
  const cv::Mat1b hidden = hidden_from_right(disparity);
  constexpr float kTexture = 6.0F;  // grey levels over two pixels
  double sum = 0.0;
  int count = 0;
  for (int v = 1; v < left.rows - 1; ++v) {
    for (int u = 1; u < left.cols - 1; ++u) {
      const double at = u - static_cast<double>(disparity(v, u)) - error;
      if (disparity(v, u) <= 0.0F || hidden(v, u) != 0 || at < 0.0 || at >= left.cols - 2) continue;
      if (std::abs(left(v, u + 1) - left(v, u - 1)) < kTexture) continue;
      sum += std::abs(left(v, u) - gain * sample(right, at, v));
      ++count;
    }
  }
  EXPECT_GT(count, 2000);
  return sum / count;
}

class TruthOf : public testing::TestWithParam<const char*> {};

TEST_P(TruthOf, TheRightPictureWarpedByTheDisparityIsTheLeftOne) {
  Simulator simulator(small_walk(GetParam()));
  for (const int frame : {0, 6}) {
    const StereoPictures pictures = simulator.pictures(frame);
    const cv::Mat1f disparity = simulator.truth(frame).disparity;
    const double right = warped_difference(pictures, disparity, 0.0);
    const double less = warped_difference(pictures, disparity, -0.5);
    const double more = warped_difference(pictures, disparity, 0.5);
    std::printf("%-9s frame %d: warped right picture differs by %.2f grey levels; by %.2f and %.2f half a pixel aside\n",
                GetParam(), frame, right, less, more);
    EXPECT_LT(right, 6.0);
    // The disparity at which the pictures agree best, by a parabola: a wrong one would shift it. The rest is the noise of four
    // rays a pixel on fine texture.
    EXPECT_NEAR(0.25 * (less - more) / (less - 2.0 * right + more), 0.0, 0.05);
  }
}

constexpr float kMayWalk = 0.25F;  // m: what is higher may be somebody who walks, and is not compared between frames

cv::Mat1f elevation_of(const cv::Mat1f& disparity, const StereoCamera& camera) {
  const GroundEstimate ground = estimate_ground(disparity, camera);
  EXPECT_EQ(ground.state, GroundState::seen);
  return compute_elevation(disparity, ground.plane.value(), camera);
}

// Where a point that frame `frame` sees is in the next one; empty when it is out of view.
struct Moved {
  double u, v, disparity;
};
std::optional<Moved> move(const Simulator& simulator, int frame, int u, int v, double disparity) {
  const StereoCamera camera = simulator.camera();
  const Eigen::Isometry3d next_from_this =
      simulator.world_from_camera(frame + 1).inverse() * simulator.world_from_camera(frame);
  const Eigen::Vector3d point = next_from_this * camera.triangulate(u, v, disparity);
  const Eigen::Vector3d seen = camera.project(point);
  const SimulationParams& params = simulator.params();
  if (point.z() < 0.1 || seen.x() < 0.0 || seen.y() < 0.0 || seen.x() >= params.width - 1 || seen.y() >= params.height - 1) {
    return std::nullopt;
  }
  return Moved{seen.x(), seen.y(), seen.z()};
}

// The four pixels around a place lie on one surface.
bool is_smooth(const cv::Mat1f& disparity, double u, double v) {
  const cv::Mat1f corners = disparity(cv::Rect(static_cast<int>(u), static_cast<int>(v), 2, 2));
  double low = 0.0;
  double high = 0.0;
  cv::minMaxLoc(corners, &low, &high);
  return low > 0.0 && high - low < 1.0;
}

TEST_P(TruthOf, PosesAndDisparitiesOfConsecutiveFramesAgree) {
  SimulationParams params = small_walk(GetParam());
  params.fps = 15.0;
  params.frames = 32;
  Simulator simulator(params);
  for (const int frame : {0, 15, 30}) {
    const cv::Mat1f now = simulator.truth(frame).disparity;
    const cv::Mat1f next = simulator.truth(frame + 1).disparity;
    const cv::Mat1f elevation = elevation_of(now, simulator.camera());
    std::vector<double> errors;
    int compared = 0;
    int close = 0;
    int hidden = 0;
    for (int v = 0; v < now.rows; v += 3) {
      for (int u = 0; u < now.cols; u += 3) {
        if (now(v, u) <= 0.0F || elevation(v, u) > kMayWalk) continue;
        const std::optional<Moved> moved = move(simulator, frame, u, v, now(v, u));
        if (!moved || !is_smooth(next, moved->u, moved->v)) continue;
        const double error = std::abs(sample(next, moved->u, moved->v) - moved->disparity);
        if (error > 1.0) {  // another surface has come before it, or it moves itself
          ++hidden;
          continue;
        }
        errors.push_back(error);
        ++compared;
        if (error < 0.2) ++close;
      }
    }
    std::printf("%-9s frames %d, %d: disparities differ by %.4f px (median of %d), %.2f %% by less than 0.2 px\n", GetParam(),
                frame, frame + 1, median(errors), compared, 100.0 * close / compared);
    EXPECT_GT(compared, 5000);
    EXPECT_LT(hidden, 0.2 * compared);  // people walk by at arm's length
    EXPECT_LT(median(errors), 0.02);
    EXPECT_GT(close, 0.97 * compared);
  }
}

// Distance of every pixel to the edge of a mask, px.
cv::Mat1f distance_to_edge(const cv::Mat1b& mask) {
  cv::Mat1f inside;
  cv::Mat1f outside;
  cv::distanceTransform(mask, inside, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  cv::distanceTransform(cv::Mat1b(mask == 0), outside, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  inside += outside - 0.5F;  // one of them is 0; the edge runs between the pixels
  return inside;
}

// Distances of the visible points of a rim to the edge of its obstacle's mask.
std::vector<double> rim_distances(const Simulator& simulator, int frame, const Instance& instance, const Truth& truth) {
  const cv::Mat1f distance = distance_to_edge(cv::Mat1b(truth.obstacle == instance.id));
  const Eigen::Isometry3d camera_from_world = simulator.world_from_camera(frame).inverse();
  std::vector<double> distances;
  constexpr double kSpacing = 0.02;  // m
  constexpr double kFarthest = 8.0;  // m, as far as drops are looked for
  for (std::size_t i = 0; i < instance.opening.size(); ++i) {
    const Eigen::Vector3d& from = instance.opening[i];
    const Eigen::Vector3d side = instance.opening[(i + 1) % instance.opening.size()] - from;
    const int points = static_cast<int>(side.norm() / kSpacing);
    for (int k = 0; k < points; ++k) {
      const Eigen::Vector3d point = camera_from_world * (from + k * kSpacing * side.normalized());
      if (point.z() < 0.2 || point.z() > kFarthest) continue;
      const Eigen::Vector3d seen = simulator.camera().project(point);
      const int u = static_cast<int>(std::lround(seen.x()));
      const int v = static_cast<int>(std::lround(seen.y()));
      if (u < 2 || v < 2 || u >= distance.cols - 2 || v >= distance.rows - 2) continue;
      // Visible: the surface there, or right beside it, is as far away as the rim.
      double nearest = std::numeric_limits<double>::infinity();
      for (int dv = -1; dv <= 1; ++dv) {
        for (int du = -1; du <= 1; ++du) nearest = std::min(nearest, std::abs(truth.disparity(v + dv, u + du) - seen.z()));
      }
      if (nearest < 0.05) distances.push_back(distance(v, u));
    }
  }
  return distances;
}

TEST_P(TruthOf, TheRimOfEveryObstacleIsTheEdgeOfItsMask) {
  Simulator simulator(small_walk(GetParam()));
  constexpr int kFewest = 150;  // px, of an instance that counts in a frame
  int seen = 0;
  for (int frame = 0; frame < simulator.params().frames; ++frame) {
    const Truth truth = simulator.truth(frame);
    for (const Instance& instance : simulator.instances()) {
      if (cv::countNonZero(truth.obstacle == instance.id) < kFewest) continue;
      const std::vector<double> distances = rim_distances(simulator, frame, instance, truth);
      if (distances.size() < 20) continue;
      ++seen;
      std::printf("%-9s frame %d: %s %d, rim to edge of mask %.2f px (median of %d points)\n", GetParam(), frame,
                  instance.type.c_str(), instance.id, median(distances), static_cast<int>(distances.size()));
      EXPECT_LT(median(distances), 2.0);
    }
  }
  const bool has_obstacles = std::string(GetParam()) != "control" && std::string(GetParam()) != "motion";
  EXPECT_EQ(seen > 0, has_obstacles);
}

// The same walk with and without those who move: where the truth differs, somebody moves.
TEST(Crowd, TakesAboutAThirdOfThePicture) {
  for (const int seed : {1, 2, 3, 4}) {
    SimulationParams params = small_walk("crowd");
    params.seed = seed;
    params.width = 160;
    params.height = 90;
    params.focal_px = 87.5;
    Simulator simulator(params);
    const World world = make_world("crowd", seed, params.frames / params.fps + 1.0, params.light);  // as it does
    Scene empty = world.scene;
    std::erase_if(empty.meshes, [](const Mesh& mesh) { return mesh.body >= 0; });
    Renderer renderer(empty);
    const HeadMotion motion(world.walk, [&](double x, double y, double z) { return renderer.ground_height(x, y, z); });
    double share = 0.0;
    for (int frame = 0; frame < params.frames; ++frame) {
      const double time = simulator.time(frame);
      const cv::Mat1f with = simulator.truth(frame).disparity;
      const cv::Mat1f without = renderer.trace(simulator.camera(), with.size(), motion(time), time).disparity;
      share += static_cast<double>(cv::countNonZero(with != without)) / static_cast<double>(with.total()) / params.frames;
    }
    std::printf("crowd, seed %d: those who move take %.3f of the picture\n", seed, share);
    EXPECT_GT(share, 0.25);
    EXPECT_LT(share, 0.45);
  }
}

INSTANTIATE_TEST_SUITE_P(Families, TruthOf, testing::Values("stairs", "platform", "manholes", "street", "control", "motion"),
                         [](const testing::TestParamInfo<const char*>& family) { return std::string(family.param); });

}  // namespace
}  // namespace brink::sim
