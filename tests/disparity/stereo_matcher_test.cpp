#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "brink/disparity.hpp"
#include "disparity/synthetic.hpp"

namespace brink {
namespace {

struct Method {
  std::string name;
  DisparityParams params;
};

std::vector<Method> make_methods() {
  std::vector<Method> methods;
  for (const Matcher matcher : {Matcher::elas, Matcher::bm, Matcher::sgbm, Matcher::sgbm_wls}) {
    methods.push_back({to_string(matcher), {}});
    methods.back().params.matcher = matcher;
  }
  methods.push_back({"elas-middlebury", {}});
  methods.back().params.elas = ElasParams::middlebury();
  methods.push_back({"elas-paper", {}});
  methods.back().params.elas = ElasParams::paper();
  return methods;
}

class EveryMethod : public testing::TestWithParam<Method> {};
INSTANTIATE_TEST_SUITE_P(StereoMatcher, EveryMethod, testing::ValuesIn(make_methods()),
                         [](const testing::TestParamInfo<Method>& method) {
                           std::string name = method.param.name;
                           for (char& letter : name) letter = letter == '-' ? '_' : letter;
                           return name;
                         });

void expect_all_invalid(const cv::Mat1f& disparity, cv::Size size) {
  ASSERT_EQ(disparity.size(), size);
  EXPECT_EQ(cv::countNonZero(disparity != kInvalidDisparity), 0);
}

/// Two walls at 40 and 60 px, a band without texture, and noise in one of the pictures.
SyntheticPair make_scene() {
  SyntheticPair pair = make_wall({321, 161}, 40);
  const cv::Mat1b near = make_texture({120, 161}, 2);
  near.copyTo(pair.left.colRange(150, 270));
  near.copyTo(pair.right.colRange(90, 210));
  pair.left.rowRange(120, 140) = 6;
  pair.right.rowRange(120, 140) = 6;
  cv::Mat1b noise(pair.left.size());
  cv::RNG(5).fill(noise, cv::RNG::UNIFORM, 0, 3);
  pair.right += noise;
  return pair;
}

TEST_P(EveryMethod, EmptyPicturesGiveAnEmptyResult) {
  EXPECT_TRUE(compute_disparity(cv::Mat1b(), cv::Mat1b(), GetParam().params).empty());
}

TEST_P(EveryMethod, TinyPicturesHaveNoDisparity) {
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(3, 2), cv::Size(1, 40), cv::Size(40, 1)}) {
    const cv::Mat1b texture = make_texture(size);
    expect_all_invalid(compute_disparity(texture, texture, GetParam().params), size);
  }
}

TEST_P(EveryMethod, OddSmallPicturesKeepTheirSize) {
  for (const cv::Size size : {cv::Size(11, 11), cv::Size(12, 13), cv::Size(17, 31), cv::Size(33, 32)}) {
    const SyntheticPair pair = make_wall(size, 2);
    EXPECT_EQ(compute_disparity(pair.left, pair.right, GetParam().params).size(), size);
  }
}

TEST_P(EveryMethod, DifferentSizesAreRefused) {
  EXPECT_THROW((void)compute_disparity(cv::Mat1b(40, 40), cv::Mat1b(40, 41), GetParam().params), std::invalid_argument);
}

TEST_P(EveryMethod, WallIsFoundOverTheFullWidthThatBothPicturesShow) {
  DisparityParams params = GetParam().params;
  const SyntheticPair pair = make_wall({160, 90}, 20);  // narrower than the 256 disparities tried
  const cv::Mat1f disparity = compute_disparity(pair.left, pair.right, params);
  const cv::Mat1f shared = disparity(cv::Rect(32, 12, 116, 66));
  EXPECT_GE(cv::countNonZero(cv::abs(shared - 20.0F) <= 0.5F), 0.97 * shared.rows * shared.cols) << GetParam().name;
  for (int v = 0; v < disparity.rows; ++v) {
    for (int u = 0; u < disparity.cols; ++u) {
      ASSERT_TRUE(disparity(v, u) == kInvalidDisparity || (disparity(v, u) >= 0.0F && disparity(v, u) <= 255.0F));
    }
  }
}

TEST_P(EveryMethod, ResultIsTheSameForAnyNumberOfThreadsAndInEveryRun) {
  const SyntheticPair pair = make_scene();
  const auto matcher = make_stereo_matcher(GetParam().params);
  const auto run = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return matcher->compute(pair.left, pair.right);
  };
  const cv::Mat1f one = run(1);
  EXPECT_GT(cv::countNonZero(one != kInvalidDisparity), one.rows * one.cols / 3);
  EXPECT_EQ(cv::countNonZero(one != run(4)), 0);
  EXPECT_EQ(cv::countNonZero(one != run(4)), 0);
  EXPECT_EQ(cv::countNonZero(one != compute_disparity(pair.left, pair.right, GetParam().params)), 0);
}

