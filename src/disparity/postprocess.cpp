#include "disparity/postprocess.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include <tbb/parallel_for.h>

#include "brink/disparity.hpp"

namespace brink {
namespace {

/// Half window of the mean and of the median, px.
constexpr int kReach = 3;

/// One row or column of an image.
class Line {
 public:
  Line(float* first, std::ptrdiff_t step, int size) : first_(first), step_(step), size_(size) {}
  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] float& operator[](int i) const { return first_[i * step_]; }
  [[nodiscard]] bool is_valid(int i) const { return (*this)[i] != kInvalidDisparity; }

 private:
  float* first_;
  std::ptrdiff_t step_;
  int size_;
};

/// Applies `change` to each row, then to each column of the result.
template <typename Change>
cv::Mat1f change_lines(const cv::Mat1f& disparity, const Change& change) {
  cv::Mat1f result = disparity.clone();
  if (result.empty()) return result;
  tbb::parallel_for(0, result.rows, [&](int v) { change(Line(result[v], 1, result.cols)); });
  const auto row_step = static_cast<std::ptrdiff_t>(result.step1());
  tbb::parallel_for(0, result.cols, [&](int u) { change(Line(result[0] + u, row_step, result.rows)); });
  return result;
}

/// Fills line[begin, end) between two valid pixels: a straight line where both lie on one surface.
void fill_gap(const Line& line, int begin, int end, bool across_steps) {
  constexpr float kSameSurface = 3.0F;
  const float before = line[begin - 1];
  const float after = line[end];
  if (std::abs(before - after) < kSameSurface) {
    const float slope = (after - before) / static_cast<float>(end - begin + 1);
    for (int i = begin; i < end; ++i) line[i] = before + slope * static_cast<float>(i - begin + 1);
  } else if (across_steps) {
    for (int i = begin; i < end; ++i) line[i] = std::min(before, after);
  }
}

void fill_gaps_of_line(const Line& line, int max_width, bool across_steps) {
  int begin = 0;  // one behind the last valid pixel
  for (int i = 0; i < line.size(); ++i) {
    if (!line.is_valid(i)) continue;
    if (begin > 0 && i - begin <= max_width) fill_gap(line, begin, i, across_steps);
    begin = i + 1;
  }
}

void extend_line(const Line& line, int max_width) {
  int first = 0;
  while (first < line.size() && !line.is_valid(first)) ++first;
  if (first == line.size()) return;
  int last = line.size() - 1;
  while (!line.is_valid(last)) --last;
  for (int i = std::max(0, first - max_width); i < first; ++i) line[i] = line[first];
  for (int i = last + 1; i <= std::min(line.size() - 1, last + max_width); ++i) line[i] = line[last];
}

/// Replaces each valid pixel of a line by `value` of its index in a copy of the line.
template <typename Value>
void filter_line(const Line& line, const Value& value) {
  std::vector<float> copy(static_cast<std::size_t>(line.size()));
  for (int i = 0; i < line.size(); ++i) copy[static_cast<std::size_t>(i)] = line[i];
  const Line source(copy.data(), 1, line.size());
  for (int i = 0; i < line.size(); ++i) {
    if (line.is_valid(i)) line[i] = value(source, i);
  }
}

float adaptive_mean(const Line& line, int i) {
  constexpr float kStep = 4.0F;
  float sum = 0.0F;
  float weights = 0.0F;
  for (int k = std::max(0, i - kReach); k <= std::min(line.size() - 1, i + kReach); ++k) {
    if (!line.is_valid(k)) continue;
    const float weight = std::max(0.0F, kStep - std::abs(line[k] - line[i]));
    sum += weight * line[k];
    weights += weight;
  }
  return sum / weights;
}

float median(const Line& line, int i) {
  std::array<float, 2 * kReach + 1> values{};
  auto* last = values.begin();
  for (int k = std::max(0, i - kReach); k <= std::min(line.size() - 1, i + kReach); ++k) {
    if (line.is_valid(k)) *last++ = line[k];
  }
  auto* const middle = values.begin() + (last - values.begin() - 1) / 2;
  std::nth_element(values.begin(), middle, last);
  return *middle;
}

}  // namespace

cv::Mat1f remove_speckles(const cv::Mat1f& disparity, float similarity_px, int min_size_px) {
  const std::array<cv::Point, 4> neighbors = {cv::Point{0, -1}, {-1, 0}, {1, 0}, {0, 1}};
  const cv::Rect picture(cv::Point(), disparity.size());
  cv::Mat1f result = disparity.clone();
  cv::Mat1b visited(disparity.size(), std::uint8_t{0});
  std::vector<cv::Point> segment;
  for (int v = 0; v < disparity.rows; ++v) {
    for (int u = 0; u < disparity.cols; ++u) {
      if (visited(v, u) != 0 || disparity(v, u) == kInvalidDisparity) continue;
      segment.assign(1, {u, v});
      visited(v, u) = 1;
      for (std::size_t next = 0; next < segment.size(); ++next) {
        const cv::Point at = segment[next];
        for (const cv::Point& step : neighbors) {
          const cv::Point neighbor = at + step;
          if (!picture.contains(neighbor) || visited(neighbor) != 0 || disparity(neighbor) == kInvalidDisparity) continue;
          if (std::abs(disparity(neighbor) - disparity(at)) > similarity_px) continue;
          visited(neighbor) = 1;
          segment.push_back(neighbor);
        }
      }
      if (segment.size() >= static_cast<std::size_t>(min_size_px)) continue;
      for (const cv::Point& pixel : segment) result(pixel) = kInvalidDisparity;
    }
  }
  return result;
}

cv::Mat1f fill_gaps(const cv::Mat1f& disparity, int max_width_px, bool across_steps) {
  return change_lines(disparity, [=](const Line& line) { fill_gaps_of_line(line, max_width_px, across_steps); });
}

cv::Mat1f extend_to_borders(const cv::Mat1f& disparity, int max_width_px) {
  return change_lines(disparity, [max_width_px](const Line& line) { extend_line(line, max_width_px); });
}

cv::Mat1f filter_adaptive_mean(const cv::Mat1f& disparity) {
  return change_lines(disparity, [](const Line& line) { filter_line(line, adaptive_mean); });
}

cv::Mat1f filter_median(const cv::Mat1f& disparity) {
  return change_lines(disparity, [](const Line& line) { filter_line(line, median); });
}

}  // namespace brink
