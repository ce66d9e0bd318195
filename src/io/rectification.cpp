#include "io/rectification.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <opencv2/imgproc.hpp>

namespace brink {
namespace {

constexpr const char* kNoView = "leaves no view that both cameras share, expected the calibration of a lens";

cv::Matx33d matrix_of(const LensCamera& camera) {
  return {camera.focal_x, 0.0, camera.cx, 0.0, camera.focal_y, camera.cy, 0.0, 0.0, 1.0};
}

/// How both cameras are turned and how their rectified pictures are taken.
struct RectifiedViews {
  cv::Matx33d left_rotation;
  cv::Matx33d right_rotation;
  cv::Matx33d projection;  ///< of both
};

// Whether every ray, in a camera turned by `rotation`, comes from within the picture that the lens makes.
bool sees(const LensCamera& camera, const cv::Matx33d& rotation, const std::vector<cv::Vec3d>& rays) {
  std::vector<cv::Point2d> straight;
  for (const cv::Vec3d& turned : rays) {
    const cv::Vec3d ray = rotation.t() * turned;
    if (ray[2] <= 0.0) return false;
    straight.emplace_back(ray[0] / ray[2], ray[1] / ray[2]);
  }
  std::vector<cv::Point2d> pixels;
  if (camera.model == LensModel::fisheye) {
    cv::fisheye::distortPoints(straight, pixels, matrix_of(camera), camera.distortion);
  } else {
    std::vector<cv::Point3d> points;
    points.reserve(straight.size());
    for (const cv::Point2d& place : straight) points.emplace_back(place.x, place.y, 1.0);
    cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), matrix_of(camera), camera.distortion, pixels);
  }
  return std::all_of(pixels.begin(), pixels.end(), [&](const cv::Point2d& pixel) {
    return pixel.x >= 0.0 && pixel.y >= 0.0 && pixel.x <= camera.size.width - 1 && pixel.y <= camera.size.height - 1;
  });
}

// Rays through the border of a picture: what lies within them is seen when they are.
std::vector<cv::Vec3d> border_rays(const cv::Size& size, const cv::Matx33d& projection) {
  constexpr int kSteps = 64;  // a side
  const cv::Matx33d back = projection.inv();
  const double right = size.width - 1;
  const double bottom = size.height - 1;
  std::vector<cv::Vec3d> rays;
  for (int step = 0; step <= kSteps; ++step) {
    const double share = static_cast<double>(step) / kSteps;
    for (const cv::Point2d& pixel : {cv::Point2d(share * right, 0.0), cv::Point2d(share * right, bottom),
                                     cv::Point2d(0.0, share * bottom), cv::Point2d(right, share * bottom)}) {
      rays.emplace_back(back * cv::Vec3d(pixel.x, pixel.y, 1.0));
    }
  }
  return rays;
}

// Whether all pixels of both views have a source.
bool see_all(const LensCamera& left, const LensCamera& right, const RectifiedViews& views) {
  const std::vector<cv::Vec3d> rays = border_rays(left.size, views.projection);
  return sees(left, views.left_rotation, rays) && sees(right, views.right_rotation, rays);
}

// cv::stereoRectify knows the rim of its view by a few points: what it lacks beyond them is cut off.
RectifiedViews rectify_by_opencv(const LensCamera& left, const LensCamera& right, const cv::Matx33d& rotation,
                                 const cv::Vec3d& translation) {
  RectifiedViews views;
  cv::Matx34d left_projection;
  cv::Matx34d right_projection;
  cv::Matx44d reprojection;
  constexpr double kNoBlackBorder = 0.0;
  cv::stereoRectify(matrix_of(left), left.distortion, matrix_of(right), right.distortion, left.size, rotation, translation,
                    views.left_rotation, views.right_rotation, left_projection, right_projection, reprojection,
                    cv::CALIB_ZERO_DISPARITY, kNoBlackBorder);
  views.projection = left_projection.get_minor<3, 3>(0, 0);
  RectifiedViews closer = views;
  constexpr int kMostSteps = 100;
  constexpr double kStep = 1.001;
  for (int step = 0; step < kMostSteps && !see_all(left, right, closer); ++step) {
    closer.projection(0, 0) *= kStep;
    closer.projection(1, 1) *= kStep;
  }
  return see_all(left, right, closer) ? closer : views;
}

