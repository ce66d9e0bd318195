#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "ego_motion/matching.hpp"
#include "grouping.hpp"

namespace brink {

/// Matches sorted into squares of the current left picture, as many as there are between the outermost ones.
class MatchGrid {
 public:
  /// @param side of a square, px.
  MatchGrid(const std::vector<CircularMatch>& matches, double side) {
    if (matches.empty()) return;
    std::vector<cv::Point> squares;
    squares.reserve(matches.size());
    for (const CircularMatch& match : matches) {
      const cv::Point2f place = match.current_left;
      squares.emplace_back(static_cast<int>(std::floor(place.x / side)), static_cast<int>(std::floor(place.y / side)));
    }
    const auto [left, right] = std::ranges::minmax(squares, {}, &cv::Point::x);
    const auto [top, bottom] = std::ranges::minmax(squares, {}, &cv::Point::y);
    columns_ = right.x - left.x + 1;
    rows_ = bottom.y - top.y + 1;
    for (cv::Point& square : squares) square -= cv::Point(left.x, top.y);
    squares_ = group_items(squares, begin_of(rows_, 0), [this](cv::Point square) { return begin_of(square.y, square.x); });
    squares_of_ = std::move(squares);
  }

  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] int columns() const { return columns_; }
  /// Column and row of the square of a match.
  [[nodiscard]] cv::Point square_of(std::size_t match) const { return squares_of_[match]; }
  /// The numbers of the matches in the squares [begin, end) of a row, square by square, those of a square in their order.
  [[nodiscard]] std::span<const std::size_t> matches(int row, int begin, int end) const {
    const std::size_t first = squares_.begins[begin_of(row, begin)];
    return {squares_.items.data() + first, squares_.begins[begin_of(row, end)] - first};
  }

 private:
  [[nodiscard]] std::size_t begin_of(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }

  int rows_ = 0;
  int columns_ = 0;
  std::vector<cv::Point> squares_of_;
  Groups squares_;
};

}  // namespace brink
