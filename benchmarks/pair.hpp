#pragma once

#include <cstdlib>
#include <string>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace brink::benchmarks {

struct Pair {
  cv::Mat1b left;
  cv::Mat1b right;
};

inline Pair make_wall() {
  constexpr int kDisparity = 60;
  cv::Mat1b texture(720, 1280 + kDisparity);
  cv::RNG(1).fill(texture, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(texture, texture, {3, 3}, 0.8);
  return {texture.colRange(0, 1280).clone(), texture.colRange(kDisparity, 1280 + kDisparity).clone()};
}

/// The first pair of the folder BRINK_BENCHMARK_PAIR, KITTI layout; a synthetic wall of 1280x720 where it is not set.
inline Pair read_pair() {
  const char* folder = std::getenv("BRINK_BENCHMARK_PAIR");
  if (folder == nullptr) return make_wall();
  const cv::Mat left = cv::imread(std::string(folder) + "/image_2/000000.png", cv::IMREAD_COLOR);
  const cv::Mat right = cv::imread(std::string(folder) + "/image_3/000000.png", cv::IMREAD_COLOR);
  if (left.empty() || right.empty()) return make_wall();
  Pair pair;
  cv::cvtColor(left, pair.left, cv::COLOR_BGR2GRAY);
  cv::cvtColor(right, pair.right, cv::COLOR_BGR2GRAY);
  return pair;
}

}  // namespace brink::benchmarks
