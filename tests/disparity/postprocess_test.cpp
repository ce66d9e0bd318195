#include "disparity/postprocess.hpp"

#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "brink/disparity.hpp"
#include "reference/naive_disparity.hpp"
#include "simd_targets.hpp"

namespace brink {
namespace {

constexpr float kNone = kInvalidDisparity;

cv::Mat1f make_row(const std::vector<float>& values) { return cv::Mat1f(values, true).reshape(1, 1); }

void expect_equal(const cv::Mat1f& actual, const cv::Mat1f& expected) {
  ASSERT_EQ(actual.size(), expected.size());
  if (expected.empty()) return;
  EXPECT_EQ(cv::countNonZero(actual != expected), 0) << actual << "\n" << expected;
}

/// A copy that was changed.
template <typename Change, typename... Arguments>
cv::Mat1f changed(const Change& change, const cv::Mat1f& disparity, Arguments... arguments) {
  cv::Mat1f copy = disparity.clone();
  change(copy, arguments...);
  return copy;
}

/// Small disparities with holes, so that segments of every size and shape occur.
cv::Mat1f make_random(cv::Size size, unsigned seed) {
  cv::Mat1i whole(size);
  cv::RNG(seed).fill(whole, cv::RNG::UNIFORM, -1, 4);
  cv::Mat1f disparity;
  whole.convertTo(disparity, CV_32F);
  return disparity;
}

TEST(Postprocess, NothingHappensToEmptyAndInvalidPictures) {
  for (const cv::Mat1f& disparity : {cv::Mat1f(), cv::Mat1f(1, 1, kNone), cv::Mat1f(5, 3, kNone)}) {
    expect_equal(changed(remove_speckles, disparity, 1.0F, 10), disparity);
    expect_equal(changed(fill_gaps, disparity, 3, true), disparity);
    expect_equal(changed(extend_to_borders, disparity, 3), disparity);
    expect_equal(filter_adaptive_mean(disparity), disparity);
    expect_equal(changed(filter_median, disparity), disparity);
  }
}

TEST(Postprocess, MeanLeavesItsInputAlone) {
  const cv::Mat1f disparity = make_row({5.0F, kNone, 7.0F});
  filter_adaptive_mean(disparity);
  expect_equal(disparity, make_row({5.0F, kNone, 7.0F}));
}

TEST(Postprocess, SpecklesSmallerThanTheLimitGo) {
  const cv::Mat1f row = make_row({5.0F, 5.5F, 6.5F, kNone, 9.0F, 9.0F, 20.0F});
  expect_equal(changed(remove_speckles, row, 1.0F, 3), make_row({5.0F, 5.5F, 6.5F, kNone, kNone, kNone, kNone}));
  expect_equal(changed(remove_speckles, row, 1.0F, 2), make_row({5.0F, 5.5F, 6.5F, kNone, 9.0F, 9.0F, kNone}));
}

TEST(Postprocess, SpecklesEqualTheirDefinition) {
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(7, 5), cv::Size(23, 19), cv::Size(150, 90), cv::Size(9, 300)}) {
    for (const int min_size : {1, 2, 6}) {
      const cv::Mat1f disparity = make_random(size, 5);
      const cv::Mat1f expected = reference::remove_speckles(disparity, 1.0F, min_size);
      test::for_each_target([&] { expect_equal(changed(remove_speckles, disparity, 1.0F, min_size), expected); });
    }
  }
}

TEST(Postprocess, GapWithinASurfaceIsFilledLinearly) {
  expect_equal(changed(fill_gaps, make_row({4.0F, kNone, kNone, kNone, 6.0F}), 3, false),
               make_row({4.0F, 4.5F, 5.0F, 5.5F, 6.0F}));
}

TEST(Postprocess, GapBetweenSurfacesBelongsToTheBackgroundOrToNobody) {
  const cv::Mat1f row = make_row({9.0F, kNone, 6.0F});
  expect_equal(changed(fill_gaps, row, 3, true), make_row({9.0F, 6.0F, 6.0F}));
  expect_equal(changed(fill_gaps, row, 3, false), row);
}

TEST(Postprocess, WideGapsAndBordersStay) {
  const cv::Mat1f row = make_row({kNone, 4.0F, kNone, kNone, 4.0F, kNone});
  expect_equal(changed(fill_gaps, row, 1, true), row);
  expect_equal(changed(fill_gaps, row, 0, true), row);
  expect_equal(changed(fill_gaps, row, 2, true), make_row({kNone, 4.0F, 4.0F, 4.0F, 4.0F, kNone}));
}

TEST(Postprocess, GapsAreFilledAlongColumnsToo) {
  const cv::Mat1f gap = (cv::Mat1f(3, 1) << 4.0F, kNone, 6.0F);
  const cv::Mat1f filled = (cv::Mat1f(3, 1) << 4.0F, 5.0F, 6.0F);
  expect_equal(changed(fill_gaps, gap, 3, false), filled);
}

/// Rows, then columns.
template <typename Change>
cv::Mat1f change_lines(const cv::Mat1f& disparity, const Change& change) {
  cv::Mat1f result(disparity.size());
  for (int v = 0; v < result.rows; ++v) make_row(change(std::vector<float>(disparity.row(v)))).copyTo(result.row(v));
  for (int u = 0; u < result.cols; ++u) {
    const cv::Mat1f column = result.col(u).clone();
    cv::Mat1f(change(std::vector<float>(column.reshape(1, 1))), true).copyTo(result.col(u));
  }
  return result;
}

