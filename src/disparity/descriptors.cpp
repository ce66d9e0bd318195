#include "disparity/descriptors.hpp"

#include <opencv2/imgproc.hpp>

#include "disparity/descriptors_simd.hpp"

namespace brink {
namespace {

/// How far the samples of a descriptor lie from its centre, px.
constexpr int kReach = 2;

struct Offset {
  int u;
  int v;
};
constexpr std::array<Offset, 12> kHorizontal = {
    {{0, -2}, {-2, -1}, {0, -1}, {2, -1}, {-1, 0}, {0, 0}, {0, 0}, {1, 0}, {-2, 1}, {0, 1}, {2, 1}, {0, 2}}};
constexpr std::array<Offset, 4> kVertical = {{{0, -1}, {-1, 0}, {1, 0}, {0, 1}}};

}  // namespace

void DescriptorImage::assign(const cv::Mat1b& picture) {
  width_ = picture.cols;
  height_ = picture.rows;
  if (picture.empty()) return;
  cv::copyMakeBorder(picture, framed_, kReach, kReach, kReach, kReach, cv::BORDER_REPLICATE);
  // Gradient / 4 + 128, saturated. Dividing rounds half to even: the noise of a surface without texture, less than one grey
  // level, then vanishes in both directions alike.
  const auto compute_gradient = [this](int order_u, int order_v, cv::Mat1b& samples) {
    cv::Sobel(framed_, gradient_, CV_16S, order_u, order_v, 3, 1.0, 0.0, cv::BORDER_REPLICATE);
    gradient_.convertTo(samples, CV_8U, 0.25, 128.0);
  };
  compute_gradient(1, 0, horizontal_);
  compute_gradient(0, 1, vertical_);
}

DescriptorSamples DescriptorImage::samples(int v) const {
  DescriptorSamples samples{};
  std::size_t k = 0;
  for (const Offset& to : kHorizontal) samples[k++] = horizontal_[v + kReach + to.v] + kReach + to.u;
  for (const Offset& to : kVertical) samples[k++] = vertical_[v + kReach + to.v] + kReach + to.u;
  return samples;
}

Descriptor DescriptorImage::at(int u, int v) const { return describe(samples(v), u); }

const Descriptor* DescriptorRow::gather(const DescriptorImage& image, int v) {
  if (!descriptors_ || width_ != image.width()) {
    width_ = image.width();
    descriptors_ = hwy::AllocateAligned<Descriptor>(static_cast<std::size_t>(width_) + 2 * kPadding);
  }
  Descriptor* const row = descriptors_.get() + kPadding;
  gather_descriptors(image.samples(v), width_, row);
  return row;
}

}  // namespace brink
