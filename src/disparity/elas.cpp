#include "disparity/elas.hpp"

#include <utility>
#include <vector>

#include <tbb/parallel_invoke.h>

#include "disparity/dense_matching.hpp"
#include "disparity/descriptors.hpp"
#include "disparity/parameters.hpp"
#include "disparity/postprocess.hpp"
#include "disparity/support_points.hpp"

namespace brink {
namespace {

/// Geiger, Roser, Urtasun, "Efficient Large-Scale Stereo Matching", ACCV 2010.
class ElasMatcher : public StereoMatcher {
 public:
  explicit ElasMatcher(const ElasParams& params) : params_(params) { params_.validate(); }

  [[nodiscard]] cv::Mat1f compute(const cv::Mat1b& left, const cv::Mat1b& right) override {
    require_equal_sizes(left, right);

    tbb::parallel_invoke([&] { left_.assign(left); }, [&] { right_.assign(right); });

    const std::vector<SupportPoint> points = find_support_points(left_, right_, params_, support_);
    if (points.size() < 3) return {left.size(), kInvalidDisparity};

    return clean_up(match_both_views(left_, right_, points, params_, dense_));
  }

 private:
  [[nodiscard]] cv::Mat1f clean_up(cv::Mat1f disparity) const {
    remove_speckles(disparity, static_cast<float>(params_.speckle_similarity_px), params_.speckle_size_px);
    fill_gaps(disparity, params_.gap_width_px, params_.fill_across_steps);
    if (params_.add_corners) extend_to_borders(disparity, params_.gap_width_px);
    if (params_.filter_adaptive_mean) disparity = filter_adaptive_mean(disparity);
    if (params_.filter_median) filter_median(disparity);
    return disparity;
  }

  ElasParams params_;
  // Memory that is used again:
  DescriptorImage left_;
  DescriptorImage right_;
  SupportMemory support_;
  DenseMemory dense_;
};

}  // namespace

std::unique_ptr<StereoMatcher> make_elas_matcher(const ElasParams& params) { return std::make_unique<ElasMatcher>(params); }

}  // namespace brink
