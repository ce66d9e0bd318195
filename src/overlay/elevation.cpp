#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "brink/overlay.hpp"
#include "overlay/marks.hpp"

namespace brink {
namespace {

constexpr double kLimit = 1.0;  // m: all that is higher or lower has the colour of this
constexpr int kLevels = 256;

struct Stop {
  double elevation;  // m
  cv::Vec3d color;   // B, G, R
};

// The step between -0.15 and -0.10 m, where the paper's ground and obstacles part, is what catches the eye.
const std::array<Stop, 6> kStops{{{-kLimit, {60.0, 0.0, 70.0}},
                                  {-0.15, {60.0, 70.0, 255.0}},
                                  {-0.10, {70.0, 150.0, 70.0}},
                                  {0.10, {70.0, 190.0, 90.0}},
                                  {0.20, {190.0, 130.0, 60.0}},
                                  {kLimit, {255.0, 235.0, 210.0}}}};

cv::Vec3d color_of(double elevation) {
  const auto* above =
      std::find_if(kStops.begin() + 1, kStops.end() - 1, [elevation](const Stop& stop) { return elevation <= stop.elevation; });
  const Stop& low = *(above - 1);
  const double share = (elevation - low.elevation) / (above->elevation - low.elevation);
  return low.color * (1.0 - share) + above->color * share;
}

// Lowest first.
cv::Mat3b elevation_colors() {
  cv::Mat3b colors(kLevels, 1);
  for (int level = 0; level < kLevels; ++level) {
    colors(level, 0) = cv::Vec3b(color_of(kLimit * (2.0 * level / (kLevels - 1) - 1.0)));
  }
  return colors;
}

}  // namespace

cv::Mat3b draw_elevation(const cv::Mat1f& elevation) {
  if (elevation.empty()) return {};
  const cv::Mat3b colors = elevation_colors();
  cv::Mat3b picture(elevation.size());
  picture.forEach([&](cv::Vec3b& pixel, const int* at) {
    const double value = elevation(at[0], at[1]);
    const double level = (std::clamp(value, -kLimit, kLimit) / kLimit + 1.0) / 2.0 * (kLevels - 1);
    pixel = std::isnan(value) ? cv::Vec3b(0, 0, 0) : colors(cvRound(level), 0);
  });
  draw_color_scale(picture, colors, "-1 m", "+1 m");
  return picture;
}

}  // namespace brink