TEST(Postprocess, GapsEqualTheirDefinition) {
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(64, 9), cv::Size(65, 40), cv::Size(150, 90)}) {
    cv::Mat1f disparity = make_random(size, 8);
    disparity *= 2.0;  // steps of 2 px are one surface, of 4 px are not
    disparity.setTo(kNone, disparity < 3.0F);
    for (const int max_width : {1, 3, 70}) {
      for (const bool across_steps : {false, true}) {
        const cv::Mat1f expected = change_lines(
            disparity, [&](const std::vector<float>& line) { return reference::fill_gaps(line, max_width, across_steps); });
        test::for_each_target([&] { expect_equal(changed(fill_gaps, disparity, max_width, across_steps), expected); });
      }
    }
  }
}

TEST(Postprocess, ValidBitsEqualTheirTwinAndGiveTheRuns) {
  for (const int width : {1, 2, 15, 63, 64, 65, 128, 203}) {
    const std::vector<float> row = make_random({width, 1}, 6);
    const ValidBits expected = reference::find_valid_bits(row, 1.0F);
    std::vector<cv::Range> runs;
    for (int u = 0; u < width; ++u) {
      if (row[static_cast<std::size_t>(u)] == kNone) continue;
      const bool goes_on = u > 0 && ((expected.joined[static_cast<std::size_t>(u - 1) / 64] >> ((u - 1) % 64)) & 1U) != 0;
      if (!goes_on) runs.emplace_back(u, u);
      runs.back().end = u + 1;
    }
    test::for_each_target([&] {
      ValidBits bits{PixelBits(9, ~std::uint64_t{0}), {}};
      find_valid_bits(row.data(), width, 1.0F, bits);
      EXPECT_EQ(bits.valid, expected.valid) << width;
      EXPECT_EQ(bits.joined, expected.joined) << width;
      std::vector<cv::Range> found;
      for_each_run(bits, [&](int begin, int end) { found.emplace_back(begin, end); });
      EXPECT_EQ(found, runs) << width;
    });
  }
}

TEST(Postprocess, BordersAreExtendedNoFurtherThanAllowed) {
  const cv::Mat1f row = make_row({kNone, kNone, 4.0F, kNone, 7.0F, kNone});
  expect_equal(changed(extend_to_borders, row, 1), make_row({kNone, 4.0F, 4.0F, kNone, 7.0F, 7.0F}));
  expect_equal(changed(extend_to_borders, row, 5000), make_row({4.0F, 4.0F, 4.0F, kNone, 7.0F, 7.0F}));
}

TEST(Postprocess, AdaptiveMeanEqualsItsDefinition) {
  std::vector<float> values(41);
  cv::RNG random(9);
  for (float& value : values) value = random.uniform(0.0F, 9.0F);
  for (const std::size_t hole : {3U, 10U, 11U, 24U}) values[hole] = kNone;
  expect_equal(filter_adaptive_mean(make_row(values)), make_row(reference::adaptive_mean(values)));
}

TEST(Postprocess, AdaptiveMeanEqualsItsTwinOnEveryTarget) {
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(3, 9), cv::Size(37, 23), cv::Size(64, 5)}) {
    cv::Mat1f disparity(size);
    cv::RNG(4).fill(disparity, cv::RNG::UNIFORM, -1.0F, 9.0F);
    disparity.setTo(kNone, disparity < 0.5F);
    const cv::Mat1f expected = change_lines(disparity, reference::adaptive_mean);
    test::for_each_target([&] { expect_equal(filter_adaptive_mean(disparity), expected); });
  }
}

TEST(Postprocess, AdaptiveMeanLeavesStepsAndSlopes) {
  const cv::Mat1f step = make_row({8.0F, 8.0F, 8.0F, 8.0F, 12.0F, 12.0F, 12.0F, 12.0F});
  expect_equal(filter_adaptive_mean(step), step);
  cv::Mat1f slope(15, 21);
  for (int v = 0; v < slope.rows; ++v) {
    for (int u = 0; u < slope.cols; ++u) slope(v, u) = 30.0F + 0.25F * static_cast<float>(u) + 0.125F * static_cast<float>(v);
  }
  const cv::Rect inner(3, 3, 15, 9);
  EXPECT_LT(cv::norm(filter_adaptive_mean(slope)(inner), slope(inner), cv::NORM_INF), 1e-4);
}

TEST(Postprocess, AdaptiveMeanNeverMixesInWhatIsInvalid) {
  // 0 and the marker -1 differ by less than 4.
  const cv::Mat1f row = make_row({0.0F, kNone, 0.0F, 0.0F});
  expect_equal(filter_adaptive_mean(row), row);
}

TEST(Postprocess, MedianTakesValidPixelsOnly) {
  // Windows: {3 5 9 1}, -, {3 5 9 1 7}, {3 5 9 1 7}, {3 .. 7}; the lower of the two middle ones where the number is even.
  const cv::Mat1f row = make_row({3.0F, kNone, 5.0F, 9.0F, 1.0F, 7.0F});
  expect_equal(changed(filter_median, row), make_row({5.0F, kNone, 5.0F, 5.0F, 5.0F, 5.0F}));
}

TEST(Postprocess, MedianRemovesASpike) {
  cv::Mat1f disparity(9, 9, 20.0F);
  disparity(4, 4) = 90.0F;
  expect_equal(changed(filter_median, disparity), cv::Mat1f(9, 9, 20.0F));
}

}  // namespace
}  // namespace brink
