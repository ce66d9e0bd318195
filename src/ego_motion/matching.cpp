#include "ego_motion/matching.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <tbb/parallel_for.h>

#include "grouping.hpp"

namespace brink {
namespace {

constexpr int kStripWidth = 128;  // px: so that a window has few pieces ...
constexpr int kRowHeight = 4;     // px: ... and a search along a row looks at little else

SearchWindow around(cv::Point2f centre, double radius) {
  const auto r = static_cast<float>(radius);
  return {{centre.x - r, centre.y - r}, {centre.x + r, centre.y + r}};
}

SearchWindow right_window(cv::Point2f left, const EgoMotionParams& params) {
  const auto tolerance = static_cast<float>(params.row_tolerance_px);
  return {{left.x - static_cast<float>(params.max_disparity_px), left.y - tolerance}, {left.x, left.y + tolerance}};
}

SearchWindow left_window(cv::Point2f right, const EgoMotionParams& params) {
  const auto tolerance = static_cast<float>(params.row_tolerance_px);
  return {{right.x, right.y - tolerance}, {right.x + static_cast<float>(params.max_disparity_px), right.y + tolerance}};
}

/// Disparities below this say nothing about depth; they predict as if they were this far, px.
constexpr double kLeastDisparity = 0.5;

/// Where a point of the previous pair should lie now.
struct Prediction {
  cv::Point2f left;
  cv::Point2f right;
};

std::optional<Prediction> predict(cv::Point2f left, cv::Point2f right, const StereoCamera& camera,
                                  const Eigen::Isometry3d& current_from_previous) {
  const double disparity = std::max<double>(left.x - right.x, kLeastDisparity);
  const Eigen::Vector3d point = current_from_previous * camera.triangulate(left.x, left.y, disparity);
  if (point.z() <= 0.0) return std::nullopt;
  const Eigen::Vector3d pixel = camera.project(point);
  const cv::Point2f now(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
  return Prediction{now, {static_cast<float>(pixel.x() - pixel.z()), now.y}};
}

}  // namespace

FeatureIndex::FeatureIndex(std::vector<Feature> features, cv::Size size)
    : features_(std::move(features)), strips_(size.width / kStripWidth + 1), rows_(size.height / kRowHeight + 1) {
  Groups groups = group_items(features_, bin(static_cast<FeatureClass>(kFeatureClasses), 0, 0), [this](const Feature& feature) {
    return bin(feature.kind, strip_of(feature.position.x), row_of(feature.position.y));
  });
  columns_.u.reserve(features_.size() + FeatureColumns::kSpare);
  columns_.v.reserve(features_.size() + FeatureColumns::kSpare);
  columns_.descriptors.reserve(features_.size());
  for (const std::size_t i : groups.items) {
    columns_.u.push_back(features_[i].position.x);
    columns_.v.push_back(features_[i].position.y);
    columns_.descriptors.push_back(features_[i].descriptor);
  }
  columns_.u.resize(features_.size() + FeatureColumns::kSpare);
  columns_.v.resize(features_.size() + FeatureColumns::kSpare);
  numbers_ = std::move(groups.items);
  begins_ = std::move(groups.begins);
}

int FeatureIndex::strip_of(float u) const {
  return static_cast<int>(std::clamp(u / kStripWidth, 0.0F, static_cast<float>(strips_ - 1)));
}

int FeatureIndex::row_of(float v) const {
  return static_cast<int>(std::clamp(v / kRowHeight, 0.0F, static_cast<float>(rows_ - 1)));
}

std::size_t FeatureIndex::bin(FeatureClass kind, int strip, int row) const {
  const int all_strips = static_cast<int>(kind) * strips_ + strip;
  return static_cast<std::size_t>(all_strips) * static_cast<std::size_t>(rows_) + static_cast<std::size_t>(row);
}

std::optional<int> FeatureIndex::find(const Feature& feature, const SearchWindow& window, const EgoMotionParams& params) const {
  const auto& [least, greatest] = window;
  const int strip = strip_of(least.x);
  const int row = row_of(least.y);
  const FeaturePieces pieces{begins_.data() + bin(feature.kind, strip, row), static_cast<std::size_t>(rows_),
                             static_cast<std::size_t>(row_of(greatest.y) - row + 1),
                             static_cast<std::size_t>(strip_of(greatest.x) - strip + 1)};
  const BestTwo two = find_best_two(columns_, pieces, {least.x, least.y, greatest.x, greatest.y}, feature.descriptor);
  if (two.best < 0 || two.cost > params.max_match_cost || two.cost >= params.match_ratio * two.second_cost) return std::nullopt;
  return static_cast<int>(numbers_[static_cast<std::size_t>(two.best)]);
}

std::vector<StereoMatch> match_stereo(const StereoFeatures& frame, const EgoMotionParams& params) {
  std::vector<StereoMatch> matches;
  for (int left = 0; left < frame.left.size(); ++left) {
    const Feature& feature = frame.left[left];
    const auto right = frame.right.find(feature, right_window(feature.position, params), params);
    if (!right) continue;
    const auto back = frame.left.find(frame.right[*right], left_window(frame.right[*right].position, params), params);
    if (back == left) matches.push_back({left, *right});
  }
  return matches;
}

std::vector<CircularMatch> match_circular(const StereoFeatures& previous, const StereoFeatures& current,
                                          const StereoCamera& camera, const Eigen::Isometry3d& predicted, double radius,
                                          const EgoMotionParams& params) {
  const auto close_circle = [&](int start) -> std::optional<CircularMatch> {
    const Feature& a = previous.left[start];
    const auto previous_right = previous.right.find(a, right_window(a.position, params), params);
    if (!previous_right) return std::nullopt;
    const Feature& b = previous.right[*previous_right];
    const auto prediction = predict(a.position, b.position, camera, predicted);
    if (!prediction) return std::nullopt;
    const auto current_right = current.right.find(b, around(prediction->right, radius), params);
    if (!current_right) return std::nullopt;
    const Feature& c = current.right[*current_right];
    const auto current_left = current.left.find(c, left_window(c.position, params), params);
    if (!current_left) return std::nullopt;
    const Feature& d = current.left[*current_left];
    const auto back = previous.left.find(d, around(d.position - prediction->left + a.position, radius), params);
    if (back != start) return std::nullopt;
    const int cost = compute_cost(a.descriptor, b.descriptor) + compute_cost(b.descriptor, c.descriptor) +
                     compute_cost(c.descriptor, d.descriptor) + compute_cost(d.descriptor, a.descriptor);
    return CircularMatch{a.position, b.position, d.position, c.position, cost};
  };
  std::vector<std::optional<CircularMatch>> circles(static_cast<std::size_t>(previous.left.size()));
  tbb::parallel_for(0, previous.left.size(), [&](int i) { circles[static_cast<std::size_t>(i)] = close_circle(i); });
  std::vector<CircularMatch> matches;
  for (const auto& circle : circles) {
    if (circle) matches.push_back(*circle);
  }
  return matches;
}

}  // namespace brink
