#include "approach.hpp"

#include <gtest/gtest.h>

namespace brink {
namespace {

TEST(Approach, AnEdgeIsReportedUntilTheBearerStandsAtIt) {
  for (const double depth_m : {0.75, 1.5}) {
    for (const double pitch_deg : {25.0, 40.0}) {
      SCOPED_TRACE(testing::Message() << "drop of " << depth_m << " m, pitch " << pitch_deg);
      const test::ApproachResult result =
          test::approach_edge(depth_m, {.pitch_deg = pitch_deg}, {350.0, 319.5, 179.5, 0.12}, {640, 360});
      EXPECT_EQ(result.reported, result.frames) << "down to " << result.nearest_reported_m << " m";
      EXPECT_EQ(result.silent, 0);
      EXPECT_LE(result.worst_height_error_m, 0.05);
    }
  }
}

TEST(Approach, ARobotAndACameraOnAPoleAreWarnedToTheEndToo) {
  for (const test::Stand& stand :
       {test::Stand{.height_m = 0.28, .pitch_deg = 20.0}, test::Stand{.height_m = 2.5, .pitch_deg = 40.0}}) {
    SCOPED_TRACE(testing::Message() << "camera " << stand.height_m << " m up");
    const test::ApproachResult result = test::approach_edge(0.75, stand, {350.0, 319.5, 179.5, 0.12}, {640, 360});
    EXPECT_EQ(result.reported, result.frames) << "down to " << result.nearest_reported_m << " m";
    EXPECT_EQ(result.silent, 0);
    EXPECT_LE(result.worst_height_error_m, 0.05);
  }
}

}  // namespace
}  // namespace brink
