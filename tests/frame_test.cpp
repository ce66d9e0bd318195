#include "brink/frame.hpp"

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

}  // namespace
}  // namespace brink
