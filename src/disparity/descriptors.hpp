#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include <opencv2/core.hpp>

namespace brink {

/// The surroundings of a pixel: 12 samples of the horizontal and 4 of the vertical gradient, each gradient / 4 + 128.
using Descriptor = std::array<std::uint8_t, 16>;

/// One descriptor per pixel, row by row. Vectors may read up to kPadding descriptors before the first row and behind the last.
class DescriptorImage {
 public:
  static constexpr std::size_t kPadding = 2112;  // the largest disparity, 2047, and a vector

  DescriptorImage() = default;
  DescriptorImage(int width, int height) { resize(width, height); }

  /// What the descriptors are is not told afterwards.
  void resize(int width, int height) {
    width_ = width;
    height_ = height;
    descriptors_.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) + 2 * kPadding);
  }

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  /// The first of the width() descriptors of row v.
  [[nodiscard]] const Descriptor* row(int v) const { return descriptors_.data() + offset(v); }
  [[nodiscard]] Descriptor* row(int v) { return descriptors_.data() + offset(v); }

 private:
  [[nodiscard]] std::size_t offset(int v) const {
    return kPadding + static_cast<std::size_t>(v) * static_cast<std::size_t>(width_);
  }

  int width_ = 0;
  int height_ = 0;
  std::vector<Descriptor> descriptors_;
};

/// Descriptors of all pixels (ACCV 2010, section 3; algorithms.md A.2). Outside the picture its border pixels are repeated, so
/// that every descriptor is defined.
/// @param image of any size; empty gives an empty result.
/// @param memory whose memory is used again: that of a whole picture takes longer to get than to fill.
DescriptorImage compute_descriptors(const cv::Mat1b& image, DescriptorImage memory = {});

/// Texture of a pixel: the sum of the gradient magnitudes in its descriptor, 0..2048.
inline int compute_texture(const Descriptor& descriptor) {
  int sum = 0;
  for (const std::uint8_t sample : descriptor) sum += std::abs(sample - 128);
  return sum;
}

/// Dissimilarity of two pixels: the L1 distance of their descriptors, 0..4080.
inline int compute_cost(const Descriptor& a, const Descriptor& b) {
  int sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(a[i] - b[i]);
  return sum;
}

}  // namespace brink
