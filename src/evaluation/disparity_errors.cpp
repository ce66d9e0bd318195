#include <array>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "brink/evaluation.hpp"

namespace brink {
namespace {

void require_size(const char* name, const cv::Mat& picture, const cv::Mat1f& disparity) {
  if (picture.size() == disparity.size()) return;
  throw std::invalid_argument(fmt::format("{} = {}x{} px, must be {}x{} like the disparity", name, picture.cols, picture.rows,
                                          disparity.cols, disparity.rows));
}

struct Sums {
  int known = 0;
  int valid = 0;
  std::array<int, 3> off{};  // valid ones that are off by more than 1, 2, 3 px
  double error = 0.0;
};

Sums add_up(const cv::Mat1f& disparity, const cv::Mat1f& truth, const cv::Mat1b& mask) {
  Sums sums;
  for (int v = 0; v < truth.rows; ++v) {
    for (int u = 0; u < truth.cols; ++u) {
      const bool is_known = truth(v, u) > 0.0F && std::isfinite(truth(v, u));  // some files mark the unknown by infinity
      if (!is_known || (!mask.empty() && mask(v, u) == 0)) continue;
      ++sums.known;
      if (!(disparity(v, u) >= 0.0F && std::isfinite(disparity(v, u)))) continue;
      ++sums.valid;
      const double error = std::abs(static_cast<double>(disparity(v, u)) - static_cast<double>(truth(v, u)));
      sums.error += error;
      for (std::size_t i = 0; i < sums.off.size(); ++i) sums.off.at(i) += error > static_cast<double>(i + 1) ? 1 : 0;
    }
  }
  return sums;
}

}  // namespace

DisparityErrors compute_disparity_errors(const cv::Mat1f& disparity, const cv::Mat1f& truth, const cv::Mat1b& mask) {
  require_size("truth", truth, disparity);
  if (!mask.empty()) require_size("mask", mask, disparity);
  const Sums sums = add_up(disparity, truth, mask);
  if (sums.known == 0) throw std::invalid_argument("pixels of known disparity = 0, must be 1 or more");

  const auto share_of_valid = [&sums](int part) { return sums.valid == 0 ? 0.0 : static_cast<double>(part) / sums.valid; };
  const auto share_of_known = [&sums](int part) { return static_cast<double>(part) / sums.known; };
  const int invalid = sums.known - sums.valid;
  DisparityErrors errors;
  errors.known_px = sums.known;
  errors.density = share_of_known(sums.valid);
  errors.bad_1 = share_of_valid(sums.off[0]);
  errors.bad_2 = share_of_valid(sums.off[1]);
  errors.bad_3 = share_of_valid(sums.off[2]);
  errors.bad_1_or_invalid = share_of_known(sums.off[0] + invalid);
  errors.bad_2_or_invalid = share_of_known(sums.off[1] + invalid);
  errors.bad_3_or_invalid = share_of_known(sums.off[2] + invalid);
  if (sums.valid > 0) errors.mean_error_px = sums.error / sums.valid;
  return errors;
}

}  // namespace brink
