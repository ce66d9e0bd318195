#pragma once

#include <cstdint>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace brink {

/// Random grey levels, smoothed as a lens does: every place looks different.
inline cv::Mat1b make_texture(cv::Size size, std::uint64_t seed = 1) {
  cv::Mat1b noise(size);
  cv::RNG random(seed);
  random.fill(noise, cv::RNG::UNIFORM, 0, 256);
  cv::Mat1b smooth;
  cv::GaussianBlur(noise, smooth, {3, 3}, 0.8, 0.8, cv::BORDER_REPLICATE);
  return smooth;
}

struct SyntheticPair {
  cv::Mat1b left;
  cv::Mat1b right;
};

/// A textured wall: every pixel of the left picture has the same disparity; nothing is hidden but the left border.
inline SyntheticPair make_wall(cv::Size size, int disparity, std::uint64_t seed = 1) {
  const cv::Mat1b wide = make_texture({size.width + disparity, size.height}, seed);
  return {wide.colRange(0, size.width).clone(), wide.colRange(disparity, size.width + disparity).clone()};
}

/// The pair in few grey levels: many costs are equal.
inline SyntheticPair coarsen(SyntheticPair pair) {
  pair.left = (pair.left / 64) * 64;
  pair.right = (pair.right / 64) * 64;
  return pair;
}

/// A wall that stands halfway between two whole disparities: drawn at 4 times the width and averaged.
inline SyntheticPair make_fractional_wall(cv::Size size, int quarters, std::uint64_t seed = 1) {
  cv::Mat1b wide;
  cv::GaussianBlur(make_texture({4 * size.width + quarters, size.height}, seed), wide, {0, 0}, 4.0, 0.8);
  cv::normalize(wide, wide, 0, 255, cv::NORM_MINMAX);
  cv::Mat1b left;
  cv::Mat1b right;
  cv::resize(wide.colRange(0, 4 * size.width), left, size, 0, 0, cv::INTER_AREA);
  cv::resize(wide.colRange(quarters, quarters + 4 * size.width), right, size, 0, 0, cv::INTER_AREA);
  return {left, right};
}

}  // namespace brink
