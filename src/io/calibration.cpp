#include "brink/calibration.hpp"

#include <array>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "brink/files.hpp"
#include "io/calibration/kinds.hpp"
#include "io/yaml_fields.hpp"

namespace brink {
namespace {

constexpr const char* kUnknown =
    "is not a calibration that this version knows, expected one of KITTI, OpenCV, EuRoC, Kalibr, Middlebury, ROS or ZED";

/// How the files of the two cameras of a pair are told apart by name.
constexpr std::array<std::pair<std::string_view, std::string_view>, 5> kPartners{
    {{"left", "right"}, {"Left", "Right"}, {"LEFT", "RIGHT"}, {"cam0", "cam1"}, {"intrinsics", "extrinsics"}}};

// The right camera's file: the name of the left one with the last word that tells the side turned into the other.
std::string find_partner(const std::string& path) {
  for (const auto& [left, right] : kPartners) {
    const std::size_t at = path.rfind(left);
    if (at == std::string::npos) continue;
    std::string partner = path;
    partner.replace(at, left.size(), right);
    std::error_code ignored;
    if (std::filesystem::is_regular_file(partner, ignored)) return partner;
  }
  return "";
}

void refuse_right_file(const CalibrationFiles& files) {
  if (files.right_path.empty()) return;
  throw std::invalid_argument(
      fmt::format("calib-right = {}, must not be given: {} is about both cameras", files.right_path, files.path));
}

bool may_be_yaml(const std::string& text) {
  const bool fields = text.find(": ") != std::string::npos || text.find(":\n") != std::string::npos;
  return text.find('\0') == std::string::npos && (fields || text.starts_with('%'));
}

StereoCalibration read_yaml(CalibrationRequest request, const std::string& text) {
  const std::string& path = request.files.path;
  const YAML::Node root = parse_opencv_yaml(path, text, "those of a calibration");
  const bool ros = looks_like_ros(root);
  const bool euroc = looks_like_euroc(root);
  if (!ros && !euroc && (looks_like_kalibr(root) || is_whole_opencv(root))) {
    refuse_right_file(request.files);
  } else if (request.files.right_path.empty()) {
    request.files.right_path = find_partner(path);
  }
  if (looks_like_kalibr(root)) return read_kalibr(request, root);
  if (ros) return read_ros(request, root);
  if (euroc) return read_euroc(request, root);
  if (looks_like_opencv(root)) return read_opencv(request, root);
  fail_file(path, kUnknown);
}

StereoCalibration read(const CalibrationRequest& request) {
  const CalibrationFiles& files = request.files;
  const std::string text = read_file(files.path);
  const auto plain = {std::pair(&looks_like_zed, &read_zed), std::pair(&looks_like_middlebury, &read_middlebury),
                      std::pair(&looks_like_kitti, &read_kitti)};
  for (const auto& [looks_like_it, read_it] : plain) {
    if (!looks_like_it(text)) continue;
    refuse_right_file(files);
    return read_it(request, text);
  }
  if (may_be_yaml(text)) return read_yaml(request, text);
  fail_file(files.path, kUnknown);
}

}  // namespace

StereoCalibration read_calibration(const CalibrationFiles& files, cv::Size picture_size, CameraPair pair) {
  return read({files, picture_size, pair, false});
}

StereoCalibration read_depth_calibration(const CalibrationFiles& files, cv::Size picture_size, CameraPair pair) {
  return read({files, picture_size, pair, true});
}

std::string describe(const StereoCalibration& calibration) {
  const StereoCamera& camera = calibration.camera;
  const cv::Size& size = calibration.size;
  std::string text = calibration.source;
  if (!size.empty()) text += fmt::format(", {}x{} px", size.width, size.height);
  text += fmt::format(", focal length {:.2f} px, baseline {:.4f} m", camera.focal, camera.baseline);
  if (calibration.single) text += " (in name only: one camera)";
  if (!size.empty()) {
    const auto degrees = [&](int side) { return 2.0 * std::atan(side / (2.0 * camera.focal)) * 180.0 / CV_PI; };
    text += fmt::format(", field of view {:.0f} x {:.0f} degrees", degrees(size.width), degrees(size.height));
  }
  text += calibration.rectification ? ", rectified on the fly" : ", rectified already";
  const bool inside = camera.cx >= 0.0 && camera.cy >= 0.0 && camera.cx < size.width && camera.cy < size.height;
  if (size.empty() || inside) return text;
  return text + fmt::format("; its principal point ({:.0f}, {:.0f}) is outside the pictures: is it of another size?", camera.cx,
                            camera.cy);
}

}  // namespace brink
