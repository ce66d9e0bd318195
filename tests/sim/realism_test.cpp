// Is the simulated ground as hard to match as the real one? The same figures for real pictures and for simulated ones, taken by
// the same camera from the same height and angle.

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "brink/disparity.hpp"
#include "brink/ground.hpp"
#include "brink/sequence.hpp"
#include "brink/sim/render.hpp"
#include "sim/materials.hpp"
#include "test_data.hpp"

namespace brink::sim {
namespace {

/// A pair of pictures and where in the left one there is ground that both eyes see.
struct GroundView {
  std::string name;
  Frame frame;
  cv::Mat1b ground;
};

struct MatchFigures {
  double density_percent = 0.0;    ///< valid share of the ground
  double agreement_percent = 0.0;  ///< of those: the right view's disparity agrees within 1 px
  double plane_residual_px = 0.0;  ///< median over 21x21 px windows: distance from the fitted plane, root mean square
};

struct PictureFigures {
  double local_contrast = 0.0;  ///< median over 15x15 px windows: standard deviation over mean
  double gradient_p50 = 0.0;    ///< Sobel magnitude over the mean, percent a pixel
  double gradient_p90 = 0.0;
  double gradient_p99 = 0.0;
  double noise = 0.0;  ///< left against warped right, grey levels, as the standard deviation of one eye
};

double percentile(std::vector<float> values, double share) {
  if (values.empty()) return std::nan("");
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, place);
  return *place;
}

cv::Mat1f compute_right_disparity(const Frame& frame, const DisparityParams& params) {
  cv::Mat1b left;
  cv::Mat1b right;
  cv::flip(frame.right, left, 1);
  cv::flip(frame.left, right, 1);
  cv::Mat1f disparity;
  cv::flip(compute_disparity(left, right, params), disparity, 1);
  return disparity;
}

/// Root mean square distance of a window's disparities from their plane; NaN unless all are valid.
double window_residual(const cv::Mat1f& window) {
  const int count = static_cast<int>(window.total());
  cv::Mat1d system(count, 3);
  cv::Mat1d values(count, 1);
  int row = 0;
  for (int v = 0; v < window.rows; ++v) {
    for (int u = 0; u < window.cols; ++u, ++row) {
      if (window(v, u) == kInvalidDisparity) return std::nan("");
      system(row, 0) = u;
      system(row, 1) = v;
      system(row, 2) = 1.0;
      values(row, 0) = window(v, u);
    }
  }
  cv::Mat1d plane;
  cv::solve(system, values, plane, cv::DECOMP_NORMAL);
  return cv::norm(system * plane, values, cv::NORM_L2) / std::sqrt(static_cast<double>(count));
}

MatchFigures measure_matching(const GroundView& view, Matcher matcher) {
  DisparityParams params;
  params.matcher = matcher;
  const cv::Mat1f left = compute_disparity(view.frame.left, view.frame.right, params);
  const cv::Mat1f right = compute_right_disparity(view.frame, params);
  double known = 0.0;
  double valid = 0.0;
  double agreeing = 0.0;
  std::vector<float> residuals;
  constexpr int kReach = 10;
  for (int v = 0; v < left.rows; ++v) {
    for (int u = 0; u < left.cols; ++u) {
      if (view.ground(v, u) == 0) continue;
      known += 1.0;
      const float d = left(v, u);
      if (d == kInvalidDisparity) continue;
      valid += 1.0;
      const int partner = u - static_cast<int>(std::lround(d));
      if (partner >= 0 && right(v, partner) != kInvalidDisparity && std::abs(right(v, partner) - d) <= 1.0F) agreeing += 1.0;
      const cv::Rect window(u - kReach, v - kReach, 2 * kReach + 1, 2 * kReach + 1);
      if (u % 16 != 0 || v % 16 != 0 || (window & cv::Rect({0, 0}, left.size())) != window) continue;
      const double residual = window_residual(left(window));
      if (!std::isnan(residual)) residuals.push_back(static_cast<float>(residual));
    }
  }
  return {100.0 * valid / known, 100.0 * agreeing / valid, percentile(residuals, 0.5)};
}

PictureFigures measure_picture(const GroundView& view) {
  cv::Mat1f left;
  cv::Mat1f right;
  view.frame.left.convertTo(left, CV_32F);
  view.frame.right.convertTo(right, CV_32F);
  const double brightness = cv::mean(left, view.ground)[0];
  right *= brightness / cv::mean(right, view.ground)[0];
  cv::Mat1f mean;
  cv::Mat1f square;
  cv::blur(left, mean, {15, 15});
  cv::blur(left.mul(left), square, {15, 15});
  cv::Mat1f gradient_u;
  cv::Mat1f gradient_v;
  cv::Sobel(left, gradient_u, CV_32F, 1, 0, 3, 0.125);
  cv::Sobel(left, gradient_v, CV_32F, 0, 1, 3, 0.125);
  const cv::Mat1f disparity = compute_disparity(view.frame.left, view.frame.right);
  std::vector<float> contrasts;
  std::vector<float> gradients;
  std::vector<float> differences;
  for (int v = 0; v < left.rows; ++v) {
    for (int u = 0; u < left.cols; ++u) {
      if (view.ground(v, u) == 0) continue;
      contrasts.push_back(std::sqrt(std::max(0.0F, square(v, u) - mean(v, u) * mean(v, u))) / std::max(1.0F, mean(v, u)));
      gradients.push_back(static_cast<float>(100.0 * std::hypot(gradient_u(v, u), gradient_v(v, u)) / brightness));
      const float partner = static_cast<float>(u) - disparity(v, u);
      const int first = static_cast<int>(partner);
      if (disparity(v, u) == kInvalidDisparity || partner < 0.0F || first + 1 >= left.cols) continue;
      const float share = partner - static_cast<float>(first);
      differences.push_back(std::abs(left(v, u) - (1.0F - share) * right(v, first) - share * right(v, first + 1)));
    }
  }
  return {percentile(contrasts, 0.5), percentile(gradients, 0.5), percentile(gradients, 0.9), percentile(gradients, 0.99),
          1.4826 / std::numbers::sqrt2 * percentile(differences, 0.5)};
}

/// Frame 0 of a real sequence; ground is what truth does not call a hole, inside the columns that both eyes see.
GroundView real_view(const std::string& folder, const char* name, int hidden_columns) {
  GroundView view{name, open_sequence(folder).read(0).frame, {}};
  view.ground = cv::Mat1b(view.frame.left.size(), uchar{255});
  const std::string holes = folder + "/negative/000000.png";
  if (std::filesystem::exists(holes)) {
    cv::Mat1b near_hole;
    cv::dilate(cv::imread(holes, cv::IMREAD_GRAYSCALE), near_hole, cv::Mat1b::ones(41, 41));
    view.ground.setTo(0, near_hole);
  }
  view.ground.colRange(0, hidden_columns).setTo(0);
  return view;
}

/// The same camera over a flat sheet of one material in the sun.
GroundView simulated_view(const GroundView& real, const Material& material, const Eigen::Vector3f& to_sun, int seed) {
  const GroundEstimate ground = estimate_ground(compute_disparity(real.frame.left, real.frame.right), real.frame.camera);
  Scene scene;
  scene.materials = {material};
  Mesh sheet;
  sheet.vertices = {{-20.0F, -20.0F, 0.0F}, {20.0F, -20.0F, 0.0F}, {20.0F, 20.0F, 0.0F}, {-20.0F, 20.0F, 0.0F}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  scene.meshes = {sheet};
  scene.light.sun = {3.0F, 2.9F, 2.7F};
  scene.light.to_sun = to_sun.normalized();
  const double pitch = ground.pose.pitch_deg * std::numbers::pi / 180.0;
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
  world_from_camera.linear().col(0) = Eigen::Vector3d(0.0, -1.0, 0.0);
  world_from_camera.linear().col(1) = Eigen::Vector3d(-std::sin(pitch), 0.0, -std::cos(pitch));
  world_from_camera.linear().col(2) = Eigen::Vector3d(std::cos(pitch), 0.0, -std::sin(pitch));
  world_from_camera.translation() = Eigen::Vector3d(0.37 * seed, 0.21 * seed, ground.pose.height_m);

  Renderer renderer(scene);
  std::array<cv::Mat3b, 2> eyes;
  double gain = 0.0;
  for (int eye = 0; eye < 2; ++eye) {
    const auto picture_seed = static_cast<unsigned>(2 * seed + eye);
    const cv::Mat3f radiance = renderer.render(
        real.frame.camera, real.frame.left.size(), [&](double) { return world_from_camera; }, 0.0, eye, {}, picture_seed);
    if (eye == 0) gain = compute_auto_gain(radiance);
    eyes[static_cast<std::size_t>(eye)] = expose(radiance, gain, eye, {}, picture_seed);
  }
  return {"simulated", make_frame(eyes[0], eyes[1], real.frame.camera), real.ground};
}

struct Figures {
  MatchFigures elas;
  MatchFigures sgbm;
  PictureFigures picture;
};

Figures measure_and_print(const GroundView& view) {
  const Figures figures{measure_matching(view, Matcher::elas), measure_matching(view, Matcher::sgbm), measure_picture(view)};
  const PictureFigures& p = figures.picture;
  fmt::print("{:16} {:6.2f} {:6.2f} {:6.3f}   {:6.2f} {:6.2f} {:6.3f}   {:7.3f} {:7.2f} {:6.2f} {:6.2f} {:6.2f}\n", view.name,
             figures.elas.density_percent, figures.elas.agreement_percent, figures.elas.plane_residual_px,
             figures.sgbm.density_percent, figures.sgbm.agreement_percent, figures.sgbm.plane_residual_px, p.local_contrast,
             p.gradient_p50, p.gradient_p90, p.gradient_p99, p.noise);
  return figures;
}

void expect_as_hard(double simulated, double real, const char* what) {
  EXPECT_NEAR(simulated, real, 0.2 * real) << what << ": simulated against real";
}

void expect_as_hard(const Figures& simulated, const Figures& real) {
  expect_as_hard(simulated.elas.density_percent, real.elas.density_percent, "elas density");
  expect_as_hard(simulated.elas.agreement_percent, real.elas.agreement_percent, "elas agreement");
  expect_as_hard(simulated.elas.plane_residual_px, real.elas.plane_residual_px, "elas plane residual");
  expect_as_hard(simulated.sgbm.density_percent, real.sgbm.density_percent, "sgbm density");
  expect_as_hard(simulated.sgbm.agreement_percent, real.sgbm.agreement_percent, "sgbm agreement");
  expect_as_hard(simulated.sgbm.plane_residual_px, real.sgbm.plane_residual_px, "sgbm plane residual");
}

void print_heading() {
  fmt::print(
      "                 elas: density, agreement %, residual px; sgbm: the same; local contrast, gradients %: p50 p90 p99, "
      "noise\n");
}

// Flat soil has none of the test bed's cast shadows, so only what lies in the light is compared.
TEST(Realism, SimulatedSoilIsAsHardToMatchAsTheLunarTestBed) {
  BRINK_REQUIRE_DATA(folder, "crater_9m_300ms");
  GroundView real = real_view(folder, "crater_9m_300ms", 290);
  real.ground.rowRange(0, 480).setTo(0);
  real.ground.rowRange(960, 1024).setTo(0);
  cv::Mat1b lit;
  cv::blur(real.frame.left, lit, {41, 41});
  real.ground.setTo(0, lit < 60);
  print_heading();
  const Figures bed = measure_and_print(real);
  expect_as_hard(measure_and_print(simulated_view(real, materials::soil(), {0.9F, -0.1F, 0.25F}, 1)), bed);
}

TEST(Realism, SimulatedAsphaltIsAsHardToMatchAsARealRoad) {
  BRINK_REQUIRE_DATA(folder, "pothole_a");
  const GroundView real = real_view(folder, "pothole_a", 170);
  print_heading();
  const Figures road = measure_and_print(real);
  expect_as_hard(measure_and_print(simulated_view(real, materials::asphalt(), {0.3F, 0.4F, 0.8F}, 1)), road);
}

}  // namespace
}  // namespace brink::sim
