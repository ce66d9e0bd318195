#include "ego_motion/features.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdlib>
#include <functional>
#include <limits>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "ego_motion/features_simd.hpp"
#include "grouping.hpp"

namespace brink {
namespace {

/// Samples of the descriptor reach this far, and so do filter and gradient: features keep this distance from the border, px.
constexpr int kMargin = 8;

/// All that features are found with, of each pixel: FilteredRow.
struct Filtered {
  explicit Filtered(cv::Size size) : blobs(size), corners(size), gradients(size) {}
  cv::Mat1s blobs;
  cv::Mat1s corners;
  cv::Mat1w gradients;
};

Filtered filter(const cv::Mat1b& picture) {
  cv::Mat1b wide;
  cv::copyMakeBorder(picture, wide, kFilterRadius, kFilterRadius, kFilterRadius, kFilterRadius, cv::BORDER_REFLECT_101);
  Filtered filtered(picture.size());
  std::vector<std::int16_t> scratch(filter_scratch(picture.cols));
  for (int v = 0; v < picture.rows; ++v) {
    filter_row({wide[v], wide[v + 1], wide[v + 2], wide[v + 3], wide[v + 4]}, picture.cols, scratch.data(),
               {filtered.blobs[v], filtered.corners[v], filtered.gradients[v]});
  }
  return filtered;
}

FeatureDescriptor describe(const cv::Mat1w& gradients, cv::Point place) {
  struct Offset {
    int u, v;
  };
  static constexpr std::array<Offset, 16> kSamples = {{{-1, -1},
                                                       {1, -1},
                                                       {-1, 1},
                                                       {1, 1},
                                                       {-3, -1},
                                                       {3, -1},
                                                       {-3, 1},
                                                       {3, 1},
                                                       {-1, -5},
                                                       {1, -5},
                                                       {-1, 5},
                                                       {1, 5},
                                                       {-5, -3},
                                                       {5, -3},
                                                       {-5, 3},
                                                       {5, 3}}};
  const ushort* const centre = gradients[place.y] + place.x;
  const auto stride = static_cast<std::ptrdiff_t>(gradients.step1());
  FeatureDescriptor descriptor;
  std::size_t i = 0;
  for (const Offset& sample : kSamples) {
    const unsigned pair = centre[sample.v * stride + sample.u];
    descriptor[i++] = static_cast<std::uint8_t>(pair & 0xFFU);
    descriptor[i++] = static_cast<std::uint8_t>(pair >> 8U);
  }
  return descriptor;
}

struct Extremum {
  cv::Point place;
  FeatureClass kind;
  int strength;
};

/// Whether no pixel of a block before this one, row by row, has the same value.
bool is_first(const cv::Mat1s& response, cv::Point corner, int side, cv::Point place) {
  const short value = response(place);
  for (int v = corner.y; v <= place.y; ++v) {
    const short* const row = response[v];
    const int end = v < place.y ? corner.x + side : place.x;
    for (int u = corner.x; u < end; ++u) {
      if (row[u] == value) return false;
    }
  }
  return true;
}

/// Extrema of a band of blocks: of each block the first minimum, number 2 block, and the first maximum, row by row.
class BandExtrema {
 public:
  explicit BandExtrema(int blocks) : places_(2 * static_cast<std::size_t>(blocks)), taken_(places_.size() / 64 + 1) {}
  void clear() { std::fill(taken_.begin(), taken_.end(), 0); }
  void add(std::size_t number, cv::Point place) {
    std::uint64_t& word = taken_[number / 64];
    const std::uint64_t bit = std::uint64_t{1} << number % 64;
    if ((word & bit) != 0) return;
    word |= bit;
    places_[number] = place;
  }
  /// Calls take(number, place) for each.
  template <typename Take>
  void for_each(const Take& take) const {
    for (std::size_t i = 0; i < taken_.size(); ++i) {
      for (std::uint64_t word = taken_[i]; word != 0; word &= word - 1) {
        const std::size_t number = 64 * i + static_cast<std::size_t>(std::countr_zero(word));
        take(number, places_[number]);
      }
    }
  }

