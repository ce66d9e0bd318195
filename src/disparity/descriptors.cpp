#include "disparity/descriptors.hpp"

#include <opencv2/imgproc.hpp>

#include "disparity/descriptors_simd.hpp"
#include "disparity/padded_rows.hpp"

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
  constexpr int kFrame = kReach + 1;  // gradients are wanted kReach px outside, and look 1 px farther
  framed_ = make_padded_rows({width_ + 2 * kFrame, height_ + 2 * kFrame}, framed_);
  cv::copyMakeBorder(picture, framed_, kFrame, kFrame, kFrame, kFrame, cv::BORDER_REPLICATE);
  const cv::Size size(width_ + 2 * kReach, height_ + 2 * kReach);
  horizontal_ = make_padded_rows(size, horizontal_);
  vertical_ = make_padded_rows(size, vertical_);
  for (int v = 0; v < size.height; ++v)
    compute_gradient_rows({framed_[v], framed_[v + 1], framed_[v + 2]}, size.width, horizontal_[v], vertical_[v]);
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
