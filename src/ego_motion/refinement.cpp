#include "ego_motion/refinement.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include <Eigen/LU>
#include <opencv2/imgproc.hpp>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "ego_motion/refinement_simd.hpp"

namespace brink {
namespace {

constexpr int kMaxIterations = 12;
constexpr double kSettled = 0.005;          // px: a tenth of the noise
constexpr float kLeastCurvature = 400.0F;   // smaller eigenvalue of the Hessian, grey levels^2: noise alone stays below
constexpr float kLeastCorrelation = 0.75F;  // of levels, patch and picture

using Levels = std::array<float, kPatchPixels>;

void subtract_mean(Levels& values) {
  const float mean = std::accumulate(values.begin(), values.end(), 0.0F) / kPatchPixels;
  for (float& value : values) value -= mean;
}

float dot(const Levels& a, const Levels& b) { return std::inner_product(a.begin(), a.end(), b.begin(), 0.0F); }

/// Whether the warped square around a position is inside the picture.
bool is_inside(const cv::Mat1b& picture, const Eigen::Vector2d& position, const Eigen::Matrix2d& warp) {
  const Eigen::Vector2d half = kPatchRadius * warp.cwiseAbs().rowwise().sum();
  return (position - half).minCoeff() >= 0.0 && position.x() + half.x() < picture.cols - 1 &&
         position.y() + half.y() < picture.rows - 1;
}

/// Aligns patches one after the other, several at a time: as soon as one is done the next one takes its lane.
class Aligner {
 public:
  Aligner(const std::vector<PatchSearch>& searches, const cv::Mat1b& smooth, double reach)
      : searches_(searches), smooth_(smooth), reach_(reach) {}

  /// Aligns the patches [begin, end).
  void run(std::size_t begin, std::size_t end, std::vector<std::optional<Alignment>>& found) {
    const PicturePixels picture{smooth_.data, smooth_.cols, smooth_.rows, static_cast<int>(smooth_.step1())};
    for (std::size_t next = begin;;) {
      bool any = false;
      for (std::size_t lane = 0; lane < kPatchLanes; ++lane) {
        while (!lanes_[lane].search && next < end) start(lane, searches_[next++]);
        any = any || lanes_[lane].search;
      }
      if (!any) return;
      const PatchComparison comparison = compare_patches(pixels_.data(), places_, picture);
      for (std::size_t lane = 0; lane < kPatchLanes; ++lane) {
        const PatchSearch* const search = lanes_[lane].search;
        if (search == nullptr) continue;
        if (const auto alignment = step(lane, comparison))
          found[static_cast<std::size_t>(search - searches_.data())] = alignment;
      }
    }
  }

 private:
  struct Lane {
    const PatchSearch* search = nullptr;  ///< none: the lane is free
    Eigen::Vector2d position = Eigen::Vector2d::Zero();
    int iterations = 0;
  };

  void start(std::size_t lane, const PatchSearch& search) {
    lanes_[lane] = {&search, search.start, 0};
    const Patch& patch = *search.patch;
    for (std::size_t i = 0; i < kPatchPixels; ++i) {
      pixels_[i].level[lane] = patch.level[i];
      pixels_[i].gradient_u[lane] = patch.gradient_u[i];
      pixels_[i].gradient_v[lane] = patch.gradient_v[i];
    }
    const Eigen::Matrix2f warp = search.warp.cast<float>();
    places_.u_by_x[lane] = warp(0, 0);
    places_.u_by_y[lane] = warp(0, 1);
    places_.v_by_x[lane] = warp(1, 0);
    places_.v_by_y[lane] = warp(1, 1);
    look_at_position(lane);
  }

  /// The lane is free again when its position is not inside the picture.
  void look_at_position(std::size_t lane) {
    Lane& state = lanes_[lane];
    if (!is_inside(smooth_, state.position, state.search->warp)) {
      state.search = nullptr;
      return;
    }
    places_.u[lane] = static_cast<float>(state.position.x());
    places_.v[lane] = static_cast<float>(state.position.y());
  }

