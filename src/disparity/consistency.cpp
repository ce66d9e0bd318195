#include "disparity/consistency.hpp"

#include <tbb/parallel_for.h>

#include "disparity/consistency_simd.hpp"

namespace brink {

cv::Mat1f check_consistency(const cv::Mat1f& left, const cv::Mat1f& right, float threshold_px) {
  cv::Mat1f checked(left.size());
  tbb::parallel_for(0, left.rows,
                    [&](int v) { check_consistency_row(left[v], right[v], left.cols, threshold_px, checked[v]); });
  return checked;
}

}  // namespace brink
