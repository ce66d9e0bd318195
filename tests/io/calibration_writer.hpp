#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "brink/calibration.hpp"
#include "brink/camera.hpp"
#include "io/rectification.hpp"
#include "temporary_folder.hpp"

/// Writes a pair of cameras as every kind of calibration that brink reads.
namespace brink::test {

/// Two cameras with their lenses and how they stand.
struct StereoRig {
  LensCamera left;
  LensCamera right;
  Eigen::Isometry3d right_from_left = Eigen::Isometry3d::Identity();
};

/// A pair that is rectified as it is.
inline StereoRig make_rig(const StereoCamera& camera, cv::Size size) {
  const LensCamera eye{camera.focal, camera.focal, camera.cx, camera.cy, LensModel::radial_tangential, {}, size};
  StereoRig rig{eye, eye};
  rig.right_from_left.translation().x() = -camera.baseline;
  return rig;
}

struct WrittenCalibration {
  std::string kind;  ///< as it must be recognised
  CalibrationFiles files;
};

/// Numbers with commas, each as exact as it is.
inline std::string listed(const std::vector<double>& numbers) { return fmt::format("{}", fmt::join(numbers, ", ")); }

/// A matrix row by row.
inline std::vector<double> rows_of(const Eigen::MatrixXd& matrix) {
  std::vector<double> numbers;
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    for (Eigen::Index column = 0; column < matrix.cols(); ++column) numbers.push_back(matrix(row, column));
  }
  return numbers;
}

inline std::vector<double> matrix_of(const LensCamera& eye) {
  return {eye.focal_x, 0, eye.cx, 0, eye.focal_y, eye.cy, 0, 0, 1};
}

/// A lens by the names of a kind.
inline std::string lens_name(const LensCamera& eye, const char* radial, const char* fisheye) {
  return eye.model == LensModel::fisheye ? fisheye : radial;
}

inline std::string opencv_matrix(const std::string& name, int rows, int columns, const std::vector<double>& data) {
  return fmt::format("{}: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: d\n   data: [ {} ]\n", name, rows, columns,
                     listed(data));
}

inline std::string opencv_text(const StereoRig& rig) {
  std::string text = fmt::format("%YAML:1.0\n---\nimage_width: {}\nimage_height: {}\ndistortion_model: {}\n",
                                 rig.left.size.width, rig.left.size.height, lens_name(rig.left, "plumb_bob", "fisheye"));
  for (const auto& [eye, number] : {std::pair(rig.left, '1'), std::pair(rig.right, '2')}) {
    text += opencv_matrix(std::string("M") + number, 3, 3, matrix_of(eye));
    text += opencv_matrix(std::string("D") + number, 1, static_cast<int>(eye.distortion.size()), eye.distortion);
  }
  return text + opencv_matrix("R", 3, 3, rows_of(rig.right_from_left.linear())) +
         opencv_matrix("T", 3, 1, rows_of(rig.right_from_left.translation()));
}

inline std::string euroc_text(const LensCamera& eye, const Eigen::Isometry3d& body_from_camera) {
  return fmt::format(
      "%YAML:1.0\nsensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [{}]\nresolution: [{}, {}]\ncamera_model: pinhole\n"
      "intrinsics: [{}]\ndistortion_model: {}\ndistortion_coefficients: [{}]\n",
      listed(rows_of(body_from_camera.matrix())), eye.size.width, eye.size.height,
      listed({eye.focal_x, eye.focal_y, eye.cx, eye.cy}), lens_name(eye, "radial-tangential", "equidistant"),
      listed(eye.distortion));
}

inline std::string kalibr_camera(const std::string& name, const LensCamera& eye) {
  const std::string radial = eye.distortion.empty() ? "none" : "radtan";
  return fmt::format(
      "{}:\n  camera_model: pinhole\n  intrinsics: [{}]\n  distortion_model: {}\n  distortion_coeffs: [{}]\n"
      "  resolution: [{}, {}]\n  rostopic: /{}/image_raw\n",
      name, listed({eye.focal_x, eye.focal_y, eye.cx, eye.cy}), lens_name(eye, radial.c_str(), "equidistant"),
      listed(eye.distortion), eye.size.width, eye.size.height, name);
}

