#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "brink/truth.hpp"
#include "expect_error.hpp"
#include "io/rim_scene.hpp"

namespace brink {
namespace {

using test::ground_with_box;
using test::kCamera;
using test::kSize;
using test::on_ground;

RimSighting sight(const std::vector<Eigen::Vector2d>& opening, const cv::Mat1f& disparity = {}) {
  return find_nearest_rim(on_ground(opening), kCamera, kSize, disparity);
}

TEST(FindNearestRim, MeasuresOnTheGroundFromTheFootOfTheCamera) {
  const RimSighting rim = sight({{-0.5, 3.0}, {0.5, 3.0}, {0.5, 4.0}, {-0.5, 4.0}});
  EXPECT_TRUE(rim.visible);
  EXPECT_NEAR(rim.distance_m, 3.0, 1e-9);
  EXPECT_NEAR(rim.bearing_deg, 0.0, 1e-6);
}

TEST(FindNearestRim, TellsBearingsPositiveToTheRight) {
  // The corner (1, 2) is nearest: 26.565 degrees to the right, sqrt(5) m away.
  const RimSighting rim = sight({{1.0, 2.0}, {2.0, 2.0}, {2.0, 3.0}, {1.0, 3.0}});
  EXPECT_NEAR(rim.distance_m, std::sqrt(5.0), 1e-9);
  EXPECT_NEAR(rim.bearing_deg, 26.565, 1e-3);
  EXPECT_NEAR(sight({{-1.0, 2.0}, {-2.0, 2.0}, {-2.0, 3.0}, {-1.0, 3.0}}).bearing_deg, -26.565, 1e-3);
}

TEST(FindNearestRim, DoesNotDependOnTheOrderOfThePoints) {
  const std::vector<Eigen::Vector2d> opening{{0.3, 2.0}, {1.0, 2.6}, {0.4, 3.1}, {-0.2, 2.7}};
  const RimSighting rim = sight(opening);
  EXPECT_NEAR(sight({opening.rbegin(), opening.rend()}).distance_m, rim.distance_m, 1e-12);
  EXPECT_NEAR(sight({opening[2], opening[3], opening[0], opening[1]}).bearing_deg, rim.bearing_deg, 1e-9);
}

TEST(FindNearestRim, MeasuresAHoleWithALevelHeadAlike) {
  std::vector<Eigen::Vector3d> opening{{-0.5, 1.6, 4.5}, {0.5, 1.6, 4.5}, {0.5, 1.6, 5.5}, {-0.5, 1.6, 5.5}};
  const RimSighting rim = find_nearest_rim(opening, kCamera, kSize, {});
  EXPECT_TRUE(rim.visible);
  EXPECT_NEAR(rim.distance_m, 4.5, 1e-9);
}

TEST(FindNearestRim, StopsAtTheEdgeOfThePicture) {
  // A trench along the path, from far behind to far ahead. The lowest row, 359.5, sees the ground in the middle at
  // 1.6 / tan(30 + atan(180/350) degrees) = 1.0305 m; at 0.2 m to the right the row is the same.
  const RimSighting rim = sight({{0.2, -50.0}, {0.2, 50.0}, {1.0, 50.0}, {1.0, -50.0}});
  EXPECT_TRUE(rim.visible);
  EXPECT_NEAR(rim.distance_m, std::hypot(0.2, 1.0305), 0.005);
  EXPECT_NEAR(rim.bearing_deg, std::atan2(0.2, 1.0305) * 180.0 / std::numbers::pi, 0.3);
}

TEST(FindNearestRim, TellsTheNearestPointAtAllWhenNoneIsInView) {
  const RimSighting behind = sight({{-0.5, -3.0}, {0.5, -3.0}, {0.5, -2.0}, {-0.5, -2.0}});
  EXPECT_FALSE(behind.visible);
  EXPECT_NEAR(behind.distance_m, 2.0, 1e-9);
  EXPECT_NEAR(std::abs(behind.bearing_deg), 180.0, 1e-6);
  const RimSighting around = sight({{-0.3, -0.4}, {0.3, -0.4}, {0.3, 0.5}, {-0.3, 0.5}});  // standing over the hole
  EXPECT_FALSE(around.visible);
  EXPECT_NEAR(around.distance_m, 0.3, 1e-9);
}

TEST(FindNearestRim, LooksPastWhatStandsInFront) {
  // The front edge spans 2 m at 3 m ahead: 2.598 + 0.8 = 3.398 m deep, so columns 216.5 to 422.5, row 150.
  const std::vector<Eigen::Vector2d> opening{{-1.0, 3.0}, {1.0, 3.0}, {1.0, 4.0}, {-1.0, 4.0}};
  const RimSighting clear = sight(opening, ground_with_box({0, 0, 1, 1}, 1.0));
  EXPECT_NEAR(clear.distance_m, 3.0, 1e-9);
  // A person stands 2 m away before columns 280 to 369: the nearest end of the rest is left of it, 40.5 px from the middle,
  // -0.393 m at that depth.
  const RimSighting rim = sight(opening, ground_with_box({280, 0, 90, 360}, 2.0));
  EXPECT_TRUE(rim.visible);
  EXPECT_NEAR(rim.bearing_deg, std::atan2(-0.393, 3.0) * 180.0 / std::numbers::pi, 0.3);
  EXPECT_NEAR(rim.distance_m, std::hypot(0.393, 3.0), 0.01);
}

TEST(FindNearestRim, DoesNotMindWhatStandsBehindOrHardlyInFront) {
  const std::vector<Eigen::Vector2d> opening{{-1.0, 3.0}, {1.0, 3.0}, {1.0, 4.0}, {-1.0, 4.0}};
  EXPECT_NEAR(sight(opening, ground_with_box({0, 0, 640, 360}, 3.398 - 0.06)).distance_m, 3.0, 1e-9);  // 2 % are 0.068 m
  EXPECT_FALSE(sight(opening, ground_with_box({0, 0, 640, 360}, 3.398 - 0.08)).visible);
  EXPECT_TRUE(sight(opening, ground_with_box({0, 0, 640, 360}, 20.0)).visible);
  EXPECT_TRUE(sight(opening, cv::Mat1f(kSize, 0.0F)).visible);  // nothing there
}

TEST(FindNearestRim, SeesBetweenThinBars) {
  // Every second column is a bar: in 3x3 pixels there is always one that is free.
  cv::Mat1f disparity = ground_with_box({0, 0, 1, 1}, 1.0);
  for (int u = 0; u < kSize.width; u += 2) disparity.col(u) = 50.0F;
  EXPECT_TRUE(sight({{-1.0, 3.0}, {1.0, 3.0}, {1.0, 4.0}, {-1.0, 4.0}}, disparity).visible);
}

TEST(FindNearestRim, FindsTheSmallestDistanceOfAllPointsInView) {
  // Its twin without any shortcut: every point of the edges, a millimetre apart.
  const cv::Mat1f disparity = ground_with_box({200, 0, 150, 360}, 1.2);
  const std::vector<std::vector<Eigen::Vector2d>> openings{{{-0.6, 2.1}, {0.9, 1.7}, {1.4, 3.0}, {0.0, 3.6}},
                                                           {{-2.0, 1.2}, {0.3, 1.1}, {0.4, 1.5}},
                                                           {{-4.0, 0.5}, {3.0, 1.5}, {6.0, 9.0}, {-6.0, 8.0}}};
  for (const auto& opening : openings) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < opening.size(); ++i) {
      const Eigen::Vector2d along = opening[(i + 1) % opening.size()] - opening[i];
      const int steps = static_cast<int>(along.norm() * 1000.0);
      for (int step = 0; step <= steps; ++step) {
        const Eigen::Vector2d point = opening[i] + along * step / steps;
        const Eigen::Vector3d seen = on_ground({point})[0];
        const Eigen::Vector3d pixel = kCamera.project(seen);
        const int u = static_cast<int>(std::lround(pixel.x()));
        const int v = static_cast<int>(std::lround(pixel.y()));
        if (seen.z() < 0.05 || u < 0 || v < 0 || u >= kSize.width || v >= kSize.height) continue;
        bool is_free = false;
        for (int row = std::max(v - 1, 0); row <= std::min(v + 1, kSize.height - 1); ++row) {
          for (int column = std::max(u - 1, 0); column <= std::min(u + 1, kSize.width - 1); ++column) {
            const double depth = kCamera.focal * kCamera.baseline / disparity(row, column);
            is_free = is_free || depth >= seen.z() - std::max(0.05, 0.02 * seen.z());
          }
        }
        if (is_free) nearest = std::min(nearest, point.norm());
      }
    }
    const RimSighting rim = sight(opening, disparity);
    EXPECT_TRUE(rim.visible);
    EXPECT_NEAR(rim.distance_m, nearest, 0.01);
  }
}

