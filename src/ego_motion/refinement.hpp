#pragma once

#include <array>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace brink {

/// Half side of the square of pixels that is compared, px.
inline constexpr int kPatchRadius = 5;
inline constexpr int kPatchSide = 2 * kPatchRadius + 1;
inline constexpr int kPatchPixels = kPatchSide * kPatchSide;

/// A small square of a picture, prepared to be found in other pictures to a fraction of a pixel.
struct Patch {
  cv::Point centre;                              ///< px, where it was taken
  std::array<float, kPatchPixels> level{};       ///< grey levels less their mean
  std::array<float, kPatchPixels> gradient_u{};  ///< per px, less its mean
  std::array<float, kPatchPixels> gradient_v{};
  Eigen::Matrix2f inverse_hessian = Eigen::Matrix2f::Zero();
  float contrast = 0.0F;  ///< sum of squared levels
};

/// Takes a patch of a smoothed picture. @return empty at the border, and without texture in both directions.
std::optional<Patch> make_patch(const cv::Mat1b& smooth, cv::Point centre);

/// Where a patch is.
struct Alignment {
  Eigen::Vector2d position;    ///< px
  Eigen::Matrix2d covariance;  ///< px^2, from the differences of levels that remain
};

/// A patch, and where it is sought.
struct PatchSearch {
  const Patch* patch;
  Eigen::Vector2d start;  ///< where it is expected, px
  Eigen::Matrix2d warp;   ///< offsets from the centre of the patch -> offsets there
};

/// Inverse compositional alignment (Baker, Matthews, IJCV 2004) with a free brightness offset.
/// @param smooth picture searched, smoothed as the patches' were. @param reach greatest distance from the start, px.
/// @return for each search; empty when it leaves the picture, goes too far, does not settle, or what is found does not look
/// alike.
std::vector<std::optional<Alignment>> align_patches(const std::vector<PatchSearch>& searches, const cv::Mat1b& smooth,
                                                    double reach);

/// What patches are taken from and searched in: less noise, and bilinear interpolation does less harm.
cv::Mat1b smooth_for_patches(const cv::Mat1b& picture);

}  // namespace brink