inline std::string kalibr_text(const StereoRig& rig) {
  std::string text = kalibr_camera("cam0", rig.left) + kalibr_camera("cam1", rig.right) + "  T_cn_cnm1:\n";
  const Eigen::Matrix4d motion = rig.right_from_left.matrix();
  for (int row = 0; row < 4; ++row) text += fmt::format("  - [{}]\n", listed(rows_of(motion.row(row))));
  return text;
}

/// As camera_calibration writes it. @param projection of the rectified camera: focal length, principal point, and tx.
inline std::string ros_text(const LensCamera& eye, const Eigen::Matrix3d& rectified_from_camera,
                            const std::vector<double>& projection) {
  const auto matrix = [](const char* name, int rows, int columns, const std::vector<double>& data) {
    return fmt::format("{}:\n  rows: {}\n  cols: {}\n  data: [{}]\n", name, rows, columns, listed(data));
  };
  const std::string radial = eye.distortion.size() > 5 ? "rational_polynomial" : "plumb_bob";
  return fmt::format("image_width: {}\nimage_height: {}\ncamera_name: eye\n", eye.size.width, eye.size.height) +
         matrix("camera_matrix", 3, 3, matrix_of(eye)) +
         fmt::format("distortion_model: {}\n", lens_name(eye, radial.c_str(), "equidistant")) +
         matrix("distortion_coefficients", 1, static_cast<int>(eye.distortion.size()), eye.distortion) +
         matrix("rectification_matrix", 3, 3, rows_of(rectified_from_camera)) +
         matrix("projection_matrix", 3, 4,
                {projection[0], 0, projection[1], projection[3], 0, projection[0], projection[2], 0, 0, 0, 1, 0});
}

/// All resolutions as if they had the same lens; only the one of the rig's size is right.
inline std::string zed_text(const StereoRig& rig) {
  std::string text;
  for (const char* resolution : {"2K", "FHD", "HD", "VGA"}) {
    for (const auto& [side, eye] : {std::pair("LEFT", rig.left), std::pair("RIGHT", rig.right)}) {
      std::vector<double> d = eye.distortion;
      d.resize(5, 0.0);
      text += fmt::format("[{}_CAM_{}]\nfx={}\nfy={}\ncx={}\ncy={}\nk1={}\nk2={}\np1={}\np2={}\nk3={}\n", side, resolution,
                          eye.focal_x, eye.focal_y, eye.cx, eye.cy, d[0], d[1], d[2], d[3], d[4]);
    }
  }
  const Eigen::Vector3d shift = -1e3 * rig.right_from_left.translation();
  const Eigen::AngleAxisd turn(rig.right_from_left.linear());
  const Eigen::Vector3d vector = turn.angle() * turn.axis();
  text += fmt::format("[STEREO]\nBaseline={}\nTY={}\nTZ={}\n", shift.x(), shift.y(), shift.z());
  for (const char* resolution : {"2K", "FHD", "HD", "VGA"}) {
    text += fmt::format("CV_{0}={2}\nRX_{0}={1}\nRZ_{0}={3}\n", resolution, vector.x(), vector.y(), vector.z());
  }
  return text + "[MISC]\nSensor_ID=0\n";
}

