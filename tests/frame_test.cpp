#include "brink/frame.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "expect_error.hpp"

namespace brink {
namespace {

const StereoCamera kCamera{400.0, 320.0, 180.0, 0.15};

std::string refusal(const cv::Mat& left, const cv::Mat& right, const StereoCamera& camera = kCamera) {
  return test::error_of<std::invalid_argument>([&] { make_frame(left, right, camera); });
}

TEST(MakeFrame, KeepsGreyPicturesAndHasNoColour) {
  const cv::Mat left(40, 50, CV_8UC1, cv::Scalar(7));
  const cv::Mat right(40, 50, CV_8UC1, cv::Scalar(9));
  const Frame frame = make_frame(left, right, kCamera, 3, 0.25);
  EXPECT_EQ(frame.index, 3);
  EXPECT_EQ(frame.time, 0.25);
  EXPECT_EQ(cv::norm(frame.left, left), 0.0);
  EXPECT_EQ(cv::norm(frame.right, right), 0.0);
  EXPECT_TRUE(frame.left_color.empty());
  EXPECT_FALSE(frame.gravity.has_value());
}

TEST(MakeFrame, TakesColourOnTheLeftAndGreyOnTheRight) {
  const cv::Mat left(40, 50, CV_8UC3, cv::Scalar(255, 0, 0));  // pure blue
  const Frame frame = make_frame(left, cv::Mat(40, 50, CV_8UC1, cv::Scalar(9)), kCamera);
  EXPECT_EQ(frame.left_color(0, 0), cv::Vec3b(255, 0, 0));
  EXPECT_EQ(frame.left(0, 0), 29);  // 0.114 * 255
}

TEST(MakeFrame, AcceptsTheSmallestSize) {
  const cv::Mat picture(kMinImageHeight, kMinImageWidth, CV_8UC1, cv::Scalar(0));
  EXPECT_NO_THROW(make_frame(picture, picture, kCamera));
}

TEST(MakeFrame, RefusesPicturesThatCannotBeMatched) {
  const cv::Mat good(40, 50, CV_8UC1, cv::Scalar(0));
  test::expect_line_with(refusal(cv::Mat(), good), "left picture is empty");
  test::expect_line_with(refusal(good, cv::Mat()), "right picture is empty");
  test::expect_line_with(refusal(cv::Mat(1, 1, CV_8UC1), good), "left picture is 1x1 px, must be at least 32x32");
  test::expect_line_with(refusal(good, cv::Mat(9, 12, CV_8UC1)), "right picture is 12x9 px");
  test::expect_line_with(refusal(good, cv::Mat(41, 50, CV_8UC1)), "pictures differ in size: left 50x40, right 50x41 px");
  test::expect_line_with(refusal(cv::Mat(40, 50, CV_16UC1), good), "left picture has 1 channels of CV_16U");
  test::expect_line_with(refusal(good, cv::Mat(40, 50, CV_8UC4)), "right picture has 4 channels");
  test::expect_line_with(refusal(good, good, {400.0, 320.0, 180.0, 0.0}), "camera baseline = 0");
}

TEST(MakeFrameWithDisparity, KeepsThePictureAndMarksWhatIsNoDisparity) {
  const cv::Mat left(41, 51, CV_8UC3, cv::Scalar(255, 0, 0));
  cv::Mat1f disparity(41, 51, 7.5F);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  const std::array<float, 8> row = {0.0F, -0.5F, kInvalidDisparity, nan, infinity, -infinity, 51.0F, 51.5F};
  std::copy(row.begin(), row.end(), disparity[3]);
  const Frame frame = make_frame_with_disparity(left, disparity, kCamera, 3, 0.25);
  EXPECT_NO_THROW(frame.validate());
  EXPECT_EQ(frame.index, 3);
  EXPECT_EQ(frame.time, 0.25);
  EXPECT_EQ(frame.size(), cv::Size(51, 41));
  EXPECT_EQ(frame.left_color(0, 0), cv::Vec3b(255, 0, 0));
  EXPECT_TRUE(frame.right.empty());
  const std::array<float, 8> expected = {0.0F, -1.0F, -1.0F, -1.0F, -1.0F, -1.0F, 51.0F, -1.0F};
  for (int u = 0; u < 8; ++u) EXPECT_EQ(frame.disparity(3, u), expected[static_cast<std::size_t>(u)]) << u;
  EXPECT_EQ(frame.disparity(3, 8), 7.5F);
  disparity = 9.0F;
  EXPECT_EQ(frame.disparity(3, 8), 7.5F) << "the frame has its own copy";
}

TEST(MakeFrameWithDisparity, DoesWithoutAPicture) {
  const Frame frame = make_frame_with_disparity({}, cv::Mat1f(33, 35, 4.0F), kCamera);
  EXPECT_TRUE(frame.left.empty());
  EXPECT_TRUE(frame.left_color.empty());
  EXPECT_EQ(frame.size(), cv::Size(35, 33));
  EXPECT_NO_THROW(frame.validate());
}

TEST(MakeFrameWithDisparity, RefusesWhatDoesNotFit) {
  const auto fault = [](const cv::Mat& left, const cv::Mat1f& disparity, const StereoCamera& camera = kCamera) {
    return test::error_of<std::invalid_argument>([&] { make_frame_with_disparity(left, disparity, camera); });
  };
  const cv::Mat picture(40, 50, CV_8UC1, cv::Scalar(0));
  const cv::Mat1f disparity(40, 50, 3.0F);
  test::expect_line_with(fault(picture, {}), "disparity image is empty");
  test::expect_line_with(fault(picture, cv::Mat1f(1, 1, 3.0F)), "disparity image is 1x1 px, must be at least 32x32");
  test::expect_line_with(fault(picture, cv::Mat1f(41, 50, 3.0F)),
                         "picture and disparity image differ in size: left 50x40, disparity 50x41 px");
  test::expect_line_with(fault(cv::Mat(40, 50, CV_16UC1), disparity), "left picture has 1 channels of CV_16U");
  test::expect_line_with(fault(picture, disparity, {400.0, 320.0, 180.0, 0.0}), "camera baseline = 0");
}

TEST(Frame, IsRefusedWhenFilledByHandWithWhatDoesNotFit) {
  const auto fault = [](const Frame& frame) { return test::error_of<std::invalid_argument>([&] { frame.validate(); }); };
  test::expect_line_with(fault({}), "left picture is empty");
  Frame frame = make_frame_with_disparity({}, cv::Mat1f(40, 50, 4.0F), kCamera);
  frame.right = cv::Mat1b(40, 50, uchar{0});
  test::expect_line_with(fault(frame), "right picture must be empty");
  frame.right = cv::Mat1b();
  for (const float wrong : {-2.0F, 50.5F, std::numeric_limits<float>::quiet_NaN()}) {
    frame.disparity(7, 7) = wrong;
    test::expect_line_with(fault(frame), "disparity = ");
  }
}

TEST(DisparityFromDepth, FollowsEquation2) {
  // By hand: f b = 400 * 0.15 = 60 px m.
  const cv::Mat1f depth = (cv::Mat1f(1, 4) << 1.0F, 2.0F, 0.5F, 60.0F);
  const cv::Mat1f disparity = disparity_from_depth(depth, kCamera);
  const std::array<float, 4> expected = {60.0F, 30.0F, 120.0F, 1.0F};
  for (int u = 0; u < 4; ++u) EXPECT_FLOAT_EQ(disparity(0, u), expected[static_cast<std::size_t>(u)]);
  EXPECT_NEAR(kCamera.triangulate(10.0, 20.0, disparity(0, 1)).z(), 2.0, 1e-6) << "the inverse";
}

TEST(DisparityFromDepth, HasNoneWhereThereIsNoDepth) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  const cv::Mat1f depth = (cv::Mat1f(2, 3) << 0.0F, nan, infinity, -infinity, -2.0F, 0.009F);
  for (const float d : disparity_from_depth(depth, kCamera)) EXPECT_EQ(d, kInvalidDisparity);
  EXPECT_TRUE(disparity_from_depth({}, kCamera).empty());
  EXPECT_THROW(disparity_from_depth(depth, {}), std::invalid_argument);
}

}  // namespace
}  // namespace brink
