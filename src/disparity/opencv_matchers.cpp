#include "disparity/opencv_matchers.hpp"

#include <algorithm>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/ximgproc/disparity_filter.hpp>

#include "disparity/parameters.hpp"

namespace brink {
namespace {

/// OpenCV's disparities are whole multiples of this, px.
constexpr float kOpenCvUnit = 1.0F / static_cast<float>(cv::StereoMatcher::DISP_SCALE);

/// OpenCV counts disparities in multiples of 16, from 0 on.
int count_disparities(int max_disparity) { return (max_disparity + 16) / 16 * 16; }

/// OpenCV leaves out the columns from which the largest disparity would leave the picture, on the left or (right view) on the
/// right. With that many columns repeated on both sides it matches them as well.
cv::Mat1b pad(const cv::Mat1b& image, int columns) {
  cv::Mat1b padded;
  cv::copyMakeBorder(image, padded, 0, 0, columns, columns, cv::BORDER_REPLICATE);
  return padded;
}

/// OpenCV's fixed-point disparities to px, without the padding and without matches that lie in the padding.
cv::Mat1f unpad(const cv::Mat1s& fixed_point, int columns, int max_disparity) {
  const cv::Mat1s inner = fixed_point.colRange(columns, fixed_point.cols - columns);
  cv::Mat1f disparity(inner.size(), kInvalidDisparity);
  for (int v = 0; v < inner.rows; ++v) {
    for (int u = 0; u < inner.cols; ++u) {
      const float d = static_cast<float>(inner(v, u)) * kOpenCvUnit;
      if (d >= 0.0F && d <= static_cast<float>(std::min(u, max_disparity))) disparity(v, u) = d;
    }
  }
  return disparity;
}

/// StereoBM and StereoSGBM refuse pictures that are smaller than one block.
bool is_smaller_than_block(const cv::Mat1b& image, int block_size) { return std::min(image.cols, image.rows) <= block_size; }

cv::Ptr<cv::StereoSGBM> make_sgbm(const SgbmParams& params) {
  // The usual penalties for one channel (OpenCV's documentation): 8 and 32 times the pixels of a block.
  const int pixels = params.block_size_px * params.block_size_px;
  return cv::StereoSGBM::create(0, count_disparities(params.max_disparity), params.block_size_px, 8 * pixels, 32 * pixels,
                                params.consistency_threshold_px, 63, params.uniqueness_percent, params.speckle_size_px,
                                params.speckle_range_px, cv::StereoSGBM::MODE_SGBM_3WAY);
}

class BmMatcher : public StereoMatcher {
 public:
  explicit BmMatcher(const BmParams& params) : params_(params) { params_.validate(); }

  [[nodiscard]] cv::Mat1f compute(const cv::Mat1b& left, const cv::Mat1b& right) override {
    require_equal_sizes(left, right);
    if (is_smaller_than_block(left, params_.block_size_px)) return {left.size(), kInvalidDisparity};
    const int columns = count_disparities(params_.max_disparity);
    const cv::Ptr<cv::StereoBM> matcher = cv::StereoBM::create(columns, params_.block_size_px);
    matcher->setTextureThreshold(params_.texture_threshold);
    matcher->setUniquenessRatio(params_.uniqueness_percent);
    matcher->setDisp12MaxDiff(params_.consistency_threshold_px);
    matcher->setSpeckleWindowSize(params_.speckle_size_px);
    matcher->setSpeckleRange(params_.speckle_range_px);
    cv::Mat1s disparity;
    matcher->compute(pad(left, columns), pad(right, columns), disparity);
    return unpad(disparity, columns, params_.max_disparity);
  }

 private:
  BmParams params_;
};

class SgbmMatcher : public StereoMatcher {
 public:
  explicit SgbmMatcher(const SgbmParams& params) : params_(params) { params_.validate(); }

  [[nodiscard]] cv::Mat1f compute(const cv::Mat1b& left, const cv::Mat1b& right) override {
    require_equal_sizes(left, right);
    if (is_smaller_than_block(left, params_.block_size_px)) return {left.size(), kInvalidDisparity};
    const int columns = count_disparities(params_.max_disparity);
    cv::Mat1s disparity;
    make_sgbm(params_)->compute(pad(left, columns), pad(right, columns), disparity);
    return unpad(disparity, columns, params_.max_disparity);
  }

