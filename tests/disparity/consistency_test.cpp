#include "disparity/consistency.hpp"

#include <gtest/gtest.h>

#include "brink/disparity.hpp"

namespace brink {
namespace {

constexpr float kNone = kInvalidDisparity;

TEST(Consistency, KeepsWhatTheRightViewConfirms) {
  //                                     u - d:  -3     -1     0     0     2     5  (none)
  const cv::Mat1f left = (cv::Mat1f(1, 7) << 3.0F, 2.0F, 2.0F, 3.0F, 2.0F, 0.0F, kNone);
  const cv::Mat1f right = (cv::Mat1f(1, 7) << 2.5F, 7.0F, 5.0F, 1.0F, 1.0F, kNone, kNone);
  const cv::Mat1f expected = (cv::Mat1f(1, 7) << kNone, kNone, 2.0F, 3.0F, kNone, kNone, kNone);
  const cv::Mat1f checked = check_consistency(left, right, 2.0F);
  EXPECT_EQ(cv::countNonZero(checked != expected), 0) << checked;
}

TEST(Consistency, NoDisparityInTheRightViewConfirmsNothing) {
  // The marker -1 lies within 2 px of 0 and 1; that must not count.
  const cv::Mat1f left = (cv::Mat1f(1, 2) << 0.0F, 1.0F);
  EXPECT_EQ(cv::countNonZero(check_consistency(left, cv::Mat1f(1, 2, kNone), 2.0F) != kNone), 0);
}

TEST(Consistency, ThresholdItselfIsAllowed) {
  const cv::Mat1f left(1, 1, 0.0F);
  EXPECT_EQ(check_consistency(left, cv::Mat1f(1, 1, 2.0F), 2.0F)(0, 0), 0.0F);
  EXPECT_EQ(check_consistency(left, cv::Mat1f(1, 1, 2.1F), 2.0F)(0, 0), kNone);
}

TEST(Consistency, EmptyStaysEmpty) { EXPECT_TRUE(check_consistency(cv::Mat1f(), cv::Mat1f(), 2.0F).empty()); }

}  // namespace
}  // namespace brink
