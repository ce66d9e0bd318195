#pragma once

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

namespace brink {

/// Computes the yardstick Y, whose time others are measured in: OpenCV's StereoSGBM, three ways, 128 disparities, one thread.
inline void run_yardstick(const cv::Mat1b& left, const cv::Mat1b& right) {
  const auto matcher = cv::StereoSGBM::create(0, 128, 5, 200, 800, 1, 0, 10, 100, 32, cv::StereoSGBM::MODE_SGBM_3WAY);
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  cv::Mat disparity;
  matcher->compute(left, right, disparity);
  cv::setNumThreads(threads);
}

}  // namespace brink
