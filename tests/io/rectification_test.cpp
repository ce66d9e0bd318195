#include "io/rectification.hpp"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "expect_error.hpp"

namespace brink {
namespace {

const cv::Size kSize(321, 203);

LensCamera make_eye(double focal, LensModel model = LensModel::radial_tangential, std::vector<double> lens = {}) {
  return {focal, focal, 160.0, 101.0, model, std::move(lens), kSize};
}

Eigen::Isometry3d beside(double turn_deg = 0.0) {
  Eigen::Isometry3d right_from_left = Eigen::Isometry3d::Identity();
  right_from_left.linear() = Eigen::AngleAxisd(turn_deg * CV_PI / 180.0, Eigen::Vector3d(0.3, 1.0, -0.2).normalized()).matrix();
  right_from_left.translation() = Eigen::Vector3d(-0.12, 0.001, -0.002);
  return right_from_left;
}

// A white picture stays white: a pixel without a source would be black.
void expect_every_pixel_to_have_a_source(const Rectification& rectification, const std::string& lens) {
  const cv::Mat1b white(kSize, uchar{255});
  for (const RectificationMaps* maps : {&rectification.left, &rectification.right}) {
    EXPECT_EQ(cv::countNonZero(maps->apply(white) == 255), static_cast<int>(white.total())) << lens;
  }
}

double degrees_across(const Rectification& rectification) {
  return 2.0 * std::atan(kSize.width / (2.0 * rectification.camera.focal)) * 180.0 / CV_PI;
}

TEST(Rectification, NoPixelLacksASource) {
  const std::vector<double> barrel{-0.28, 0.07, 2e-4, -1e-4};
  const std::vector<double> rational{0.5, 0.1, 2e-4, -1e-4, 0.005, 0.85, 0.22, 0.02};
  const std::vector<double> thin_prism{0.5, 0.1, 2e-4, -1e-4, 0.005, 0.85, 0.22, 0.02, 1e-3, 1e-4, -1e-3, 1e-4};
  for (const std::vector<double>& lens : {barrel, rational, thin_prism}) {
    const LensCamera eye = make_eye(180.0, LensModel::radial_tangential, lens);
    expect_every_pixel_to_have_a_source(make_rectification(eye, eye, beside(1.5)), eye.lens());
  }
  const LensCamera fisheye = make_eye(150.0, LensModel::fisheye, {-0.01, 0.02, -0.01, 0.002});
  expect_every_pixel_to_have_a_source(make_rectification(fisheye, fisheye, beside(1.5)), "fisheye");
  expect_every_pixel_to_have_a_source(make_rectification(make_eye(150.0), fisheye, beside()), "one fisheye");
}

TEST(Rectification, KeepsTheBaseline) {
  const LensCamera eye = make_eye(180.0, LensModel::radial_tangential, {-0.28, 0.07, 2e-4, -1e-4});
  EXPECT_NEAR(make_rectification(eye, eye, beside(1.5)).camera.baseline, beside().translation().norm(), 1e-12);
}

// An ideal fisheye: 100 px a radian show 184 degrees across, and 116 in height.
TEST(Rectification, FisheyeViewIsAsWideAsThePictureAndNotWiderThan110Degrees) {
  const std::vector<double> ideal{0.0, 0.0, 0.0, 0.0};
  const auto across = [&](double focal) {
    const LensCamera eye = make_eye(focal, LensModel::fisheye, ideal);
    return degrees_across(make_rectification(eye, eye, beside()));
  };
  EXPECT_NEAR(across(100.0), 110.0, 0.6);
  // Here the height decides: the upper border's middle is 101 px = 101 / 200 rad from the centre.
  const double focal = 101.0 / std::tan(101.0 / 200.0);
  EXPECT_NEAR(across(200.0), 2.0 * std::atan(160.5 / focal) * 180.0 / CV_PI, 1.0);
}

TEST(Rectification, FisheyeWithoutCoefficientsIsNoPinhole) {
  EXPECT_FALSE(make_eye(100.0, LensModel::fisheye, {0.0, 0.0, 0.0, 0.0}).is_pinhole());
  EXPECT_TRUE(make_eye(100.0, LensModel::radial_tangential, {0.0, 0.0, 0.0, 0.0}).is_pinhole());
}

TEST(Rectification, NeedsNoneForIdealCamerasOnly) {
  Eigen::Isometry3d ideal = Eigen::Isometry3d::Identity();
  ideal.translation().x() = -0.12;
  const LensCamera eye = make_eye(180.0);
  EXPECT_TRUE(is_rectified(eye, eye, ideal));
  EXPECT_FALSE(is_rectified(eye, eye, beside()));
  EXPECT_FALSE(is_rectified(eye, make_eye(181.0), ideal));
  EXPECT_FALSE(is_rectified(eye, make_eye(180.0, LensModel::radial_tangential, {0.01, 0.0, 0.0, 0.0}), ideal));
  Eigen::Isometry3d turned = ideal;
  turned.linear() = Eigen::AngleAxisd(1e-4, Eigen::Vector3d::UnitZ()).matrix();
  EXPECT_FALSE(is_rectified(eye, eye, turned));
}

// Coefficients like these come of a calibration that failed.
TEST(Rectification, RefusesCamerasWithoutACommonView) {
  const LensCamera eye = make_eye(100.0, LensModel::fisheye, {0.0, 0.0, 0.0, 0.0});
  test::expect_line_with(test::error_of<std::runtime_error>([&] { make_rectification(eye, eye, beside(170.0)); }),
                         "leaves no view that both cameras share");
}

// In a picture in which each pixel holds its column, moved pixels hold where they come from.
TEST(Rectification, ShiftMovesTheRightPictureOnly) {
  cv::Mat1b columns(5, 200);
  for (int v = 0; v < columns.rows; ++v) {
    for (int u = 0; u < columns.cols; ++u) columns(v, u) = static_cast<uchar>(u);
  }
  const Rectification shift = make_shift({100.0, 50.0, 2.0, 0.1}, columns.size(), 12.0);
  EXPECT_EQ(cv::norm(shift.left.apply(columns), columns, cv::NORM_INF), 0.0);
  const cv::Mat1b moved = shift.right.apply(columns);
  EXPECT_EQ(moved(2, 0), 12);
  EXPECT_EQ(moved(2, 100), 112);
  EXPECT_EQ(moved(2, 199), 0);  // beyond the picture: what a camera sees there is nearer than its left neighbour allows
}

}  // namespace
}  // namespace brink
