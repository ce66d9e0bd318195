#include "brink/overlay.hpp"

#include <limits>
#include <optional>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace brink {
namespace {

const cv::Vec3b kPlain(100, 100, 100);

// 320x240, grey level 100, the ground seen; nothing else.
Frame plain_frame() {
  Frame frame;
  frame.left = cv::Mat1b(240, 320, uchar{100});
  frame.right = frame.left;
  frame.camera = {300.0, 160.0, 120.0, 0.15};
  return frame;
}

Detection seen_ground() {
  Detection detection;
  detection.ground.state = GroundState::seen;
  detection.ground.plane = GroundPlane{0.0, 0.1, 5.0};
  detection.ground.pose.height_m = 1.6;
  return detection;
}

Candidate square(int left, int top, int side) {
  Candidate candidate;
  candidate.contour = {{left, top}, {left + side, top}, {left + side, top + side}, {left, top + side}};
  candidate.distance_m = 2.0;
  return candidate;
}

// Whether anything was drawn in a part of the picture.
bool touched(const cv::Mat3b& picture, const cv::Rect& part) {
  for (const cv::Vec3b& pixel : cv::Mat3b(picture(part))) {
    if (pixel != kPlain) return true;
  }
  return false;
}

bool is_green(const cv::Vec3b& pixel) { return pixel[1] > pixel[0] + 30 && pixel[1] > pixel[2] + 30; }
bool is_near(const cv::Vec3b& pixel, const cv::Vec3b& color) {
  return cv::norm(pixel, color, cv::NORM_INF) < 25;
}  // smooth lines
bool is_red(const cv::Vec3b& pixel) { return pixel[2] > pixel[0] + 30 && pixel[2] > pixel[1] + 30; }

TEST(DrawGround, TintsGroundGreenAndBelowRedAndLeavesTheRest) {
  Detection detection = seen_ground();
  detection.elevation = cv::Mat1f(240, 320, std::numeric_limits<float>::quiet_NaN());
  detection.elevation(cv::Rect(0, 100, 320, 20)) = 0.05F;
  detection.elevation(cv::Rect(0, 140, 320, 20)) = -0.2F;
  detection.elevation(cv::Rect(0, 180, 320, 20)) = 0.5F;
  const cv::Mat3b picture = draw_ground(plain_frame(), detection);
  EXPECT_TRUE(is_green(picture(110, 50)));
  EXPECT_TRUE(is_red(picture(150, 50)));
  EXPECT_EQ(picture(190, 50), kPlain);
  EXPECT_EQ(picture(220, 50), kPlain);  // NaN
}

TEST(DrawGround, UsesTheDepthThatDetectionUsed) {
  Detection detection = seen_ground();
  detection.elevation = cv::Mat1f(240, 320, -0.02F);
  CandidateParams params;
  EXPECT_TRUE(is_green(draw_ground(plain_frame(), detection, params)(150, 50)));
  params.min_depth_m = 0.01;
  EXPECT_TRUE(is_red(draw_ground(plain_frame(), detection, params)(150, 50)));
}

TEST(DrawGround, WritesTheStateAtTheTop) {
  EXPECT_TRUE(touched(draw_ground(plain_frame(), seen_ground()), {0, 0, 320, 40}));
  EXPECT_FALSE(touched(draw_ground(plain_frame(), seen_ground()), {0, 40, 320, 200}));
}

TEST(DrawDisparity, PaintsNoneBlackAndNearRedderThanFar) {
  cv::Mat1f disparity(240, 320, -1.0F);
  disparity(cv::Rect(0, 100, 150, 60)) = 10.0F;
  disparity(cv::Rect(0, 180, 150, 60)) = 50.0F;
  const cv::Mat3b picture = draw_disparity(disparity);
  EXPECT_EQ(picture(50, 50), cv::Vec3b(0, 0, 0));
  EXPECT_GT(picture(210, 50)[2], picture(130, 50)[2]);
  EXPECT_NE(picture(130, 50), cv::Vec3b(0, 0, 0));
}

TEST(DrawDisparity, DrawsAnythingThereIs) {
  EXPECT_TRUE(draw_disparity(cv::Mat1f()).empty());
  EXPECT_EQ(draw_disparity(cv::Mat1f(1, 1, -1.0F)).size(), cv::Size(1, 1));
  EXPECT_EQ(draw_disparity(cv::Mat1f(9, 12, 3.0F)).size(), cv::Size(12, 9));
}

TEST(DrawCandidates, MarksTypesByColour) {
  Detection detection = seen_ground();
  detection.candidates = {square(50, 60, 40), square(200, 60, 40)};
  detection.candidates[1].type = CandidateType::no_disparity;
  detection.rejected = {square(50, 160, 40)};
  detection.rejected[0].rejection = Rejection{"area", 100, 150};
  const cv::Mat3b picture = draw_candidates(plain_frame(), detection);
  EXPECT_TRUE(is_near(picture(60, 70), cv::Vec3b(255, 255, 0)));   // cyan
  EXPECT_TRUE(is_near(picture(60, 220), cv::Vec3b(255, 0, 255)));  // magenta
  EXPECT_TRUE(is_near(picture(160, 70), cv::Vec3b(160, 160, 160)));
  EXPECT_TRUE(touched(picture, {92, 150, 40, 30}));  // the rule beside it
  EXPECT_EQ(picture(80, 70), kPlain);                // inside
}

TEST(DrawObstacles, FillsThemAndWritesTheDistanceBeside) {
  Detection detection = seen_ground();
  detection.obstacles = {{1, square(100, 100, 40), 1, 0.0, {}, {}}};
  const cv::Mat3b picture = draw_obstacles(plain_frame(), detection);
  EXPECT_TRUE(is_red(picture(120, 120)));
  EXPECT_TRUE(touched(picture, {145, 100, 60, 40}));
  EXPECT_FALSE(touched(picture, {0, 150, 320, 90}));
}

TEST(DrawObstacles, KeepsTheDistanceInsideThePicture) {
  Detection detection = seen_ground();
  detection.obstacles = {{1, square(275, 195, 40), 1, 0.0, {}, {}}};
  EXPECT_TRUE(touched(draw_obstacles(plain_frame(), detection), {215, 195, 55, 40}));
}

TEST(Overlays, LeaveTheFrameAlone) {
  Frame frame = plain_frame();
  frame.left_color = cv::Mat3b(frame.left.size(), kPlain);
  Detection detection = seen_ground();
  detection.obstacles = {{1, square(100, 100, 40), 1, 0.0, {}, {}}};
  (void)draw_obstacles(frame, detection);
  EXPECT_FALSE(touched(frame.left_color, {0, 0, 320, 240}));
}

TEST(Overlays, ShowThePlainPictureWhenNothingIsKnown) {
  const Detection detection = make_failed_detection(0, 0.0, FrameStatus::bad_frame, "x.png: is damaged");
  for (const cv::Mat3b& picture : {draw_ground(plain_frame(), detection), draw_obstacles(plain_frame(), detection)}) {
    EXPECT_FALSE(touched(picture, {0, 40, 320, 200}));
  }
  EXPECT_FALSE(touched(draw_candidates(plain_frame(), detection), {0, 0, 320, 240}));
  EXPECT_TRUE(draw_ground(Frame{}, detection).empty());
}

TEST(Overlays, DrawOnDisparitiesWhereThereIsNoPicture) {
  cv::Mat1f disparity(240, 320, 20.0F);
  disparity(200, 10) = 40.0F;
  disparity(200, 20) = kInvalidDisparity;
  const Frame frame = make_frame_with_disparity({}, disparity, {300.0, 160.0, 120.0, 0.15});
  Detection detection = seen_ground();
  detection.obstacles = {{1, square(100, 100, 40), 1, 0.0, {}, {}}};
  const cv::Mat3b picture = draw_obstacles(frame, detection);
  ASSERT_EQ(picture.size(), cv::Size(320, 240));
  EXPECT_EQ(picture(200, 10), cv::Vec3b(255, 255, 255));
  EXPECT_EQ(picture(200, 20), cv::Vec3b(0, 0, 0));
  EXPECT_EQ(picture(200, 30), cv::Vec3b(128, 128, 128));
  EXPECT_GT(picture(120, 120)[2], picture(120, 120)[0]) << "the obstacle is red";
}

// 15 cm are log(0.15 / 0.02) / log(3 / 0.02) = 40 % of the way down the 440 rows from row 50, and 2 to 6 m of 8 half of the
// width.
TEST(EnvelopeDiagram, TintsWhatLiesBelowTheLine) {
  const auto draw = [](const std::optional<double>& depth_m) {
    return draw_envelope({{"hole", {{2.0, depth_m}, {6.0, depth_m}, {8.0, std::nullopt}}}}, "title");
  };
  const cv::Mat3b with_line = draw(0.15);
  cv::Mat1b changed;
  cv::cvtColor(cv::Mat(with_line != draw(std::nullopt)), changed, cv::COLOR_BGR2GRAY);
  const cv::Rect tinted = cv::boundingRect(changed);
  EXPECT_NEAR(tinted.y, 50 + 0.402 * 440, 5);
  EXPECT_NEAR(tinted.br().y, 50 + 440, 5);
  EXPECT_NEAR(tinted.width, 410, 10);
}

TEST(Overlays, DrawTheSmallestPictures) {
  Frame frame = plain_frame();
  frame.left = cv::Mat1b(32, 32, uchar{0});
  Detection detection = seen_ground();
  detection.obstacles = {{1, square(1, 1, 30), 1, 0.0, {}, {}}};
  EXPECT_EQ(draw_obstacles(frame, detection).size(), cv::Size(32, 32));
  EXPECT_EQ(draw_ground(frame, detection).size(), cv::Size(32, 32));
}

}  // namespace
}  // namespace brink
