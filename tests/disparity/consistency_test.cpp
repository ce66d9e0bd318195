#include "disparity/consistency.hpp"

#include <gtest/gtest.h>

#include "brink/disparity.hpp"
#include "reference/consistency.hpp"
#include "simd_targets.hpp"

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

TEST(Consistency, EqualsItsTwinOnEveryTarget) {
  cv::RNG random(3);
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(7, 3), cv::Size(67, 9)}) {
    cv::Mat1f left(size);
    cv::Mat1f right(size);
    for (cv::Mat1f* view : {&left, &right}) {
      random.fill(*view, cv::RNG::UNIFORM, -2.0F, 12.0F);
      view->setTo(kNone, *view < 0.0F);
    }
    const cv::Mat1f expected = reference::naive_consistency(left, right, 2.0F);
    ASSERT_TRUE(size.width < 60 || cv::countNonZero(expected != kNone) > 20) << "some are confirmed";
    test::for_each_target(
        [&] { EXPECT_EQ(cv::norm(check_consistency(left, right, 2.0F), expected, cv::NORM_INF), 0.0) << size; });
  }
}

TEST(Consistency, EmptyStaysEmpty) { EXPECT_TRUE(check_consistency(cv::Mat1f(), cv::Mat1f(), 2.0F).empty()); }

}  // namespace
}  // namespace brink
