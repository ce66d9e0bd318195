#include "ego_motion/matching.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>

#include <tbb/parallel_for.h>

namespace brink {
namespace {

constexpr int kSquare = 32;  // px

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
    : features_(std::move(features)), columns_(size.width / kSquare + 1), rows_(size.height / kSquare + 1) {
  const auto square_of = [this](const Feature& feature) {
    const int square = row_of(feature.position.y) * columns_ + column_of(feature.position.x);
    return static_cast<std::size_t>(square);
  };
  // Counted, then put in their places: those of a square stay in the features' order.
  for (Squares& squares : squares_) squares.begins.assign(static_cast<std::size_t>(columns_ * rows_) + 1, 0);
  for (const Feature& feature : features_) {
    ++squares_[static_cast<std::size_t>(feature.kind)].begins[square_of(feature) + 1];
  }
  for (Squares& squares : squares_) {
    std::partial_sum(squares.begins.begin(), squares.begins.end(), squares.begins.begin());
    squares.entries.resize(static_cast<std::size_t>(squares.begins.back()));
  }
  std::array<std::vector<int>, kFeatureClasses> next;
  for (std::size_t kind = 0; kind < kFeatureClasses; ++kind) next[kind] = squares_[kind].begins;
  for (int i = 0; i < this->size(); ++i) {
    const Feature& feature = (*this)[i];
    const auto kind = static_cast<std::size_t>(feature.kind);
    const int place = next[kind][square_of(feature)]++;
    squares_[kind].entries[static_cast<std::size_t>(place)] = {feature.position, i, feature.descriptor};
  }
}

int FeatureIndex::column_of(float u) const {
  return static_cast<int>(std::clamp(u / kSquare, 0.0F, static_cast<float>(columns_ - 1)));
}

int FeatureIndex::row_of(float v) const {
  return static_cast<int>(std::clamp(v / kSquare, 0.0F, static_cast<float>(rows_ - 1)));
}

std::optional<int> FeatureIndex::find(const Feature& feature, const SearchWindow& window, const EgoMotionParams& params) const {
  int best = -1;
  int best_cost = std::numeric_limits<int>::max();
  int second_cost = std::numeric_limits<int>::max();
  const Squares& squares = squares_[static_cast<std::size_t>(feature.kind)];
  const auto begin_of = [&](int row, int column) {
    const int square = row * columns_ + column;
    return squares.begins[static_cast<std::size_t>(square)];
  };
  const int first = column_of(window.least.x);
  const int last = column_of(window.greatest.x);
  for (int row = row_of(window.least.y); row <= row_of(window.greatest.y); ++row) {
    const int end = begin_of(row, last + 1);
    for (int k = begin_of(row, first); k < end; ++k) {
      const Entry& other = squares.entries[static_cast<std::size_t>(k)];
      const bool inside = other.position.x >= window.least.x && other.position.x <= window.greatest.x &&
                          other.position.y >= window.least.y && other.position.y <= window.greatest.y;
      if (!inside) continue;
      const int cost = compute_cost(feature.descriptor, other.descriptor);
      if (cost < best_cost) {
        second_cost = std::exchange(best_cost, cost);
        best = other.index;
      } else {
        second_cost = std::min(second_cost, cost);
      }
    }
  }
  if (best < 0 || best_cost > params.max_match_cost || best_cost >= params.match_ratio * second_cost) return std::nullopt;
  return best;
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