 private:
  SgbmParams params_;
};

class SgbmWlsMatcher : public StereoMatcher {
 public:
  explicit SgbmWlsMatcher(const SgbmParams& params) : params_(params) { params_.validate(); }

  [[nodiscard]] cv::Mat1f compute(const cv::Mat1b& left, const cv::Mat1b& right) override {
    require_equal_sizes(left, right);
    if (is_smaller_than_block(left, params_.block_size_px)) return {left.size(), kInvalidDisparity};
    const int columns = count_disparities(params_.max_disparity);
    const cv::Mat1b padded_left = pad(left, columns);
    const cv::Mat1b padded_right = pad(right, columns);

    const cv::Ptr<cv::StereoSGBM> left_matcher = make_sgbm(params_);
    cv::Mat1s left_disparity;
    cv::Mat1s right_disparity;
    left_matcher->compute(padded_left, padded_right, left_disparity);
    cv::ximgproc::createRightMatcher(left_matcher)->compute(padded_right, padded_left, right_disparity);

    // createDisparityWLSFilter would turn off the matcher's uniqueness test; the generic one takes disparities as they are.
    const cv::Ptr<cv::ximgproc::DisparityWLSFilter> filter = cv::ximgproc::createDisparityWLSFilterGeneric(true);
    filter->setDepthDiscontinuityRadius((params_.block_size_px + 1) / 2);
    filter->setLambda(params_.wls_lambda);
    filter->setSigmaColor(params_.wls_sigma);
    cv::Mat1s filtered;
    filter->filter(left_disparity, padded_left, filtered, right_disparity, {columns, 0, left.cols, left.rows});
    // The filter invents a disparity for every pixel: keep those that were matched, and that the right view confirms.
    const cv::Mat1f confidence = filter->getConfidenceMap();
    filtered.setTo(-cv::StereoMatcher::DISP_SCALE, (left_disparity < 0) | (confidence <= 0.0F));
    return unpad(filtered, columns, params_.max_disparity);
  }

 private:
  SgbmParams params_;
};

}  // namespace

void BmParams::validate() const {
  require_between("bm.max_disparity", max_disparity, 0, kLargestDisparity);
  require_parameter(block_size_px >= 5 && block_size_px <= 51 && block_size_px % 2 == 1, "bm.block_size_px", block_size_px,
                    "odd, 5 to 51");
  require_between("bm.texture_threshold", texture_threshold, 0, 1000000);
  require_between("bm.uniqueness_percent", uniqueness_percent, 0, 99);
  require_between("bm.consistency_threshold_px", consistency_threshold_px, 0, kLargestDisparity);
  require_between("bm.speckle_size_px", speckle_size_px, 0, 1000000000);
  require_between("bm.speckle_range_px", speckle_range_px, 0, 1000);
}

void SgbmParams::validate() const {
  require_between("sgbm.max_disparity", max_disparity, 0, kLargestDisparity);
  require_parameter(block_size_px >= 1 && block_size_px <= 11 && block_size_px % 2 == 1, "sgbm.block_size_px", block_size_px,
                    "odd, 1 to 11");
  require_between("sgbm.uniqueness_percent", uniqueness_percent, 0, 99);
  require_between("sgbm.consistency_threshold_px", consistency_threshold_px, 0, kLargestDisparity);
  require_between("sgbm.speckle_size_px", speckle_size_px, 0, 1000000000);
  require_between("sgbm.speckle_range_px", speckle_range_px, 0, 1000);
  require_parameter(wls_lambda > 0.0 && wls_lambda <= 1e9, "sgbm.wls_lambda", wls_lambda, "above 0, at most 1e9");
  require_parameter(wls_sigma > 0.0 && wls_sigma <= 1e6, "sgbm.wls_sigma", wls_sigma, "above 0, at most 1e6");
}

std::unique_ptr<StereoMatcher> make_bm_matcher(const BmParams& params) { return std::make_unique<BmMatcher>(params); }

std::unique_ptr<StereoMatcher> make_sgbm_matcher(const SgbmParams& params) { return std::make_unique<SgbmMatcher>(params); }

std::unique_ptr<StereoMatcher> make_sgbm_wls_matcher(const SgbmParams& params) {
  return std::make_unique<SgbmWlsMatcher>(params);
}

}  // namespace brink
