#include "ego_motion/features.hpp"

#include <algorithm>
#include <cstddef>
#include <tuple>

#include <opencv2/imgproc.hpp>

#include "grouping.hpp"

namespace brink {
namespace {

/// Samples of the descriptor reach this far, and so do filter and gradient: features keep this distance from the border, px.
constexpr int kMargin = 8;

/// Centre +8, the ring around it +1, the ring around that -1: sums to 0.
cv::Mat1s filter_blobs(const cv::Mat1b& picture) {
  cv::Mat1s inner;
  cv::Mat1s outer;
  cv::boxFilter(picture, inner, CV_16S, {3, 3}, {-1, -1}, false);
  cv::boxFilter(picture, outer, CV_16S, {5, 5}, {-1, -1}, false);
  cv::Mat1s centre;
  picture.convertTo(centre, CV_16S, 7.0);
  cv::Mat1s response;
  cv::addWeighted(inner, 2.0, outer, -1.0, 0.0, response);
  response += centre;
  return response;
}

/// A checkerboard of 2x2 squares, with an empty middle row and column.
cv::Mat1s filter_corners(const cv::Mat1b& picture) {
  const cv::Mat1f kernel = (cv::Mat1f(1, 5) << -1, -1, 0, 1, 1);
  cv::Mat1s response;
  cv::sepFilter2D(picture, response, CV_16S, kernel, kernel);
  return response;
}

struct Gradients {
  cv::Mat1b u;
  cv::Mat1b v;
};

/// 5x5 Sobel, an eighth of full scale, 128 = none.
Gradients compute_gradients(const cv::Mat1b& picture) {
  const cv::Mat1f derivative = (cv::Mat1f(1, 5) << -1 / 128.0F, -2 / 128.0F, 0, 2 / 128.0F, 1 / 128.0F);
  const cv::Mat1f smooth = (cv::Mat1f(1, 5) << 1, 4, 6, 4, 1);
  Gradients gradients;
  cv::sepFilter2D(picture, gradients.u, CV_8U, derivative, smooth, {-1, -1}, 128.0);
  cv::sepFilter2D(picture, gradients.v, CV_8U, smooth, derivative, {-1, -1}, 128.0);
  return gradients;
}

FeatureDescriptor describe(const Gradients& gradients, cv::Point place) {
  static const std::array<cv::Point, 16> samples = {{{-1, -1},
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
  FeatureDescriptor descriptor;
  std::size_t i = 0;
  for (const cv::Point& sample : samples) {
    descriptor[i++] = gradients.u(place + sample);
    descriptor[i++] = gradients.v(place + sample);
  }
  return descriptor;
}

struct Extremum {
  cv::Point place;
  FeatureClass kind;
  int strength;
};

/// Whether no value in the (2 radius + 1)^2 neighbourhood is more extreme. @param sign -1 = minimum, 1 = maximum.
bool is_extremum(const cv::Mat1s& response, cv::Point place, int sign, int radius) {
  const int value = sign * response(place);
  for (int v = place.y - radius; v <= place.y + radius; ++v) {
    const short* row = response[v];
    for (int u = place.x - radius; u <= place.x + radius; ++u) {
      if (sign * row[u] > value) return false;
    }
  }
  return true;
}

/// The least and the greatest value of each column of a band of rows.
struct Band {
  std::vector<short> least;
  std::vector<short> greatest;
  void set(const cv::Mat1s& response, int first_row, int rows) {
    least.assign(response[first_row], response[first_row] + response.cols);
    greatest = least;
    for (int v = first_row + 1; v < first_row + rows; ++v) {
      const short* const row = response[v];
      for (std::size_t u = 0; u < least.size(); ++u) {
        least[u] = std::min(least[u], row[u]);
        greatest[u] = std::max(greatest[u], row[u]);
      }
    }
  }
};

/// The first place in a block, row by row, that has a value; there must be one.
cv::Point find_value(const cv::Mat1s& response, cv::Point corner, int side, short value) {
  for (int v = corner.y; v < corner.y + side; ++v) {
    const short* const row = response[v] + corner.x;
    const short* const found = std::find(row, row + side, value);
    if (found != row + side) return {corner.x + static_cast<int>(found - row), v};
  }
  return corner;
}

/// The least and the greatest value of each block that are extrema of their neighbourhood.
void find_extrema(const cv::Mat1s& response, FeatureClass minimum, FeatureClass maximum, const EgoMotionParams& params,
                  std::vector<Extremum>& extrema) {
  const int side = params.feature_radius_px + 1;
  const int margin = std::max(kMargin, params.feature_radius_px);
  Band band;
  for (int v = margin; v + side + margin <= response.rows; v += side) {
    band.set(response, v, side);
    for (int u = margin; u + side + margin <= response.cols; u += side) {
      const short least = *std::min_element(band.least.begin() + u, band.least.begin() + u + side);
      const short greatest = *std::max_element(band.greatest.begin() + u, band.greatest.begin() + u + side);
      for (const auto& [value, sign, kind] : {std::tuple{least, -1, minimum}, std::tuple{greatest, 1, maximum}}) {
        const int strength = sign * value;
        if (strength < params.min_response) continue;
        const cv::Point place = find_value(response, {u, v}, side, value);
        if (is_extremum(response, place, sign, params.feature_radius_px)) extrema.push_back({place, kind, strength});
      }
    }
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
  Groups squares = group_items(extrema, square_count, square_of);
  std::vector<Extremum> kept;
  for (std::size_t square = 0; square < square_count; ++square) {
    const auto begin = squares.items.begin() + static_cast<std::ptrdiff_t>(squares.begins[square]);
    const auto end = squares.items.begin() + static_cast<std::ptrdiff_t>(squares.begins[square + 1]);
    const auto last = begin + std::min<std::ptrdiff_t>(per_bucket, end - begin);
    std::partial_sort(begin, last, end, [&extrema](std::size_t a, std::size_t b) {
      return extrema[a].strength != extrema[b].strength ? extrema[a].strength > extrema[b].strength : a < b;
    });
    for (auto one = begin; one != last; ++one) kept.push_back(extrema[*one]);
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
  std::vector<Extremum> extrema;
  find_extrema(filter_blobs(searched), FeatureClass::blob_minimum, FeatureClass::blob_maximum, params, extrema);
  find_extrema(filter_corners(searched), FeatureClass::corner_minimum, FeatureClass::corner_maximum, params, extrema);
  const Gradients gradients = compute_gradients(searched);
  std::vector<Feature> features;
  for (const Extremum& extremum :
       keep_strongest(extrema, searched.size(), params.feature_bucket_px / step, params.features_per_bucket)) {
    const float offset = step == 2 ? 0.5F : 0.0F;  // the centre of a 2x2 mean lies between its pixels
    const cv::Point2f position(static_cast<float>(step * extremum.place.x) + offset,
                               static_cast<float>(step * extremum.place.y) + offset);
    features.push_back({position, extremum.kind, extremum.strength, describe(gradients, extremum.place)});
  }
  return features;
}

}  // namespace brink
