#include "ego_motion/right_eye.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Cholesky>
#include <tbb/parallel_for.h>

namespace brink {
namespace {

constexpr double kReach = 3.0;         // px: of what is found around what is expected
constexpr double kRowTolerance = 1.5;  // px: of the aligned rows of a pair
constexpr double kModelError = 0.03;   // px: what warping and interpolation leave, whatever the levels tell
constexpr int kPlaneRadius = 3;        // px: half side of the square of disparities that a plane is fitted to
constexpr double kLeastShare = 0.75;   // of the square's pixels must have a disparity
constexpr double kMostSpread = 0.75;   // px: of disparities around their plane; a step leaves a quarter of its height
constexpr double kAlikePixels = 9.0;   // so many neighbours have one noise: matching and filters spread it
constexpr double kUnknownRow = 100.0;  // px: the standard deviation of a row that nobody measured

Eigen::Matrix2d with_model_error(const Eigen::Matrix2d& covariance) {
  return covariance + kModelError * kModelError * Eigen::Matrix2d::Identity();
}

/// The right picture shows the points by themselves: their errors there have nothing to do with those on the left.
std::vector<std::optional<RightPlace>> find_in_picture(const cv::Mat1b& right, const std::vector<RightSearch>& searches) {
  std::vector<PatchSearch> patches;
  patches.reserve(searches.size());
  for (const RightSearch& search : searches) patches.push_back(search.here);
  const auto found = align_patches(patches, right, kReach);
  std::vector<std::optional<RightPlace>> places(searches.size());
  for (std::size_t i = 0; i < searches.size(); ++i) {
    const Alignment& left = searches[i].left;
    if (!found[i] || std::abs(left.position.y() - found[i]->position.y()) > kRowTolerance) continue;
    RightPlace& place = places[i].emplace(RightPlace{found[i]->position, Eigen::Matrix4d::Zero()});
    place.covariance.topLeftCorner<2, 2>() = with_model_error(left.covariance);
    place.covariance.bottomRightCorner<2, 2>() = with_model_error(found[i]->covariance);
  }
  return places;
}

/// u_right = u - d, on the same row: the errors on the left show on the right as well.
std::optional<RightPlace> find_by_disparity(const cv::Mat1f& disparity, const Alignment& left) {
  const auto reading = read_disparity_at(disparity, left.position);
  if (!reading) return std::nullopt;
  const Eigen::Matrix2d shared = with_model_error(left.covariance);
  const Eigen::Vector2d own(reading->variance, kUnknownRow * kUnknownRow);
  RightPlace place{left.position - Eigen::Vector2d(reading->disparity, 0.0), Eigen::Matrix4d::Zero()};
  place.covariance << shared, shared, shared, shared + Eigen::Matrix2d(own.asDiagonal());
  return place;
}

}  // namespace

SmoothPair make_smooth_pair(const Frame& frame) {
  return {smooth_for_patches(frame.left), frame.right.empty() ? cv::Mat1b() : smooth_for_patches(frame.right), frame.disparity};
}

std::vector<Feature> find_right_features(const Frame& frame, const std::vector<Feature>& left, const EgoMotionParams& params) {
  if (frame.disparity.empty()) return find_features(frame.right, params);
  std::vector<Feature> right;
  right.reserve(left.size());
  for (Feature feature : left) {
    const auto reading = read_disparity_at(frame.disparity, {feature.position.x, feature.position.y});
    if (!reading) continue;
    feature.position.x -= static_cast<float>(reading->disparity);
    right.push_back(feature);
  }
  return right;
}

std::optional<DisparityReading> read_disparity_at(const cv::Mat1f& disparity, const Eigen::Vector2d& position) {
  const int column = static_cast<int>(std::lround(position.x()));
  const int row = static_cast<int>(std::lround(position.y()));
  if (std::min(column, row) < kPlaneRadius || column >= disparity.cols - kPlaneRadius || row >= disparity.rows - kPlaneRadius)
    return std::nullopt;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right_side = Eigen::Vector3d::Zero();
  double squares = 0.0;
  int count = 0;
  for (int v = row - kPlaneRadius; v <= row + kPlaneRadius; ++v) {
    for (int u = column - kPlaneRadius; u <= column + kPlaneRadius; ++u) {
      const double d = disparity(v, u);
      if (d < 0.0) continue;
      const Eigen::Vector3d x(u - position.x(), v - position.y(), 1.0);
      normal += x * x.transpose();
      right_side += d * x;
      squares += d * d;
      ++count;
    }
  }
  constexpr int kSide = 2 * kPlaneRadius + 1;
  if (count < kLeastShare * kSide * kSide) return std::nullopt;
  const Eigen::Vector3d plane = normal.llt().solve(right_side);
  const double spread = std::max(squares - plane.dot(right_side), 0.0) / (count - 3);
  if (spread > kMostSpread * kMostSpread) return std::nullopt;
  return DisparityReading{plane[2], std::max(kModelError * kModelError, spread * kAlikePixels / count)};
}

std::vector<std::optional<RightPlace>> find_in_right(const SmoothPair& frame, const std::vector<RightSearch>& searches) {
  if (frame.disparity.empty()) return find_in_picture(frame.right, searches);
  std::vector<std::optional<RightPlace>> places(searches.size());
  tbb::parallel_for(std::size_t{0}, searches.size(),
                    [&](std::size_t i) { places[i] = find_by_disparity(frame.disparity, searches[i].left); });
  return places;
}

}  // namespace brink
