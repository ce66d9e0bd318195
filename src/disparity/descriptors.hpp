#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include <hwy/aligned_allocator.h>
#include <opencv2/core.hpp>

namespace brink {

/// The surroundings of a pixel: 12 samples of the horizontal and 4 of the vertical gradient, each gradient / 4 + 128.
using Descriptor = std::array<std::uint8_t, 16>;

/// Where the samples of the first pixel of a row lie (algorithms.md A.2); those of pixel u lie u bytes farther.
using DescriptorSamples = std::array<const std::uint8_t*, 16>;

/// The descriptors of a picture (ACCV 2010, section 3). Only the gradients that they are samples of are kept: all descriptors
/// together are sixteen times as large as the picture, and to read them takes longer than to gather a row of them again.
class DescriptorImage {
 public:
  DescriptorImage() = default;
  /// @param picture of any size. Outside of it its border pixels are repeated, so that every descriptor is defined.
  explicit DescriptorImage(const cv::Mat1b& picture) { assign(picture); }

  /// Describes another picture in the same memory.
  void assign(const cv::Mat1b& picture);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] DescriptorSamples samples(int v) const;
  [[nodiscard]] Descriptor at(int u, int v) const;

 private:
  int width_ = 0;
  int height_ = 0;
  cv::Mat1b framed_;  ///< picture and gradients, each with a frame around it
  cv::Mat1b horizontal_;
  cv::Mat1b vertical_;
};

inline Descriptor describe(const DescriptorSamples& samples, int u) {
  Descriptor descriptor;
  for (std::size_t k = 0; k < descriptor.size(); ++k) descriptor[k] = samples[k][u];
  return descriptor;
}

/// Memory for the descriptors of a row, which is used again for the next one. Up to kPadding descriptors on both sides of it
/// can be read.
class DescriptorRow {
 public:
  static constexpr std::size_t kPadding = 2112;  ///< the largest disparity, 2047, and a vector

  /// The descriptors of row v. @return the first of them.
  const Descriptor* gather(const DescriptorImage& image, int v);

 private:
  int width_ = 0;
  hwy::AlignedFreeUniquePtr<Descriptor[]> descriptors_;  // NOLINT(modernize-avoid-c-arrays): Highway's way to align
};

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
