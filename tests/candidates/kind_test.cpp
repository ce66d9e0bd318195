// Stairs, edges and holes told apart by their shape, on scenes made by hand.
#include "candidates/kind.hpp"

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "brink/disparity.hpp"
#include "candidates/floor.hpp"
#include "synthetic_scene.hpp"

namespace brink {
namespace {

/// How deep the ground lies at a place ahead of and to the right of the camera's foot, m.
using Depth = std::function<double(double, double)>;

/// Stairs that go down ahead, 2 m wide, with a landing and a wall at the end.
Depth make_stairs(double begin, int steps, double rise, double tread) {
  return [=](double ahead, double aside) {
    const double end = begin + steps * tread + 1.2;
    if (ahead < begin || ahead > end || std::abs(aside) > 1.0) return 0.0;
    return rise * std::min(steps, static_cast<int>((ahead - begin) / tread) + 1);
  };
}

Depth make_pit(double near, double far, double half_width, double depth) {
  return [=](double ahead, double aside) { return ahead < near || ahead > far || std::abs(aside) > half_width ? 0.0 : depth; };
}

Depth make_edge(double distance, double depth) {
  return [=](double ahead, double /*aside*/) { return ahead < distance ? 0.0 : depth; };
}

/// Seen by a camera 1.6 m up, pitched down by 30 degrees.
class Kind : public testing::Test {
 protected:
  /// Follows every ray down in steps of 5 mm of height until it is below the ground.
  void see(const Depth& depth) {
    disparity_ = cv::Mat1f(test::half_size(), kInvalidDisparity);
    for (int v = 0; v < disparity_.rows; ++v) {
      for (int u = 0; u < disparity_.cols; ++u) {
        const auto point = pose_.intersect(u, v, camera_);
        if (!point) continue;
        const double ahead = pose_.forward.dot(*point);
        const double aside = pose_.right.dot(*point);
        double below = 0.0;
        const auto stretch = [&] { return 1.0 + below / pose_.height_m; };
        while (below < depth(ahead * stretch(), aside * stretch())) below += 0.005;
        disparity_(v, u) = static_cast<float>(plane_.disparity(u, v) / stretch());
      }
    }
    elevation_ = compute_elevation(disparity_, plane_, camera_);
  }
  [[nodiscard]] GroundSurface surface() const {
    GroundSurface surface;
    surface.plane = plane_;
    surface.pose = pose_;
    return surface;
  }
  /// The kinds of all accepted candidates.
  [[nodiscard]] std::vector<ObstacleKind> kinds() const {
    const Frame frame =
        make_frame(cv::Mat3b(test::half_size(), cv::Vec3b(10, 10, 10)), cv::Mat1b(test::half_size(), 10), camera_);
    std::vector<ObstacleKind> kinds;
    for (const auto& select : {select_below_ground, select_no_disparity}) {
      for (const Candidate& candidate : select(frame, disparity_, elevation_, surface(), params_)) {
        if (!candidate.rejection) kinds.push_back(candidate.kind);
      }
    }
    return kinds;
  }
  [[nodiscard]] Region region_below(double elevation_m) const {
    const std::vector<Region> regions = find_regions(cv::Mat1b(elevation_ < elevation_m), 1);
    return regions.at(0);
  }
  [[nodiscard]] Floor floor() const { return measure_floor(region_below(-0.06), disparity_, elevation_, camera_, pose_); }

