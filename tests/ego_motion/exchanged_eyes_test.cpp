#include "ego_motion/exchanged_eyes.hpp"

#include <string>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "brink/detector.hpp"
#include "brink/sequence.hpp"
#include "synthetic_pair.hpp"
#include "test_data.hpp"

namespace brink {
namespace {

TEST(ExchangedEyes, AreToldByTheSideOfWhatBothPicturesShow) {
  const test::Pair pair = test::make_ground_pair(true);
  EXPECT_EQ(find_exchanged_eyes(pair.left, pair.right, {}), "");
  const std::string reason = find_exchanged_eyes(pair.right, pair.left, {});
  EXPECT_TRUE(reason.starts_with("left and right seem to be exchanged: ")) << reason;
}

TEST(ExchangedEyes, AreNotToldWhereLittleOrNothingIsToBeSeen) {
  EXPECT_EQ(find_exchanged_eyes({}, {}, {}), "");
  EXPECT_EQ(find_exchanged_eyes(cv::Mat1b(1, 1, uchar{7}), cv::Mat1b(1, 1, uchar{7}), {}), "");
  EXPECT_EQ(find_exchanged_eyes(cv::Mat1b(121, 163, uchar{7}), cv::Mat1b(121, 163, uchar{9}), {}), "");
  const cv::Mat1b noise = test::make_texture({161, 123}, 1);
  EXPECT_EQ(find_exchanged_eyes(noise, test::make_texture({161, 123}, 2), {}), "") << "nothing in common";
  EXPECT_EQ(find_exchanged_eyes(noise, noise, {}), "") << "all at infinity";
}

TEST(ExchangedEyes, LeaveNoGroundAndNoObstacle) {
  const test::Pair pair = test::make_ground_pair(true);
  DetectorParams params;
  params.stills = true;
  const Detection detection = Detector(params).process(make_frame(pair.right, pair.left, test::half_size_camera()));
  EXPECT_EQ(detection.ground.state, GroundState::not_visible);
  EXPECT_FALSE(detection.ground.plane);
  EXPECT_NE(detection.ground.reason.find("left and right seem to be exchanged"), std::string::npos) << detection.ground.reason;
  EXPECT_TRUE(detection.candidates.empty());
}

class ExchangedEyesOfRealData : public ::testing::TestWithParam<const char*> {};

TEST_P(ExchangedEyesOfRealData, AreToldAndOthersAreNot) {
  BRINK_REQUIRE_DATA(folder, GetParam());
  const Sequence sequence = open_sequence(folder);
  constexpr int kStep = 10;
  for (int position = 0; position < sequence.size(); position += kStep) {
    const Frame frame = sequence.read(position).frame;
    EXPECT_EQ(find_exchanged_eyes(frame.left, frame.right, {}), "") << position;
    EXPECT_NE(find_exchanged_eyes(frame.right, frame.left, {}), "") << position;
  }
}

INSTANTIATE_TEST_SUITE_P(All, ExchangedEyesOfRealData,
                         ::testing::Values("pothole_a", "pothole_b", "crater_1m_25ms", "crater_9m_25ms", "crater_9m_300ms",
                                           "kitti_straight", "euroc_standing"));

}  // namespace
}  // namespace brink