/// The kinds that describe cameras with lenses. ZED only for radial-tangential ones of one of its sizes.
inline std::vector<WrittenCalibration> write_lens_kinds(const TemporaryFolder& folder, const StereoRig& rig) {
  std::vector<WrittenCalibration> written;
  written.push_back({"OpenCV, M1 and M2", {folder.add("lenses.yaml", opencv_text(rig))}});
  Eigen::Isometry3d body_from_left = Eigen::Isometry3d::Identity();  // of a vehicle: x forward, y left, z up
  body_from_left.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  body_from_left.translation() = Eigen::Vector3d(0.1, 0.05, 0.02);
  (void)folder.add("cam1/sensor.yaml", euroc_text(rig.right, body_from_left * rig.right_from_left.inverse()));
  written.push_back({"EuRoC sensor.yaml pair", {folder.add("cam0/sensor.yaml", euroc_text(rig.left, body_from_left))}});
  written.push_back({"Kalibr, cam0 and cam1", {folder.add("camchain.yaml", kalibr_text(rig))}});
  const bool pinhole = rig.left.is_pinhole() && rig.right.is_pinhole();
  const Eigen::Matrix3d rectified_from_left =
      pinhole ? Eigen::Matrix3d::Identity() : make_rectification(rig.left, rig.right, rig.right_from_left).rectified_from_left;
  const Eigen::Matrix3d rectified_from_right = rectified_from_left * rig.right_from_left.linear().transpose();
  const double tx = -rig.right_from_left.translation().norm() * rig.left.focal_x;
  const std::vector<double> projection{rig.left.focal_x, rig.left.cx, rig.left.cy};
  const auto with_tx = [&](double along) {
    std::vector<double> all = projection;
    all.push_back(along);
    return all;
  };
  (void)folder.add("ros/right.yaml", ros_text(rig.right, rectified_from_right, with_tx(tx)));
  written.push_back({"ROS camera_info, left.yaml and right.yaml",
                     {folder.add("ros/left.yaml", ros_text(rig.left, rectified_from_left, with_tx(0.0))), "",
                      pinhole ? std::nullopt : std::optional(PictureState::raw)}});
  if (rig.left.model == LensModel::fisheye || rig.left.distortion.size() > 5) return written;
  written.push_back({"ZED, VGA", {folder.add("SN123.conf", zed_text(rig))}});
  return written;
}

/// Every kind for cameras that are rectified.
inline std::vector<WrittenCalibration> write_rectified_kinds(const TemporaryFolder& folder, const StereoCamera& camera,
                                                             cv::Size size) {
  const double tx = -camera.focal * camera.baseline;
  const auto projection = [&](double along) {
    return std::vector<double>{camera.focal, 0, camera.cx, along, 0, camera.focal, camera.cy, 0, 0, 0, 1, 0};
  };
  const auto spaced = [](const std::vector<double>& numbers) { return fmt::format("{}", fmt::join(numbers, " ")); };
  std::vector<WrittenCalibration> written = write_lens_kinds(folder, make_rig(camera, size));
  const auto add = [&](const char* kind, const char* name, const std::string& text) {
    written.push_back({kind, {folder.add(name, text)}});
  };
  add("KITTI, P2 and P3", "calib.txt",
      fmt::format("P0: {0}\nP1: {1}\nP2: {0}\nP3: {1}\n", spaced(projection(0.0)), spaced(projection(tx))));
  add("KITTI, P_rect_02 and P_rect_03", "calib_cam_to_cam.txt",
      fmt::format("calib_time: 09-Jan-2012 13:57:47\nS_rect_02: {0} {1}\nP_rect_02: {2}\nS_rect_03: {0} {1}\nP_rect_03: {3}\n",
                  size.width, size.height, spaced(projection(0.0)), spaced(projection(tx))));
  add("OpenCV, P1 and P2", "projections.yaml",
      "%YAML:1.0\n---\n" + opencv_matrix("P1", 3, 4, projection(0.0)) + opencv_matrix("P2", 3, 4, projection(tx)));
  add("OpenCV, Q", "reprojection.yaml",
      "%YAML:1.0\n---\n" +
          opencv_matrix("Q", 4, 4,
                        {1, 0, 0, -camera.cx, 0, 1, 0, -camera.cy, 0, 0, 0, camera.focal, 0, 0, 1.0 / camera.baseline, 0}));
  const std::string k = fmt::format("[{0} 0 {1}; 0 {0} {2}; 0 0 1]", camera.focal, camera.cx, camera.cy);
  add("Middlebury", "middlebury.txt",
      fmt::format("cam0={0}\ncam1={0}\ndoffs=0\nbaseline={1}\nwidth={2}\nheight={3}\nndisp=64\n", k, camera.baseline * 1e3,
                  size.width, size.height));
  return written;
}

}  // namespace brink::test
