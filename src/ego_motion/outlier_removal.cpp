#include "ego_motion/outlier_removal.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "ego_motion/match_grid.hpp"

namespace brink {
namespace {

bool agree(const CircularMatch& a, const CircularMatch& b, const EgoMotionParams& params) {
  const cv::Point2f apart = a.current_left - b.current_left;
  if (std::max(std::abs(apart.x), std::abs(apart.y)) > params.neighbour_radius_px) return false;
  const double distance = std::hypot(apart.x, apart.y);
  if (distance > params.neighbour_radius_px) return false;
  const double tolerance = params.neighbour_tolerance_px + params.neighbour_tolerance * distance;
  const cv::Point2f left = (a.current_left - a.previous_left) - (b.current_left - b.previous_left);
  const cv::Point2f right = (a.current_right - a.previous_right) - (b.current_right - b.previous_right);
  const float disparity = (a.current_left.x - a.current_right.x) - (b.current_left.x - b.current_right.x);
  return std::abs(disparity) < tolerance && std::hypot(left.x, left.y) < tolerance && std::hypot(right.x, right.y) < tolerance;
}

}  // namespace

std::vector<CircularMatch> remove_outliers(const std::vector<CircularMatch>& matches, const EgoMotionParams& params) {
  const MatchGrid grid(matches, params.neighbour_radius_px);
  const auto count_support = [&](std::size_t match) {
    const cv::Point square = grid.square_of(match);
    const int begin = std::max(square.x - 1, 0);
    const int end = std::min(square.x + 2, grid.columns());
    int support = 0;
    for (int row = std::max(square.y - 1, 0); row < std::min(square.y + 2, grid.rows()); ++row) {
      for (const std::size_t other : grid.matches(row, begin, end)) {
        support += other != match && agree(matches[match], matches[other], params) ? 1 : 0;
        if (support >= params.neighbour_support) return support;
      }
    }
    return support;
  };
  std::vector<CircularMatch> kept;
  kept.reserve(matches.size());
  for (std::size_t match = 0; match < matches.size(); ++match) {
    if (count_support(match) >= params.neighbour_support) kept.push_back(matches[match]);
  }
  return kept;
}

}  // namespace brink