// The widest view without a pixel that lacks a source, from narrow to wide: beyond the rim of a lens its model means nothing.
RectifiedViews rectify_fisheye(const LensCamera& left, const LensCamera& right, const cv::Matx33d& rotation,
                               const cv::Vec3d& translation) {
  constexpr int kNarrowest = 20;  // half degrees across
  constexpr int kWidest = 220;
  LensCamera pinhole = left;
  pinhole.model = LensModel::radial_tangential;
  pinhole.distortion.clear();
  RectifiedViews views = rectify_by_opencv(pinhole, pinhole, rotation, translation);  // for the rotations
  views.projection = cv::Matx33d::zeros();
  for (int across = kNarrowest; across <= kWidest; ++across) {
    const double focal = left.size.width / (2.0 * std::tan(across / 4.0 * CV_PI / 180.0));
    RectifiedViews wider = views;
    wider.projection = {focal, 0.0, (left.size.width - 1) / 2.0, 0.0, focal, (left.size.height - 1) / 2.0, 0.0, 0.0, 1.0};
    if (!see_all(left, right, wider)) break;
    views = wider;
  }
  if (views.projection(0, 0) == 0.0) throw std::runtime_error(kNoView);
  return views;
}

RectificationMaps make_maps(const LensCamera& camera, const cv::Matx33d& rotation, const cv::Matx33d& projection) {
  RectificationMaps maps;
  if (camera.model == LensModel::fisheye) {
    cv::fisheye::initUndistortRectifyMap(matrix_of(camera), camera.distortion, rotation, projection, camera.size, CV_16SC2,
                                         maps.places, maps.fractions);
  } else {
    cv::initUndistortRectifyMap(matrix_of(camera), camera.distortion, rotation, projection, camera.size, CV_16SC2, maps.places,
                                maps.fractions);
  }
  return maps;
}

}  // namespace

bool LensCamera::is_pinhole() const {
  return model == LensModel::radial_tangential &&
         std::all_of(distortion.begin(), distortion.end(), [](double coefficient) { return coefficient == 0.0; });
}

std::string LensCamera::lens() const {
  if (is_pinhole()) return "no distortion";
  if (model == LensModel::fisheye) return "fisheye";
  constexpr std::size_t kWithK3 = 5;
  constexpr std::size_t kRational = 8;
  if (distortion.size() <= kWithK3) return "radial-tangential";
  return distortion.size() == kRational ? "rational" : "thin prism";
}

cv::Mat RectificationMaps::apply(const cv::Mat& picture) const {
  if (places.empty()) return picture;
  cv::Mat rectified;
  cv::remap(picture, rectified, places, fractions, cv::INTER_LINEAR);
  return rectified;
}

bool is_rectified(const LensCamera& left, const LensCamera& right, const Eigen::Isometry3d& right_from_left) {
  constexpr double kPixels = 1e-3;
  constexpr double kTurn = 1e-6;  // 1e-3 px at a focal length of 1000 px
  const bool equal = std::abs(left.focal_x - right.focal_x) < kPixels && std::abs(left.focal_x - left.focal_y) < kPixels &&
                     std::abs(right.focal_x - right.focal_y) < kPixels && std::abs(left.cx - right.cx) < kPixels &&
                     std::abs(left.cy - right.cy) < kPixels;
  const Eigen::Vector3d along = right_from_left.translation().normalized();
  return equal && left.is_pinhole() && right.is_pinhole() && right_from_left.linear().isIdentity(kTurn) &&
         along.isApprox(-Eigen::Vector3d::UnitX(), kTurn);
}

Rectification make_rectification(const LensCamera& left, const LensCamera& right, const Eigen::Isometry3d& right_from_left) {
  cv::Matx33d rotation;
  cv::Vec3d translation;
  const Eigen::Matrix3d turn = right_from_left.linear();
  const Eigen::Vector3d shift = right_from_left.translation();
  cv::eigen2cv(turn, rotation);
  cv::eigen2cv(shift, translation);
  const bool fisheye = left.model == LensModel::fisheye || right.model == LensModel::fisheye;
  const RectifiedViews views =
      fisheye ? rectify_fisheye(left, right, rotation, translation) : rectify_by_opencv(left, right, rotation, translation);
  Rectification result;
  result.size = left.size;
  const double focal = views.projection(0, 0);
  constexpr double kMostZoom = 10.0;  // coefficients that mean nothing give views of next to nothing
  if (!(focal > left.focal_x / kMostZoom) || focal > left.focal_x * kMostZoom) throw std::runtime_error(kNoView);
  result.camera = {focal, views.projection(0, 2), views.projection(1, 2), shift.norm()};
  cv::cv2eigen(views.left_rotation, result.rectified_from_left);
  result.left = make_maps(left, views.left_rotation, views.projection);
  result.right = make_maps(right, views.right_rotation, views.projection);
  return result;
}

Rectification make_shift(const StereoCamera& camera, cv::Size size, double right_offset) {
  Rectification result;
  result.size = size;
  result.camera = camera;
  const cv::Matx33d left(camera.focal, 0.0, camera.cx, 0.0, camera.focal, camera.cy, 0.0, 0.0, 1.0);
  cv::Matx33d right = left;
  right(0, 2) += right_offset;
  cv::initUndistortRectifyMap(right, cv::noArray(), cv::noArray(), left, size, CV_16SC2, result.right.places,
                              result.right.fractions);
  return result;
}

}  // namespace brink
