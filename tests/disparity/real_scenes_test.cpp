#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "brink/disparity.hpp"
#include "test_data.hpp"

// Real pictures without true disparities: what must be empty is, what must be there is, and a road is smooth.
namespace brink {
namespace {

cv::Mat1b read_grey(const std::string& path) {
  cv::Mat1b grey;
  cv::cvtColor(cv::imread(path, cv::IMREAD_COLOR), grey, cv::COLOR_BGR2GRAY);
  return grey;
}

/// Where the 15x15 px around a pixel have a mean and a standard deviation (grey levels) in these ranges.
cv::Mat1b select_surroundings(const cv::Mat1b& picture, cv::Vec2d mean_range, cv::Vec2d deviation_range) {
  cv::Mat1d grey;
  picture.convertTo(grey, CV_64F);
  cv::Mat1d mean;
  cv::Mat1d square;
  cv::blur(grey, mean, {15, 15});
  cv::blur(grey.mul(grey), square, {15, 15});
  cv::Mat1b selected(picture.size(), std::uint8_t{0});
  for (int v = 0; v < picture.rows; ++v) {
    for (int u = 0; u < picture.cols; ++u) {
      const double deviation = std::sqrt(std::max(0.0, square(v, u) - mean(v, u) * mean(v, u)));
      const bool inside = mean(v, u) >= mean_range[0] && mean(v, u) <= mean_range[1] && deviation >= deviation_range[0] &&
                          deviation <= deviation_range[1];
      selected(v, u) = inside ? 255 : 0;
    }
  }
  return selected;
}

double density_percent(const cv::Mat1f& disparity, const cv::Mat1b& mask) {
  cv::Mat1b valid;
  cv::compare(disparity, 0.0, valid, cv::CMP_GE);
  return 100.0 * cv::countNonZero(valid & mask) / cv::countNonZero(mask);
}

TEST(RealScenes, ShadowsWithoutTextureEndInvalidAndLitGroundDoesNot) {
  for (const char* name : {"crater_9m_25ms", "crater_9m_300ms", "crater_1m_25ms"}) {
    BRINK_REQUIRE_DATA(folder, name);
    const cv::Mat1b left = read_grey(folder + "/image_0/000000.png");
    const cv::Mat1b right = read_grey(folder + "/image_1/000000.png");
    const cv::Mat1b dark = select_surroundings(left, {0.0, 9.0}, {0.0, 0.7});
    cv::Mat1b lit = select_surroundings(left, {30.0, 255.0}, {2.0, 255.0});
    lit.rowRange(0, 300) = 0;  // walls and lamps
    lit.colRange(0, 290) = 0;  // not in the right picture
    DisparityParams paper;
    paper.elas = ElasParams::paper();
    const cv::Mat1f with_tests = compute_disparity(left, right);
    const cv::Mat1f without_tests = compute_disparity(left, right, paper);
    fmt::print(
        "{:16} shadow density: elas {:.2f} %, elas-paper {:.2f} %; lit ground density: elas {:.2f} %, elas-paper {:.2f} %\n",
        name, density_percent(with_tests, dark), density_percent(without_tests, dark), density_percent(with_tests, lit),
        density_percent(without_tests, lit));
    EXPECT_LT(density_percent(with_tests, dark), 1.0) << name;
    EXPECT_GT(density_percent(with_tests, lit), density_percent(without_tests, lit)) << name;
  }
}

/// Root mean square distances, px, of the disparities in 21x21 px windows from the plane fitted to each; only windows that are
/// fully valid and lie on the road.
std::vector<double> plane_residuals(const cv::Mat1f& disparity, const cv::Mat1b& road) {
  constexpr int kReach = 10;
  constexpr double kCount = 21.0 * 21.0;
  constexpr double kSquares = kCount * (21.0 * 21.0 - 1.0) / 12.0;  // sum of x^2 over the window, equal for both axes
  std::vector<double> residuals;
  for (int v = kReach; v < disparity.rows - kReach; v += 15) {
    for (int u = kReach; u < disparity.cols - kReach; u += 15) {
      const cv::Mat1f window = disparity(cv::Rect(u - kReach, v - kReach, 21, 21));
      if (road(v, u) == 0 || cv::countNonZero(window == kInvalidDisparity) > 0) continue;
      const double mean = cv::mean(window)[0];
      double along_u = 0.0;
      double along_v = 0.0;
      double squares = 0.0;
      for (int j = -kReach; j <= kReach; ++j) {
        for (int i = -kReach; i <= kReach; ++i) {
          const double d = disparity(v + j, u + i) - mean;
          along_u += i * d;
          along_v += j * d;
          squares += d * d;
        }
      }
      const double explained = (along_u * along_u + along_v * along_v) / kSquares;
      residuals.push_back(std::sqrt(std::max(0.0, squares - explained) / kCount));
    }
  }
  std::sort(residuals.begin(), residuals.end());
  return residuals;
}

/// Length of the mean of exp(2 pi i d): 0 when the fractions of the disparities are spread evenly, 1 when all are equal.
double pixel_locking(const cv::Mat1f& disparity, const cv::Mat1b& road) {
  double cosine = 0.0;
  double sine = 0.0;
  double count = 0.0;
  for (int v = 0; v < disparity.rows; ++v) {
    for (int u = 0; u < disparity.cols; ++u) {
      if (road(v, u) == 0 || disparity(v, u) == kInvalidDisparity) continue;
      cosine += std::cos(2.0 * CV_PI * disparity(v, u));
      sine += std::sin(2.0 * CV_PI * disparity(v, u));
      count += 1.0;
    }
  }
  return std::hypot(cosine, sine) / count;
}

TEST(RealScenes, RoadIsDenseSmoothAndFreeOfPixelLocking) {
  for (const char* name : {"pothole_a", "pothole_b"}) {
    BRINK_REQUIRE_DATA(folder, name);
    const cv::Mat1b left = read_grey(folder + "/image_2/000000.png");
    const cv::Mat1b right = read_grey(folder + "/image_3/000000.png");
    cv::Mat1b hole;
    cv::dilate(cv::imread(folder + "/negative/000000.png", cv::IMREAD_UNCHANGED), hole, cv::Mat1b::ones(41, 41));
    cv::Mat1b road;
    cv::compare(hole, 0, road, cv::CMP_EQ);
    road.colRange(0, 170) = 0;  // not in the right picture
    for (const char* matcher : {"elas", "bm", "sgbm", "sgbm-wls"}) {
      DisparityParams params;
      params.matcher = matcher_from_string(matcher);
      const cv::Mat1f disparity = compute_disparity(left, right, params);
      const std::vector<double> residuals = plane_residuals(disparity, road);
      const double median = residuals.empty() ? std::nan("") : residuals[residuals.size() / 2];
      fmt::print("{} {:8} road density {:.2f} %, plane residual median {:.3f} px of {} windows, pixel locking {:.3f}\n", name,
                 matcher, density_percent(disparity, road), median, residuals.size(), pixel_locking(disparity, road));
      if (params.matcher != Matcher::elas) continue;
      EXPECT_GT(density_percent(disparity, road), 99.0) << name;
      EXPECT_LT(median, 0.11) << name;
      EXPECT_LT(pixel_locking(disparity, road), 0.02) << name;
    }
  }
}

}  // namespace
}  // namespace brink
