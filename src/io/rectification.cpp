#include "io/rectification.hpp"

#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <opencv2/imgproc.hpp>

namespace brink {
namespace {

cv::Matx33d matrix_of(const LensCamera& camera) {
  return {camera.focal_x, 0.0, camera.cx, 0.0, camera.focal_y, camera.cy, 0.0, 0.0, 1.0};
}

RectificationMaps make_maps(const LensCamera& camera, const cv::Matx33d& rotation, const cv::Matx34d& projection) {
  RectificationMaps maps;
  cv::initUndistortRectifyMap(matrix_of(camera), camera.distortion, rotation, projection, camera.size, CV_16SC2, maps.places,
                              maps.fractions);
  return maps;
}

}  // namespace

cv::Mat RectificationMaps::apply(const cv::Mat& picture) const {
  cv::Mat rectified;
  cv::remap(picture, rectified, places, fractions, cv::INTER_LINEAR);
  return rectified;
}

Rectification make_rectification(const LensCamera& left, const LensCamera& right, const Eigen::Isometry3d& right_from_left) {
  cv::Matx33d rotation;
  cv::Vec3d translation;
  const Eigen::Matrix3d turn = right_from_left.linear();
  const Eigen::Vector3d shift = right_from_left.translation();
  cv::eigen2cv(turn, rotation);
  cv::eigen2cv(shift, translation);
  cv::Matx33d left_rotation;
  cv::Matx33d right_rotation;
  cv::Matx34d left_projection;
  cv::Matx34d right_projection;
  cv::Matx44d reprojection;
  constexpr double kNoBlackBorder = 0.0;
  cv::stereoRectify(matrix_of(left), left.distortion, matrix_of(right), right.distortion, left.size, rotation, translation,
                    left_rotation, right_rotation, left_projection, right_projection, reprojection, cv::CALIB_ZERO_DISPARITY,
                    kNoBlackBorder);
  Rectification result;
  result.size = left.size;
  const double focal = left_projection(0, 0);
  result.camera = {focal, left_projection(0, 2), left_projection(1, 2), -right_projection(0, 3) / focal};
  cv::cv2eigen(left_rotation, result.rectified_from_left);
  result.left = make_maps(left, left_rotation, left_projection);
  result.right = make_maps(right, right_rotation, right_projection);
  return result;
}

}  // namespace brink