TEST(FindNearestRim, IsDoneAtOnceWithARimOfAThousandKilometres) {
  const RimSighting rim = sight({{-5e5, 3.0}, {5e5, 3.0}, {5e5, 1e6}, {-5e5, 1e6}}, cv::Mat1f(kSize, 300.0F));
  EXPECT_FALSE(rim.visible);
  EXPECT_NEAR(rim.distance_m, 3.0, 1e-6);
}

TEST(FindNearestRim, ComesNearerByNoMoreThanTheStepThatTheCameraWalks) {
  double before = 0.0;
  for (int step = 0; step <= 70; ++step) {  // the whole rim stays in view
    const double ahead = 5.0 - 0.05 * step;
    const RimSighting rim = sight({{-0.4, ahead}, {0.5, ahead + 0.2}, {0.3, ahead + 1.0}, {-0.5, ahead + 0.9}});
    EXPECT_TRUE(rim.visible) << ahead;
    if (step > 0) {
      EXPECT_LT(rim.distance_m, before);
      EXPECT_GE(rim.distance_m, before - 0.05 - 1e-9);
    }
    before = rim.distance_m;
  }
}

TEST(FindNearestRim, RefusesWhatHasNoPlane) {
  const auto fault = [](const std::vector<Eigen::Vector3d>& opening, const cv::Mat1f& disparity = {}) {
    return test::error_of<std::invalid_argument>([&] { find_nearest_rim(opening, kCamera, kSize, disparity); });
  };
  test::expect_line_with(fault({}), "opening of 0 points has no plane");
  test::expect_line_with(fault({{0, 1, 2}, {0, 1, 3}}), "opening of 2 points");
  test::expect_line_with(fault({{0, 1, 2}, {0, 1, 3}, {0, 1, 4}}), "opening of 3 points has no plane");
  test::expect_line_with(fault({{0, 1, 2}, {0, 1, 3}, {std::nan(""), 1, 4}}), "has no plane");
  test::expect_line_with(fault(on_ground({{0, 2}, {1, 2}, {1, 3}}), cv::Mat1f(2, 3, 0.0F)),
                         "disparity is 3x2 px, must be 640x360");
}

