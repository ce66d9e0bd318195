#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "brink/camera.hpp"
#include "brink/ego_motion.hpp"
#include "ego_motion/features.hpp"
#include "ego_motion/matching_simd.hpp"

namespace brink {

/// Where to look for a feature: a rectangle, px, borders included.
struct SearchWindow {
  cv::Point2f least;
  cv::Point2f greatest;
};

/// The features of one picture, sorted into bins, so that a window is searched without looking at all of them.
class FeatureIndex {
 public:
  /// @param size of the picture.
  FeatureIndex(std::vector<Feature> features, cv::Size size);
  [[nodiscard]] const std::vector<Feature>& features() const { return features_; }
  [[nodiscard]] const Feature& operator[](int i) const { return features_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] int size() const { return static_cast<int>(features_.size()); }

  /// The feature in the window that looks most like this one; empty when none is similar enough or two are alike.
  [[nodiscard]] std::optional<int> find(const Feature& feature, const SearchWindow& window,
                                        const EgoMotionParams& params) const;

 private:
  [[nodiscard]] int strip_of(float u) const;
  [[nodiscard]] int row_of(float v) const;
  [[nodiscard]] std::size_t bin(FeatureClass kind, int strip, int row) const;

  std::vector<Feature> features_;
  int strips_ = 1;
  int rows_ = 1;
  // Class by class, strip by strip, row by row of a strip: the part of a window that is in one strip lies in one piece.
  FeatureColumns columns_;
  std::vector<std::size_t> numbers_;  ///< of the columns' features in features_
  std::vector<std::size_t> begins_;   ///< of each bin in the columns, and their end
};

/// Features of both pictures of a frame.
struct StereoFeatures {
  FeatureIndex left;
  FeatureIndex right;
};

/// A feature of the left picture seen in the right one as well.
struct StereoMatch {
  int left = 0;
  int right = 0;
};

/// A feature seen in all four pictures, px.
struct CircularMatch {
  cv::Point2f previous_left;
  cv::Point2f previous_right;
  cv::Point2f current_left;
  cv::Point2f current_right;
  int cost = 0;  ///< sum over the circle
};

/// Mutual best matches of a pair, in the order of the left features.
std::vector<StereoMatch> match_stereo(const StereoFeatures& frame, const EgoMotionParams& params);

/// Previous left -> previous right -> current right -> current left -> previous left: what comes back to where it started.
/// @param predicted motion around which is searched. @param radius half size of the temporal windows, px.
std::vector<CircularMatch> match_circular(const StereoFeatures& previous, const StereoFeatures& current,
                                          const StereoCamera& camera, const Eigen::Isometry3d& predicted, double radius,
                                          const EgoMotionParams& params);

}  // namespace brink
