#include "ego_motion/outlier_removal.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

namespace brink {
namespace {

using Square = std::pair<int, int>;  // row, column

Square square_of(const CircularMatch& match, double side) {
  return {static_cast<int>(std::floor(match.current_left.y / side)), static_cast<int>(std::floor(match.current_left.x / side))};
}

bool agree(const CircularMatch& a, const CircularMatch& b, const EgoMotionParams& params) {
  const cv::Point2f apart = a.current_left - b.current_left;
  const double distance = std::hypot(apart.x, apart.y);
  if (distance > params.neighbour_radius_px) return false;
  const double tolerance = params.neighbour_tolerance_px + params.neighbour_tolerance * distance;
  const cv::Point2f left = (a.current_left - a.previous_left) - (b.current_left - b.previous_left);
  const cv::Point2f right = (a.current_right - a.previous_right) - (b.current_right - b.previous_right);
  const float disparity = (a.current_left.x - a.current_right.x) - (b.current_left.x - b.current_right.x);
  return std::hypot(left.x, left.y) < tolerance && std::hypot(right.x, right.y) < tolerance && std::abs(disparity) < tolerance;
}

}  // namespace

std::vector<CircularMatch> remove_outliers(const std::vector<CircularMatch>& matches, const EgoMotionParams& params) {
  std::map<Square, std::vector<const CircularMatch*>> squares;
  for (const CircularMatch& match : matches) squares[square_of(match, params.neighbour_radius_px)].push_back(&match);
  const auto count_support = [&](const CircularMatch& match) {
    const auto [row, column] = square_of(match, params.neighbour_radius_px);
    int support = 0;
    for (int y = row - 1; y <= row + 1; ++y) {
      for (int x = column - 1; x <= column + 1; ++x) {
        const auto square = squares.find({y, x});
        if (square == squares.end()) continue;
        for (const CircularMatch* other : square->second) {
          support += other != &match && agree(match, *other, params) ? 1 : 0;
          if (support >= params.neighbour_support) return support;
        }
      }
    }
    return support;
  };
  std::vector<CircularMatch> kept;
  for (const CircularMatch& match : matches) {
    if (count_support(match) >= params.neighbour_support) kept.push_back(match);
  }
  return kept;
}

}  // namespace brink
