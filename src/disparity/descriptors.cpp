#include "disparity/descriptors.hpp"

#include <utility>

#include <opencv2/imgproc.hpp>
#include <tbb/parallel_for.h>

#include "disparity/descriptors_simd.hpp"

namespace brink {
namespace {

/// How far the samples of a descriptor lie from its centre, px.
constexpr int kReach = 2;

/// Gradient / 4 + 128, saturated, of a picture and of a frame of kReach px around it. Dividing rounds half to even: the noise
/// of a surface without texture, less than one grey level, then vanishes in both directions alike.
cv::Mat1b compute_gradient(const cv::Mat1b& padded, int order_u, int order_v) {
  cv::Mat1s gradient;
  cv::Sobel(padded, gradient, CV_16S, order_u, order_v, 3, 1.0, 0.0, cv::BORDER_REPLICATE);
  cv::Mat1b samples;
  gradient.convertTo(samples, CV_8U, 0.25, 128.0);
  return samples;
}

}  // namespace

DescriptorImage compute_descriptors(const cv::Mat1b& image, DescriptorImage memory) {
  if (image.empty()) return {};
  cv::Mat1b padded;
  cv::copyMakeBorder(image, padded, kReach, kReach, kReach, kReach, cv::BORDER_REPLICATE);
  const cv::Mat1b horizontal = compute_gradient(padded, 1, 0);
  const cv::Mat1b vertical = compute_gradient(padded, 0, 1);

  DescriptorImage descriptors = std::move(memory);
  descriptors.resize(image.cols, image.rows);
  tbb::parallel_for(0, image.rows, [&](int v) {
    GradientRows gradients;
    for (int i = 0; i < 5; ++i) {
      gradients.horizontal[static_cast<std::size_t>(i)] = horizontal[v + i] + kReach;
      gradients.vertical[static_cast<std::size_t>(i)] = vertical[v + i] + kReach;
    }
    gather_descriptors(gradients, image.cols, descriptors.row(v));
  });
  return descriptors;
}

}  // namespace brink
