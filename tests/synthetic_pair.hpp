#pragma once

#include <cmath>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "synthetic_scene.hpp"

namespace brink::test {

struct Pair {
  cv::Mat1b left;
  cv::Mat1b right;
};

/// Random texture without repetition, blurred a little so that disparities between whole pixels can be told.
inline cv::Mat1b make_texture(const cv::Size& size, unsigned seed) {
  cv::Mat1b texture(size);
  cv::RNG random(seed);
  random.fill(texture, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(texture, texture, {0, 0}, 0.8);
  return texture;
}

/// The pair that two cameras would take of a textured surface with these disparities: each left pixel is moved to the right
/// picture, the nearer one hides the farther one, and what only the right camera sees is noise.
inline Pair make_pair(const cv::Mat1f& disparity, unsigned seed = 1) {
  Pair pair{make_texture(disparity.size(), seed), make_texture(disparity.size(), seed + 1)};
  cv::Mat1f nearest(disparity.size(), -1.0F);
  for (int v = 0; v < disparity.rows; ++v) {
    for (int u = 0; u + 1 < disparity.cols; ++u) {
      const float d = disparity(v, u);
      const float next = disparity(v, u + 1);
      if (d < 0.0F || next < 0.0F || std::abs(next - d) >= 1.0F) continue;  // a step: no surface in between
      const float from = static_cast<float>(u) - d;
      const float to = static_cast<float>(u + 1) - next;
      for (int x = std::max(0, static_cast<int>(std::ceil(from))); x <= static_cast<int>(std::floor(to)) && x < disparity.cols;
           ++x) {
        if (d <= nearest(v, x)) continue;
        nearest(v, x) = d;
        const float share = (static_cast<float>(x) - from) / (to - from);
        const float level =
            (1.0F - share) * static_cast<float>(pair.left(v, u)) + share * static_cast<float>(pair.left(v, u + 1));
        pair.right(v, x) = cv::saturate_cast<uchar>(level);
      }
    }
  }
  return pair;
}

/// What a person 1.5 m tall sees who looks 30 degrees down: flat ground, with a hole 0.5 m deep, 2.2 to 3.4 m ahead if wanted.
inline Pair make_ground_pair(bool hole, unsigned seed = 1) {
  const StereoCamera camera = half_size_camera();
  const GroundPlane ground = make_ground_plane(1.5, 30.0, 0.0, camera);
  const Opening opening{2.2, 3.4, -0.6, 0.6, 0.5};
  return make_pair(make_disparity(camera, half_size(), ground, hole ? std::vector{opening} : std::vector<Opening>{}), seed);
}

/// calib.txt of half_size_camera.
inline const char* half_size_calibration() {
  return "P0: 350 0 319.5 0 0 350 179.5 0 0 0 1 0\nP1: 350 0 319.5 -52.5 0 350 179.5 0 0 0 1 0\n";
}

}  // namespace brink::test
