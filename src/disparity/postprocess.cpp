#include "disparity/postprocess.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "brink/disparity.hpp"
#include "disparity/postprocess_simd.hpp"

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

/// Whether line[begin, end) is to be filled. @param begin one behind the last valid pixel, 0 = none.
bool is_gap(int begin, int end, int max_width) { return 0 < begin && begin < end && end - begin <= max_width; }

void fill_gaps_of_row(const Line& row, int max_width, bool across_steps) {
  int begin = 0;
  for (int u = 0; u < row.size(); ++u) {
    if (!row.is_valid(u)) continue;
    if (is_gap(begin, u, max_width)) fill_gap(row, begin, u, across_steps);
    begin = u + 1;
  }
}

/// In some columns at a time, row by row, in which order they lie in memory.
void fill_gaps_of_columns(cv::Mat1f& image, const cv::Range& columns, int max_width, bool across_steps) {
  const auto row_step = static_cast<std::ptrdiff_t>(image.step1());
  std::vector<int> begins(static_cast<std::size_t>(columns.size()), 0);
  for (int v = 0; v < image.rows; ++v) {
    const float* const row = image[v] + columns.start;
    for (std::size_t i = 0; i < begins.size(); ++i) {
      if (row[i] == kInvalidDisparity) continue;
      if (is_gap(begins[i], v, max_width)) {
        fill_gap(Line(image[0] + columns.start + i, row_step, image.rows), begins[i], v, across_steps);
      }
      begins[i] = v + 1;
    }
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

/// Valid pixels [begin, end) of row v, neighbours alike.
struct Run {
  int v = 0;
  int begin = 0;
  int end = 0;
};

/// Runs that are joined to segments.
class Segments {
 public:
  [[nodiscard]] int count() const { return static_cast<int>(runs_.size()); }
  [[nodiscard]] const Run& run(int i) const { return runs_[static_cast<std::size_t>(i)]; }
  void add(const Run& run) {
    parents_.push_back(count());
    sizes_.push_back(run.end - run.begin);
    runs_.push_back(run);
  }
  void join(int a, int b) {
    a = root_of(a);
    b = root_of(b);
    if (a == b) return;
    parents_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    sizes_[static_cast<std::size_t>(std::min(a, b))] += sizes_[static_cast<std::size_t>(std::max(a, b))];
  }
  /// Pixels of the segment that a run belongs to.
  [[nodiscard]] int size_of(int i) { return sizes_[static_cast<std::size_t>(root_of(i))]; }

 private:
  [[nodiscard]] int root_of(int i) {
    int& parent = parents_[static_cast<std::size_t>(i)];
    while (parents_[static_cast<std::size_t>(parent)] != parent) parent = parents_[static_cast<std::size_t>(parent)];
    return parent;
  }

  std::vector<Run> runs_;
  std::vector<int> parents_;
  std::vector<int> sizes_;  ///< of a root: of all its runs, px
};

void add_runs(const float* row, int v, int width, float similarity_px, Segments& segments) {
  int u = 0;
  while (u < width) {
    if (row[u] == kInvalidDisparity) {
      ++u;
      continue;
    }
    Run run{v, u, u + 1};
    while (run.end < width && row[run.end] != kInvalidDisparity && std::abs(row[run.end] - row[run.end - 1]) <= similarity_px) {
      ++run.end;
    }
    segments.add(run);
    u = run.end;
  }
}

/// Joins the runs of two rows that touch in pixels which are alike.
void join_rows(const float* upper, cv::Range upper_runs, const float* lower, cv::Range lower_runs, float similarity_px,
               Segments& segments) {
  int i = upper_runs.start;
  int j = lower_runs.start;
  while (i < upper_runs.end && j < lower_runs.end) {
    const Run a = segments.run(i);
    const Run b = segments.run(j);
    for (int u = std::max(a.begin, b.begin); u < std::min(a.end, b.end); ++u) {
      if (std::abs(upper[u] - lower[u]) > similarity_px) continue;
      segments.join(i, j);
      break;
    }
    (a.end <= b.end ? i : j) += 1;
  }
}

}  // namespace

cv::Mat1f remove_speckles(const cv::Mat1f& disparity, float similarity_px, int min_size_px) {
  // Segments are found as runs: similar neighbours of a row, joined to those of the row above.
  Segments segments;
  cv::Range above(0, 0);  // the runs of the row above
  for (int v = 0; v < disparity.rows; ++v) {
    const int first = segments.count();
    add_runs(disparity[v], v, disparity.cols, similarity_px, segments);
    const cv::Range here(first, segments.count());
    if (v > 0) join_rows(disparity[v - 1], above, disparity[v], here, similarity_px, segments);
    above = here;
  }
  cv::Mat1f result = disparity.clone();
  for (int i = 0; i < segments.count(); ++i) {
    if (segments.size_of(i) >= min_size_px) continue;
    const Run& run = segments.run(i);
    std::fill(result[run.v] + run.begin, result[run.v] + run.end, kInvalidDisparity);
  }
  return result;
}

cv::Mat1f fill_gaps(const cv::Mat1f& disparity, int max_width_px, bool across_steps) {
  cv::Mat1f result = disparity.clone();
  if (result.empty()) return result;
  tbb::parallel_for(0, result.rows,
                    [&](int v) { fill_gaps_of_row(Line(result[v], 1, result.cols), max_width_px, across_steps); });
  constexpr int kColumns = 128;
  tbb::parallel_for(tbb::blocked_range<int>(0, result.cols, kColumns), [&](const tbb::blocked_range<int>& columns) {
    fill_gaps_of_columns(result, {columns.begin(), columns.end()}, max_width_px, across_steps);
  });
  return result;
}

cv::Mat1f extend_to_borders(const cv::Mat1f& disparity, int max_width_px) {
  return change_lines(disparity, [max_width_px](const Line& line) { extend_line(line, max_width_px); });
}

cv::Mat1f filter_adaptive_mean(const cv::Mat1f& disparity) {
  const cv::Size size = disparity.size();
  cv::Mat1f along_rows(size);
  tbb::parallel_for(0, size.height, [&](int v) {
    std::array<const float*, 2 * kReach + 1> around{};
    std::vector<float> padded(static_cast<std::size_t>(size.width) + around.size(), kInvalidDisparity);
    std::copy_n(disparity[v], size.width, padded.begin() + kReach);
    for (std::size_t k = 0; k < around.size(); ++k) around[k] = padded.data() + k;
    filter_mean_line(around, size.width, along_rows[v]);
  });
  const std::vector<float> outside(static_cast<std::size_t>(size.width), kInvalidDisparity);
  cv::Mat1f result(size);
  tbb::parallel_for(0, size.height, [&](int v) {
    std::array<const float*, 2 * kReach + 1> around{};
    for (std::size_t k = 0; k < around.size(); ++k) {
      const int row = v - kReach + static_cast<int>(k);
      around[k] = row >= 0 && row < size.height ? along_rows[row] : outside.data();
    }
    filter_mean_line(around, size.width, result[v]);
  });
  return result;
}

cv::Mat1f filter_median(const cv::Mat1f& disparity) {
  return change_lines(disparity, [](const Line& line) { filter_line(line, median); });
}

}  // namespace brink