TEST(StereoMatcher, BlackPicturesHaveNoDisparity) {
  const cv::Mat1b black(60, 90, std::uint8_t{0});
  for (const ElasParams& elas : {ElasParams::robotics(), ElasParams::middlebury(), ElasParams::paper()}) {
    DisparityParams params;
    params.elas = elas;
    expect_all_invalid(compute_disparity(black, black, params), black.size());
  }
}

TEST(StereoMatcher, ElasKeepsOccludedAndTexturelessSurfacesInvalid) {
  const SyntheticPair pair = make_scene();
  const cv::Mat1f disparity = compute_disparity(pair.left, pair.right);
  // The near wall hides 20 columns of the far one to its left, and the band has no texture.
  const cv::Mat1f hidden = disparity(cv::Rect(135, 10, 10, 100));
  EXPECT_LT(cv::countNonZero(hidden != kInvalidDisparity), 0.05 * hidden.rows * hidden.cols);
  const cv::Mat1f band = disparity(cv::Rect(60, 126, 250, 8));
  EXPECT_EQ(cv::countNonZero(band != kInvalidDisparity), 0);
  const cv::Mat1f near = disparity(cv::Rect(155, 10, 105, 100));
  EXPECT_GE(cv::countNonZero(cv::abs(near - 60.0F) <= 0.5F), 0.97 * near.rows * near.cols);
}

TEST(StereoMatcher, MiddleburyFillsEveryPixel) {
  const SyntheticPair pair = make_scene();
  DisparityParams params;
  params.elas = ElasParams::middlebury();
  EXPECT_EQ(cv::countNonZero(compute_disparity(pair.left, pair.right, params) == kInvalidDisparity), 0);
}

TEST(StereoMatcher, PaperHasWholePixelsBeforeItsMeanFilter) {
  const SyntheticPair pair = make_scene();
  DisparityParams params;
  params.elas = ElasParams::paper();
  params.elas.filter_adaptive_mean = false;
  params.elas.gap_width_px = 0;
  const cv::Mat1f disparity = compute_disparity(pair.left, pair.right, params);
  for (const float d : disparity) ASSERT_EQ(d, std::floor(d));
}

TEST(StereoMatcher, RangeMayExceedThePicture) {
  DisparityParams params;
  params.elas.max_disparity = 511;
  const SyntheticPair pair = make_wall({100, 60}, 30);
  const cv::Mat1f shared = compute_disparity(pair.left, pair.right, params)(cv::Rect(42, 5, 50, 50));
  EXPECT_GE(cv::countNonZero(cv::abs(shared - 30.0F) <= 0.5F), 0.97 * shared.rows * shared.cols);
}

TEST(StereoMatcher, NamesAreReadAndWritten) {
  for (const char* name : {"elas", "bm", "sgbm", "sgbm-wls"}) EXPECT_EQ(to_string(matcher_from_string(name)), name);
  try {
    (void)matcher_from_string("elsa");
    FAIL() << "must throw";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "matcher = elsa, must be elas, bm, sgbm or sgbm-wls");
  }
}

std::string error_of(const DisparityParams& params) {
  try {
    (void)make_stereo_matcher(params);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(StereoMatcher, WrongParametersAreNamedWithTheirValue) {
  DisparityParams params;
  EXPECT_EQ(error_of(params), "");
  params.elas.match_margin = 1.5;
  EXPECT_EQ(error_of(params), "elas.match_margin = 1.5, must be at least 0, below 1");
  params.elas = {};
  params.elas.max_disparity = -3;
  EXPECT_EQ(error_of(params), "elas.max_disparity = -3, must be 0 to 2047");
  params.elas = {};
  params.elas.beta = 0.0;
  EXPECT_EQ(error_of(params), "elas.beta = 0, must be 1e-06 to 1000000");
  params.matcher = Matcher::bm;
  EXPECT_EQ(error_of(params), "") << "parts that are not in use are not checked";
  params.bm.block_size_px = 4;
  EXPECT_EQ(error_of(params), "bm.block_size_px = 4, must be odd, 5 to 51");
  params.matcher = Matcher::sgbm_wls;
  params.sgbm.wls_lambda = 0.0;
  EXPECT_EQ(error_of(params), "sgbm.wls_lambda = 0, must be above 0, at most 1e9");
}

TEST(StereoMatcher, NotANumberIsRefused) {
  DisparityParams params;
  params.elas.gamma = std::nan("");
  EXPECT_EQ(error_of(params), "elas.gamma = nan, must be 1e-06 to 1000000");
}

}  // namespace
}  // namespace brink