  /// Moves the position by the least-squares shift of the patch, in its own coordinates, that explains the difference.
  std::optional<Alignment> step(std::size_t lane, const PatchComparison& comparison) {
    Lane& state = lanes_[lane];
    const PatchSearch& search = *state.search;
    const Eigen::Vector2f gradient(comparison.gradient_u[lane], comparison.gradient_v[lane]);
    const Eigen::Vector2f shift = search.patch->inverse_hessian * gradient;
    const Eigen::Vector2d step = search.warp * shift.cast<double>();
    state.position -= step;
    const bool within_reach = (state.position - search.start).norm() <= reach_;
    if (within_reach && step.norm() > kSettled && ++state.iterations < kMaxIterations) {
      look_at_position(lane);
      return std::nullopt;
    }
    state.search = nullptr;
    if (!within_reach || state.iterations == kMaxIterations) return std::nullopt;
    const auto covariance = judge(search, comparison, lane);
    if (!covariance) return std::nullopt;
    return Alignment{state.position, *covariance};
  }

  /// The covariance that the remaining differences tell; empty when they are too great.
  static std::optional<Eigen::Matrix2d> judge(const PatchSearch& search, const PatchComparison& comparison, std::size_t lane) {
    const float contrasts = search.patch->contrast * comparison.contrast[lane];
    if (comparison.correlation[lane] / std::sqrt(std::max(contrasts, 1e-6F)) < kLeastCorrelation) return std::nullopt;
    const float variance =
        comparison.squares[lane] / (kPatchPixels - 3) + 0.5F;  // at least what rounding to whole levels leaves
    return search.warp * (variance * search.patch->inverse_hessian).cast<double>() * search.warp.transpose();
  }

  const std::vector<PatchSearch>& searches_;
  const cv::Mat1b& smooth_;
  double reach_;
  std::array<Lane, kPatchLanes> lanes_;
  std::array<PatchPixels, kPatchPixels> pixels_;
  PatchPlaces places_;
};

}  // namespace

std::optional<Patch> make_patch(const cv::Mat1b& smooth, cv::Point centre) {
  const int reach = kPatchRadius + 1;
  if (centre.x < reach || centre.y < reach || centre.x >= smooth.cols - reach || centre.y >= smooth.rows - reach) {
    return std::nullopt;
  }
  Patch patch;
  patch.centre = centre;
  std::size_t i = 0;
  for (int y = centre.y - kPatchRadius; y <= centre.y + kPatchRadius; ++y) {
    for (int x = centre.x - kPatchRadius; x <= centre.x + kPatchRadius; ++x, ++i) {
      patch.level[i] = smooth(y, x);
      patch.gradient_u[i] = 0.5F * static_cast<float>(smooth(y, x + 1) - smooth(y, x - 1));
      patch.gradient_v[i] = 0.5F * static_cast<float>(smooth(y + 1, x) - smooth(y - 1, x));
    }
  }
  subtract_mean(patch.level);
  subtract_mean(patch.gradient_u);
  subtract_mean(patch.gradient_v);
  patch.contrast = dot(patch.level, patch.level);
  Eigen::Matrix2f hessian;
  hessian << dot(patch.gradient_u, patch.gradient_u), dot(patch.gradient_u, patch.gradient_v),
      dot(patch.gradient_u, patch.gradient_v), dot(patch.gradient_v, patch.gradient_v);
  const float half_trace = 0.5F * hessian.trace();
  const float least = half_trace - std::sqrt(std::max(half_trace * half_trace - hessian.determinant(), 0.0F));
  if (least < kLeastCurvature) return std::nullopt;
  patch.inverse_hessian = hessian.inverse();
  return patch;
}

std::vector<std::optional<Alignment>> align_patches(const std::vector<PatchSearch>& searches, const cv::Mat1b& smooth,
                                                    double reach) {
  constexpr std::size_t kAtOnce = 100;  // searches: few lanes are without one, and there is work for several threads
  std::vector<std::optional<Alignment>> found(searches.size());
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, searches.size(), kAtOnce),
      [&](const tbb::blocked_range<std::size_t>& range) {
        Aligner(searches, smooth, reach).run(range.begin(), range.end(), found);
      },
      tbb::simple_partitioner());
  return found;
}

cv::Mat1b smooth_for_patches(const cv::Mat1b& picture) {
  cv::Mat1b smooth;
  cv::GaussianBlur(picture, smooth, {5, 5}, 0.8);
  return smooth;
}

}  // namespace brink
