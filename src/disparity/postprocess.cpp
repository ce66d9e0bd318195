#include "disparity/postprocess.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "brink/disparity.hpp"
#include "disparity/postprocess_simd.hpp"
#include "disparity/valid_bits_simd.hpp"
#include "joined.hpp"

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
void change_lines(cv::Mat1f& disparity, const Change& change) {
  if (disparity.empty()) return;
  tbb::parallel_for(0, disparity.rows, [&](int v) { change(Line(disparity[v], 1, disparity.cols)); });
  const auto row_step = static_cast<std::ptrdiff_t>(disparity.step1());
  tbb::parallel_for(0, disparity.cols, [&](int u) { change(Line(disparity[0] + u, row_step, disparity.rows)); });
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

/// @param valid which pixels are; those that are filled are added.
void fill_gaps_of_row(const Line& row, int max_width, bool across_steps, PixelBits& valid) {
  ValidBits bits;
  find_valid_bits(&row[0], row.size(), std::numeric_limits<float>::infinity(), bits);
  valid = bits.valid;
  int gap = 0;  // where it begins, 0 = not behind a valid pixel
  for_each_run(bits, [&](int begin, int end) {
    if (gap > 0 && begin - gap <= max_width) {
      fill_gap(row, gap, begin, across_steps);
      for (int u = gap; u < begin; ++u) {
        if (row.is_valid(u)) valid[static_cast<std::size_t>(u / 64)] |= std::uint64_t{1} << static_cast<unsigned>(u % 64);
      }
    }
    gap = end;
  });
}

/// In up to 64 columns together. @param valid of each row.
void fill_gaps_of_columns(cv::Mat1f& image, const std::vector<PixelBits>& valid, std::size_t word, int max_width,
                          bool across_steps) {
  const auto row_step = static_cast<std::ptrdiff_t>(image.step1());
  const auto valid_in = [&](int v) { return valid[static_cast<std::size_t>(v)][word]; };
  for (int v = 1; v < image.rows; ++v) {
    std::uint64_t open = valid_in(v) & ~valid_in(v - 1);  // what begins here, as long as no valid pixel is met above
    for (int begin = v - 1; open != 0 && begin > 0 && v - begin <= max_width; --begin) {
      for_each_bit(open & valid_in(begin - 1), word,
                   [&](int u) { fill_gap(Line(image[0] + u, row_step, image.rows), begin, v, across_steps); });
      open &= ~valid_in(begin - 1);
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

/// Runs of valid pixels that are alike, joined to segments.
class Segments {
 public:
  struct Run {
    int v = 0;
    int begin = 0;
    int end = 0;
    int parent = 0;  ///< a run of the same segment, itself for the first one
    int size = 0;    ///< of the first one: of all runs, px
  };

  [[nodiscard]] int count() const { return static_cast<int>(runs_.size()); }
  [[nodiscard]] const Run& run(int i) const { return runs_[static_cast<std::size_t>(i)]; }
  void add(int v, int begin, int end) { runs_.push_back({v, begin, end, count(), end - begin}); }
  /// Adds the runs of lower rows, which are joined already.
  void append(const Segments& lower) {
    const int first = count();
    runs_.insert(runs_.end(), lower.runs_.begin(), lower.runs_.end());
    for (auto run = runs_.begin() + first; run != runs_.end(); ++run) run->parent += first;
  }
  void join(int a, int b) {
    a = first_of(a);
    b = first_of(b);
    if (a == b) return;
    runs_[static_cast<std::size_t>(std::max(a, b))].parent = std::min(a, b);
    runs_[static_cast<std::size_t>(std::min(a, b))].size += run(std::max(a, b)).size;
  }
  /// Pixels of the segment that a run belongs to.
  [[nodiscard]] int size_of(int i) { return run(first_of(i)).size; }

 private:
  [[nodiscard]] int first_of(int i) { return find_first(runs_, i, &Run::parent); }

  std::vector<Run> runs_;
};

/// Joins the runs of two rows that touch in pixels which are alike.
void join_rows(const float* upper, cv::Range upper_runs, const float* lower, cv::Range lower_runs, float similarity_px,
               Segments& segments) {
  int i = upper_runs.start;
  int j = lower_runs.start;
  while (i < upper_runs.end && j < lower_runs.end) {
    const Segments::Run& a = segments.run(i);
    const Segments::Run& b = segments.run(j);
    for (int u = std::max(a.begin, b.begin); u < std::min(a.end, b.end); ++u) {
      if (std::abs(upper[u] - lower[u]) > similarity_px) continue;
      segments.join(i, j);
      break;
    }
    (a.end <= b.end ? i : j) += 1;
  }
}

/// Rows of a picture with their segments.
struct Band {
  cv::Range rows;
  Segments segments;
  cv::Range top;     ///< runs of the first row
  cv::Range bottom;  ///< of the last one
};

void find_segments(const cv::Mat1f& disparity, float similarity_px, Band& band) {
  Segments& segments = band.segments;
  ValidBits bits;
  for (int v = band.rows.start; v < band.rows.end; ++v) {
    const int first = segments.count();
    find_valid_bits(disparity[v], disparity.cols, similarity_px, bits);
    for_each_run(bits, [&](int begin, int end) { segments.add(v, begin, end); });
    const cv::Range here(first, segments.count());
    if (v > band.rows.start) {
      join_rows(disparity[v - 1], band.bottom, disparity[v], here, similarity_px, segments);
    } else {
      band.top = here;
    }
    band.bottom = here;
  }
}

/// Appends the band below.
void join_bands(const cv::Mat1f& disparity, const Band& lower, float similarity_px, Band& upper) {
  const int first = upper.segments.count();
  const auto moved = [first](const cv::Range& runs) { return cv::Range(runs.start + first, runs.end + first); };
  upper.segments.append(lower.segments);
  const int v = lower.rows.start;
  join_rows(disparity[v - 1], upper.bottom, disparity[v], moved(lower.top), similarity_px, upper.segments);
  upper.bottom = moved(lower.bottom);
  upper.rows.end = lower.rows.end;
}

}  // namespace

void remove_speckles(cv::Mat1f& disparity, float similarity_px, int min_size_px) {
  if (disparity.empty()) return;
  // Segments are found as runs: similar neighbours of a row, joined to those of the row above; band by band side by side.
  constexpr int kRows = 90;
  std::vector<Band> bands;
  for (int v = 0; v < disparity.rows; v += kRows) {
    bands.emplace_back();
    bands.back().rows = {v, std::min(v + kRows, disparity.rows)};
  }
  tbb::parallel_for(std::size_t{0}, bands.size(), [&](std::size_t k) { find_segments(disparity, similarity_px, bands[k]); });
  Band& all = bands.front();
  for (std::size_t k = 1; k < bands.size(); ++k) join_bands(disparity, bands[k], similarity_px, all);
  for (int i = 0; i < all.segments.count(); ++i) {
    if (all.segments.size_of(i) >= min_size_px) continue;
    const Segments::Run& run = all.segments.run(i);
    std::fill(disparity[run.v] + run.begin, disparity[run.v] + run.end, kInvalidDisparity);
  }
}

void fill_gaps(cv::Mat1f& disparity, int max_width_px, bool across_steps) {
  if (disparity.empty()) return;
  std::vector<PixelBits> valid(static_cast<std::size_t>(disparity.rows));
  tbb::parallel_for(0, disparity.rows, [&](int v) {
    const Line row(disparity[v], 1, disparity.cols);
    fill_gaps_of_row(row, max_width_px, across_steps, valid[static_cast<std::size_t>(v)]);
  });
  tbb::parallel_for(std::size_t{0}, valid.front().size(),
                    [&](std::size_t word) { fill_gaps_of_columns(disparity, valid, word, max_width_px, across_steps); });
}

void extend_to_borders(cv::Mat1f& disparity, int max_width_px) {
  change_lines(disparity, [max_width_px](const Line& line) { extend_line(line, max_width_px); });
}

cv::Mat1f filter_adaptive_mean(const cv::Mat1f& disparity) {
  const int width = disparity.cols;
  const int height = disparity.rows;
  cv::Mat1f result(disparity.size());
  // Some rows at a time: what becomes of a row is still in the cache when its columns are filtered.
  constexpr int kRows = 64;
  tbb::parallel_for(tbb::blocked_range<int>(0, height, kRows), [&](const tbb::blocked_range<int>& rows) {
    std::array<const float*, 2 * kReach + 1> around{};
    std::vector<float> padded(static_cast<std::size_t>(width) + around.size(), kInvalidDisparity);
    cv::Mat1f along_rows(static_cast<int>(rows.size()) + 2 * kReach, width);
    const int first = rows.begin() - kReach;
    for (int v = first; v < rows.end() + kReach; ++v) {
      if (v < 0 || v >= height) {
        std::fill_n(along_rows[v - first], width, kInvalidDisparity);
        continue;
      }
      std::copy_n(disparity[v], width, padded.begin() + kReach);
      for (std::size_t k = 0; k < around.size(); ++k) around[k] = padded.data() + k;
      filter_mean_line(around, width, along_rows[v - first]);
    }
    for (int v = rows.begin(); v < rows.end(); ++v) {
      for (std::size_t k = 0; k < around.size(); ++k) around[k] = along_rows[v - rows.begin() + static_cast<int>(k)];
      filter_mean_line(around, width, result[v]);
    }
  });
  return result;
}

void filter_median(cv::Mat1f& disparity) {
  change_lines(disparity, [](const Line& line) { filter_line(line, median); });
}

}  // namespace brink
