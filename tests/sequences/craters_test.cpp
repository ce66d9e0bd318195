// The lunar test bed: a crater that is 8 to 10 cm deep, seen at two exposures.

#include <algorithm>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "brink/detector.hpp"
#include "brink/sequence.hpp"
#include "test_data.hpp"

namespace brink {
namespace {

Detection detect(const std::string& folder) {
  DetectorParams params;
  params.stills = true;
  params.candidates.min_depth_m = 0.06;
  const FrameReading reading = open_sequence(folder).read(0);
  EXPECT_EQ(reading.status, FrameStatus::ok) << reading.reason;
  return Detector(params).process(reading.frame);
}

bool surrounds(const Candidate& candidate, const cv::Point2f& place) {
  return cv::pointPolygonTest(candidate.contour, place, false) >= 0.0;
}

TEST(Craters, TheLitCraterIsType1AndAsDeepAsItIs) {
  BRINK_REQUIRE_DATA(folder, "crater_9m_300ms");
  const Detection detection = detect(folder);
  EXPECT_EQ(detection.ground.state, GroundState::seen);
  const auto crater = std::ranges::find_if(detection.obstacles, [](const NegativeObstacle& obstacle) {
    return obstacle.candidate.type == CandidateType::below_ground && surrounds(obstacle.candidate, {513.0F, 424.0F});
  });
  ASSERT_NE(crater, detection.obstacles.end());
  fmt::print("crater: {:.3f} m deep, rim {:.2f} m away, {:.2f} m wide\n", *crater->candidate.depth_m,
             crater->candidate.distance_m, crater->candidate.width_m);
  EXPECT_GE(*crater->candidate.depth_m, 0.06);
  EXPECT_LE(*crater->candidate.depth_m, 0.11);
}

TEST(Craters, ShadowsAreNotReportedAsDeepHoles) {
  BRINK_REQUIRE_DATA(folder, "crater_9m_25ms");
  const Detection detection = detect(folder);
  EXPECT_EQ(detection.ground.state, GroundState::seen);
  int below_ground = 0;
  for (const NegativeObstacle& obstacle : detection.obstacles) {
    if (obstacle.candidate.type != CandidateType::below_ground) continue;
    ++below_ground;
    EXPECT_LT(*obstacle.candidate.depth_m, 0.12) << obstacle.candidate.distance_m << " m away";
  }
  fmt::print("obstacles: {} below_ground, {} no_disparity\n", below_ground,
             detection.obstacles.size() - static_cast<std::size_t>(below_ground));
}

}  // namespace
}  // namespace brink