RimPlace locate(const std::vector<Eigen::Vector2d>& opening) { return locate_rim(on_ground(opening)); }

TEST(LocateRim, TakesTheNearestPointWhetherItIsSeenOrNot) {
  // The lowest row of the image sees the ground 1.03 m ahead: the trench of StopsAtTheEdgeOfThePicture passes 0.2 m to the
  // right of the foot, far below the image.
  const RimPlace trench = locate({{0.2, -50.0}, {0.2, 50.0}, {1.0, 50.0}, {1.0, -50.0}});
  EXPECT_NEAR(trench.distance_m, 0.2, 1e-9);
  EXPECT_NEAR(trench.bearing_deg, 90.0, 1e-6);
  EXPECT_FALSE(trench.is_inside);
  const RimPlace corner = locate({{1.0, 2.0}, {2.0, 2.0}, {2.0, 3.0}, {1.0, 3.0}});
  EXPECT_NEAR(corner.distance_m, std::sqrt(5.0), 1e-9);
  EXPECT_NEAR(corner.bearing_deg, 26.565, 1e-3);
  EXPECT_NEAR(locate({{-0.5, -3.0}, {0.5, -3.0}, {0.5, -2.0}, {-0.5, -2.0}}).bearing_deg, 180.0, 1e-6);
}

TEST(LocateRim, KnowsWhenTheBearerStandsInTheOpening) {
  EXPECT_TRUE(locate({{-0.3, -0.4}, {0.3, -0.4}, {0.3, 0.5}, {-0.3, 0.5}}).is_inside);
  EXPECT_FALSE(locate({{-0.3, 0.01}, {0.3, 0.01}, {0.3, 0.5}, {-0.3, 0.5}}).is_inside);
  // In the notch of a U whose arms reach past the bearer on both sides.
  EXPECT_FALSE(locate({{-2, -1}, {-1, -1}, {-1, 1}, {1, 1}, {1, -1}, {2, -1}, {2, 2}, {-2, 2}}).is_inside);
}

TEST(LocateRim, MeasuresTheHeightOverTheRimBelowItAsNegative) {
  std::vector<Eigen::Vector3d> opening{{-0.5, 1.6, 1.0}, {0.5, 1.6, 1.0}, {0.5, 1.6, 2.0}, {-0.5, 1.6, 2.0}};
  EXPECT_NEAR(locate_rim(opening).height_m, 1.6, 1e-9);
  for (Eigen::Vector3d& point : opening) point.y() = -0.5;
  EXPECT_NEAR(locate_rim(opening).height_m, -0.5, 1e-9);
  EXPECT_NEAR(locate_rim(opening).distance_m, 1.0, 1e-9);
}

TEST(LocateRim, RefusesWhatHasNoPlane) {
  test::expect_line_with(test::error_of<std::invalid_argument>([] {
                           locate_rim({{0, 1, 2}, {0, 1, 3}});
                         }),
                         "opening of 2 points has no plane");
}

}  // namespace
}  // namespace brink
