#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "brink/disparity.hpp"
#include "brink/evaluation.hpp"
#include "expect_error.hpp"

namespace brink {
namespace {

constexpr float kNone = kInvalidDisparity;

TEST(DisparityErrors, AreTheseForARowOfTenPixels) {
  // Truth 10 px but for two pixels that are not known. Of the 8 known ones 6 are valid, off by 0, 0.5, 1, 1.5, 2.5 and 4 px:
  // above 1 px 3 of them, above 2 px 2, above 3 px 1. With the 2 invalid ones as bad: 5, 4 and 3 of 8. Mean 9.5 / 6.
  const cv::Mat1f truth = (cv::Mat1f(1, 10) << 10, 10, 10, 10, 10, 10, 10, 10, 0, 0);
  const cv::Mat1f disparity = (cv::Mat1f(1, 10) << 10, 9.5F, 11, 8.5F, 12.5F, 6, kNone, kNone, 50, kNone);
  const DisparityErrors errors = compute_disparity_errors(disparity, truth);
  EXPECT_EQ(errors.known_px, 8);
  EXPECT_EQ(errors.density, 6.0 / 8.0);
  EXPECT_EQ(errors.bad_1, 3.0 / 6.0);
  EXPECT_EQ(errors.bad_2, 2.0 / 6.0);
  EXPECT_EQ(errors.bad_3, 1.0 / 6.0);
  EXPECT_EQ(errors.bad_1_or_invalid, 5.0 / 8.0);
  EXPECT_EQ(errors.bad_2_or_invalid, 4.0 / 8.0);
  EXPECT_EQ(errors.bad_3_or_invalid, 3.0 / 8.0);
  EXPECT_DOUBLE_EQ(errors.mean_error_px, 9.5 / 6.0);
}

TEST(DisparityErrors, LeaveOutWhatIsMaskedAway) {
  const cv::Mat1f truth = (cv::Mat1f(2, 3) << 10, 10, 10, 10, 10, 10);
  const cv::Mat1f disparity = (cv::Mat1f(2, 3) << 10, 20, 10, kNone, 15, 10);
  const cv::Mat1b mask = (cv::Mat1b(2, 3) << 255, 0, 1, 0, 255, 0);
  const DisparityErrors errors = compute_disparity_errors(disparity, truth, mask);
  EXPECT_EQ(errors.known_px, 3);
  EXPECT_EQ(errors.density, 1.0);
  EXPECT_EQ(errors.bad_3, 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(errors.mean_error_px, 5.0 / 3.0);
}

TEST(DisparityErrors, TakeADisparityOfZeroAsValid) {
  const DisparityErrors errors = compute_disparity_errors(cv::Mat1f(1, 1, 0.0F), cv::Mat1f(1, 1, 0.5F));
  EXPECT_EQ(errors.density, 1.0);
  EXPECT_EQ(errors.mean_error_px, 0.5);
}

TEST(DisparityErrors, TakeWhatIsNotFiniteAsUnknownOrInvalid) {
  const float infinity = std::numeric_limits<float>::infinity();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const cv::Mat1f truth = (cv::Mat1f(1, 5) << infinity, nan, 10, 10, 10);
  const cv::Mat1f disparity = (cv::Mat1f(1, 5) << 10, 10, infinity, nan, 10);
  const DisparityErrors errors = compute_disparity_errors(disparity, truth);
  EXPECT_EQ(errors.known_px, 3);
  EXPECT_EQ(errors.density, 1.0 / 3.0);
  EXPECT_EQ(errors.mean_error_px, 0.0);
}

TEST(DisparityErrors, AreOnlyMissingPixelsWhenNoneIsValid) {
  const DisparityErrors errors = compute_disparity_errors(cv::Mat1f(3, 5, kNone), cv::Mat1f(3, 5, 7.0F));
  EXPECT_EQ(errors.known_px, 15);
  EXPECT_EQ(errors.density, 0.0);
  EXPECT_EQ(errors.bad_1, 0.0);
  EXPECT_EQ(errors.bad_1_or_invalid, 1.0);
  EXPECT_EQ(errors.mean_error_px, 0.0);
}

std::string refusal(const cv::Mat1f& disparity, const cv::Mat1f& truth, const cv::Mat1b& mask = {}) {
  return test::error_of<std::invalid_argument>([&] { compute_disparity_errors(disparity, truth, mask); });
}

TEST(DisparityErrors, RefuseOtherSizesAndNothingKnown) {
  test::expect_line_with(refusal(cv::Mat1f(3, 5, 1.0F), cv::Mat1f(5, 3, 1.0F)),
                         "truth = 3x5 px, must be 5x3 like the disparity");
  test::expect_line_with(refusal(cv::Mat1f(3, 5, 1.0F), cv::Mat1f(3, 5, 1.0F), cv::Mat1b(3, 4, uchar{1})),
                         "mask = 4x3 px, must be 5x3 like the disparity");
  test::expect_line_with(refusal(cv::Mat1f(3, 5, 1.0F), cv::Mat1f(3, 5, 0.0F)), "pixels of known disparity = 0, must be 1 or");
  test::expect_line_with(refusal(cv::Mat1f(3, 5, 1.0F), cv::Mat1f(3, 5, 1.0F), cv::Mat1b(3, 5, uchar{0})), "= 0, must be 1 or");
  test::expect_line_with(refusal({}, {}), "pixels of known disparity = 0, must be 1 or more");
}

}  // namespace
}  // namespace brink