 private:
  std::vector<cv::Point> places_;
  std::vector<std::uint64_t> taken_;  ///< a bit for each place
};

/// The least and the greatest value of each block that are extrema of their neighbourhood.
void find_extrema(const cv::Mat1s& response, FeatureClass minimum, FeatureClass maximum, const EgoMotionParams& params,
                  std::vector<Extremum>& extrema) {
  const int radius = params.feature_radius_px;
  const int side = radius + 1;
  const int margin = std::max(kMargin, radius);
  const int blocks = (response.cols - 2 * margin) / side;
  if (blocks <= 0) return;
  const int end = margin + blocks * side;
  std::vector<const short*> rows(static_cast<std::size_t>(2 * radius + 1));
  std::vector<short> scratch(extrema_scratch(margin, end, radius));
  std::vector<int> columns(static_cast<std::size_t>(end - margin) + kSpareColumns);
  BandExtrema band(blocks);
  for (int v = margin; v + side + margin <= response.rows; v += side) {
    band.clear();
    for (int y = v; y < v + side; ++y) {
      for (int i = 0; i <= 2 * radius; ++i) rows[static_cast<std::size_t>(i)] = response[y - radius + i];
      const std::size_t count =
          find_row_extrema(rows.data(), radius, margin, end, params.min_response, scratch.data(), columns.data());
      for (std::size_t i = 0; i < count; ++i) {
        const int u = columns[i];
        band.add(2 * static_cast<std::size_t>((u - margin) / side) + (response(y, u) > 0 ? 1 : 0), {u, y});
      }
    }
    band.for_each([&](std::size_t number, cv::Point place) {
      const cv::Point corner(margin + static_cast<int>(number / 2) * side, v);
      // One of several equal values of the block counts only when the first of them does.
      if (!is_first(response, corner, side, place)) return;
      extrema.push_back({place, number % 2 == 0 ? minimum : maximum, std::abs(int{response(place)})});
    });
  }
}

/// The strongest of each square, square by square; ties go to the one found first.
std::vector<Extremum> keep_strongest(const std::vector<Extremum>& extrema, cv::Size size, int bucket, int per_bucket) {
  const int columns = size.width / bucket + 1;
  const int rows = size.height / bucket + 1;
  const auto square_of = [&](const Extremum& extremum) {
    const int square = extremum.place.y / bucket * columns + extremum.place.x / bucket;
    return static_cast<std::size_t>(square);
  };
  const auto square_count = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  const Groups squares = group_items(extrema, square_count, square_of);
  std::vector<std::uint64_t> keys(extrema.size());  // the strongest is the greatest, of equal ones the first
  std::transform(squares.items.begin(), squares.items.end(), keys.begin(), [&extrema](std::size_t i) {
    return (static_cast<std::uint64_t>(extrema[i].strength) << 32U) | (std::numeric_limits<std::uint32_t>::max() - i);
  });
  std::vector<Extremum> kept;
  kept.reserve(extrema.size());
  for (std::size_t square = 0; square < square_count; ++square) {
    const auto begin = keys.begin() + static_cast<std::ptrdiff_t>(squares.begins[square]);
    const auto end = keys.begin() + static_cast<std::ptrdiff_t>(squares.begins[square + 1]);
    const auto last = begin + std::min<std::ptrdiff_t>(per_bucket, end - begin);
    std::partial_sort(begin, last, end, std::greater<>());
    for (auto key = begin; key != last; ++key) {
      kept.push_back(extrema[std::numeric_limits<std::uint32_t>::max() - static_cast<std::uint32_t>(*key)]);
    }
  }
  return kept;
}

/// Means of 2x2 pixels.
cv::Mat1b halve(const cv::Mat1b& picture) {
  cv::Mat1b half;
  cv::resize(picture, half, {picture.cols / 2, picture.rows / 2}, 0, 0, cv::INTER_AREA);
  return half;
}

}  // namespace

std::vector<Feature> find_features(const cv::Mat1b& picture, const EgoMotionParams& params) {
  const int step = static_cast<int>(picture.total()) >= params.half_resolution_from_px ? 2 : 1;
  const cv::Mat1b searched = step == 2 ? halve(picture) : picture;
  const Filtered filtered = filter(searched);
  std::vector<Extremum> extrema;
  find_extrema(filtered.blobs, FeatureClass::blob_minimum, FeatureClass::blob_maximum, params, extrema);
  find_extrema(filtered.corners, FeatureClass::corner_minimum, FeatureClass::corner_maximum, params, extrema);
  const std::vector<Extremum> kept =
      keep_strongest(extrema, searched.size(), params.feature_bucket_px / step, params.features_per_bucket);
  std::vector<Feature> features;
  features.reserve(kept.size());
  for (const Extremum& extremum : kept) {
    const float offset = step == 2 ? 0.5F : 0.0F;  // the centre of a 2x2 mean lies between its pixels
    const cv::Point2f position(static_cast<float>(step * extremum.place.x) + offset,
                               static_cast<float>(step * extremum.place.y) + offset);
    features.push_back({position, extremum.kind, extremum.strength, describe(filtered.gradients, extremum.place)});
  }
  return features;
}

}  // namespace brink
