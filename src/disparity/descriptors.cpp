#include "disparity/descriptors.hpp"

#include <opencv2/imgproc.hpp>
#include <tbb/parallel_for.h>

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

DescriptorImage compute_descriptors(const cv::Mat1b& image) {
  if (image.empty()) return {};
  cv::Mat1b padded;
  cv::copyMakeBorder(image, padded, kReach, kReach, kReach, kReach, cv::BORDER_REPLICATE);
  const cv::Mat1b horizontal = compute_gradient(padded, 1, 0);
  const cv::Mat1b vertical = compute_gradient(padded, 0, 1);

  DescriptorImage descriptors(image.cols, image.rows);
  tbb::parallel_for(0, image.rows, [&](int v) {
    std::array<const std::uint8_t*, 5> du{};  // du[i][u], dv[i][u]: sample at column u + 2 - kReach.. of row v - 2 + i
    std::array<const std::uint8_t*, 5> dv{};
    for (int i = 0; i < 5; ++i) {
      du[static_cast<std::size_t>(i)] = horizontal[v + i] + kReach;
      dv[static_cast<std::size_t>(i)] = vertical[v + i] + kReach;
    }
    Descriptor* const row = descriptors.row(v);
    for (int u = 0; u < image.cols; ++u) {
      row[u] = {du[0][u],     du[1][u - 2], du[1][u],     du[1][u + 2], du[2][u - 1], du[2][u],     du[2][u],     du[2][u + 1],
                du[3][u - 2], du[3][u],     du[3][u + 2], du[4][u],     dv[1][u],     dv[2][u - 1], dv[2][u + 1], dv[3][u]};
    }
  });
  return descriptors;
}

}  // namespace brink