  StereoCamera camera_ = test::half_size_camera();
  GroundPlane plane_ = make_ground_plane(1.6, 30.0, 0.0, camera_);
  GroundPose pose_ = compute_ground_pose(plane_, camera_);
  cv::Mat1f disparity_;
  cv::Mat1f elevation_;
  CandidateParams params_;
};

const std::vector<ObstacleKind> kStairs{ObstacleKind::stairs_down};
const std::vector<ObstacleKind> kEdge{ObstacleKind::edge};
const std::vector<ObstacleKind> kHole{ObstacleKind::hole};
const std::vector<ObstacleKind> kUnknown{ObstacleKind::unknown};

TEST_F(Kind, StairsOfAllUsualStepsAreStairs) {
  see(make_stairs(1.3, 8, 0.17, 0.29));
  EXPECT_EQ(kinds(), kStairs);
  see(make_stairs(1.3, 10, 0.14, 0.34));
  EXPECT_EQ(kinds(), kStairs);
  see(make_stairs(1.3, 8, 0.20, 0.26));
  EXPECT_EQ(kinds(), kStairs);
}

// The ray over the edge falls by 22 degrees at 4 m, less than the stairs: no tread is seen.
TEST_F(Kind, StairsWhoseTreadsAreHiddenAreNotKnown) {
  see(make_stairs(4.0, 8, 0.17, 0.29));
  EXPECT_EQ(kinds(), kUnknown);
}

TEST_F(Kind, APlatformAndAKerbAreEdges) {
  for (const double depth : {0.16, 0.25, 1.0}) {
    for (const double distance : {1.5, 2.5, 3.5}) {
      SCOPED_TRACE(testing::Message() << depth << " m at " << distance << " m");
      see(make_edge(distance, depth));
      EXPECT_EQ(kinds(), kEdge);
    }
  }
}

TEST_F(Kind, WhatHasGroundAllAroundIsAHole) {
  for (const double depth : {0.2, 0.5, 1.5}) {
    SCOPED_TRACE(depth);
    see(make_pit(2.0, 2.7, 0.35, depth));
    EXPECT_EQ(kinds(), kHole);
    see(make_pit(2.0, 2.6, 1.2, depth));  // a trench across
    EXPECT_EQ(kinds(), kHole);
  }
}

TEST_F(Kind, AHoleStaysOneWhileItLeavesThePicture) {
  see(make_pit(0.8, 1.5, 0.35, 0.5));  // the picture's lower border is 1.03 m ahead
  EXPECT_EQ(kinds(), kHole);
}

TEST_F(Kind, InADeepLongOpeningStairsMayBeHidden) {
  see(make_pit(3.0, 7.0, 1.0, 1.4));
  EXPECT_EQ(kinds(), kUnknown);
  see(make_pit(3.0, 7.0, 1.0, 0.4));  // less than three steps
  EXPECT_EQ(kinds(), kHole);
}

TEST_F(Kind, BlackWithGroundAllAroundIsAHole) {
  see(make_edge(100.0, 1.0));
  const cv::Rect black(300, 200, 40, 20);
  disparity_(black).setTo(kInvalidDisparity);
  elevation_(black).setTo(std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(kinds(), kHole);
}

// A dark corner of something deeper.
TEST_F(Kind, BlackBesideWhatIsBelowTheGroundIsNotKnown) {
  see(make_edge(2.0, 1.0));
  const cv::Rect black(300, 100, 40, 20);
  disparity_(black).setTo(kInvalidDisparity);
  elevation_(black).setTo(std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(kinds(), (std::vector{ObstacleKind::edge, ObstacleKind::unknown}));
}

TEST_F(Kind, ThePapersMethodTellsNone) {
  params_ = CandidateParams::paper();
  see(make_pit(2.0, 2.7, 0.35, 0.5));
  EXPECT_EQ(kinds(), kUnknown);
}

TEST_F(Kind, RejectedRegionsHaveNone) {
  params_.below_ground_min_area_px = 100000;
  see(make_pit(2.0, 2.7, 0.35, 0.5));
  const Frame frame = make_frame(cv::Mat1b(test::half_size(), 10), cv::Mat1b(test::half_size(), 10), camera_);
  const auto candidates = select_below_ground(frame, disparity_, elevation_, surface(), params_);
  ASSERT_EQ(candidates.size(), 1U);
  ASSERT_TRUE(candidates[0].rejection);
  EXPECT_EQ(candidates[0].kind, ObstacleKind::unknown);
}

/// A region of 40x20 px in ground at height 0, with a disparity everywhere.
class GroundShare : public testing::Test {
 protected:
  [[nodiscard]] std::optional<double> share() const {
    return compute_ground_share(find_regions(cv::Mat1b(elevation_ < -0.3F), 1).at(0), none_, elevation_, 3, -0.06, 0.10);
  }
  cv::Mat1f elevation_ = cv::Mat1f(60, 80, 0.0F);
  cv::Mat1b none_ = cv::Mat1b(60, 80, uchar{0});
  const cv::Rect inside_{20, 20, 40, 20};
};

TEST_F(GroundShare, IsOneInTheGroundWhateverIsInside) {
  elevation_(inside_).setTo(-0.5F);
  EXPECT_EQ(share(), 1.0);
  elevation_(cv::Rect(30, 25, 6, 6)).setTo(0.5F);
  EXPECT_EQ(share(), 1.0);
}

TEST_F(GroundShare, CountsWhatIsHigherLowerOrUnknownAsNoGround) {
  elevation_(inside_).setTo(-0.5F);
  elevation_(cv::Rect(19, 19, 42, 1)).setTo(0.11F);  // 42 of the 2 * 42 + 2 * 20 pixels around
  EXPECT_EQ(share(), 82.0 / 124.0);
  elevation_(cv::Rect(19, 40, 42, 1)).setTo(-0.07F);
  EXPECT_EQ(share(), 40.0 / 124.0);
}

TEST_F(GroundShare, CrossesGapsWithoutDisparityUpToAWidth) {
  elevation_(inside_).setTo(-0.5F);
  for (const int gap : {3, 4}) {
    const cv::Rect band(20 - gap, 20, gap, 20);
    elevation_(band).setTo(std::numeric_limits<float>::quiet_NaN());
    none_(band).setTo(255);
    EXPECT_EQ(share() == 1.0, gap == 3) << gap;
  }
}

TEST_F(GroundShare, CountsOnlyWhatIsInThePicture) {
  elevation_(cv::Rect(0, 40, 40, 20)).setTo(-0.5F);  // in a corner
  EXPECT_EQ(share(), 1.0);
}

TEST_F(GroundShare, IsEmptyForSpecksAndWithoutASurrounding) {
  elevation_(cv::Rect(30, 30, 3, 3)).setTo(-0.5F);  // 16 pixels around
  EXPECT_FALSE(share());
  elevation_.setTo(-0.5F);
  EXPECT_FALSE(share());
}

TEST_F(Kind, TheLengthOfAnOpeningIsItsLongerSideHoweverItLies) {
  EXPECT_EQ(compute_opening_length_m({}, pose_), 0.0);
  for (const double degrees : {0.0, 25.0, 90.0}) {
    const double turn = degrees * std::numbers::pi / 180.0;
    const Eigen::Vector3d along = std::cos(turn) * pose_.forward + std::sin(turn) * pose_.right;
    const Eigen::Vector3d across = pose_.down.cross(along);
    const Eigen::Vector3d corner = pose_.height_m * pose_.down + 2.0 * pose_.forward;
    const std::vector<Eigen::Vector3d> rim{corner, corner + 3.0 * along, corner + 3.0 * along + across, corner + across};
    EXPECT_NEAR(compute_opening_length_m(rim, pose_), 3.0, 1e-5);
  }
}

TEST_F(Kind, TheFloorOfAPitIsLevelAndItsWallsAreNoFloor) {
  see(make_pit(1.5, 3.0, 0.75, 0.6));
  const Floor pit = floor();
  EXPECT_EQ(pit.stairs_share, 0.0);
  EXPECT_GT(pit.level_share, 0.6);
  EXPECT_LT(pit.level_share, 0.95);
}

TEST_F(Kind, TheFloorOfStairsFallsAwayExceptItsLanding) {
  see(make_stairs(1.3, 8, 0.17, 0.29));
  const Floor stairs = floor();
  EXPECT_GT(stairs.stairs_share, 0.3);
  EXPECT_LT(stairs.stairs_share, 0.9);
  EXPECT_GT(stairs.level_share, 0.1);
}

TEST_F(Kind, AFewPixelsShowNoFloor) {
  see(make_pit(2.0, 2.2, 0.1, 0.5));
  const Floor speck = floor();
  EXPECT_EQ(speck.stairs_share, 0.0);
  EXPECT_EQ(speck.level_share, 0.0);
}

TEST(ObstacleKinds, HaveTheNamesOfTheFormat) {
  EXPECT_EQ(to_string(ObstacleKind::unknown), "unknown");
  EXPECT_EQ(to_string(ObstacleKind::stairs_down), "stairs_down");
  EXPECT_EQ(to_string(ObstacleKind::edge), "edge");
  EXPECT_EQ(to_string(ObstacleKind::hole), "hole");
}

}  // namespace
}  // namespace brink
