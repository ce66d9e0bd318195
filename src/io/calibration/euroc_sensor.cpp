#include <string>
#include <vector>

#include <fmt/format.h>

#include "brink/files.hpp"
#include "io/calibration/kinds.hpp"
#include "io/yaml_fields.hpp"

namespace brink {
namespace {

YAML::Node required(const std::string& path, const YAML::Node& root, const std::string& field) {
  if (!root[field]) fail_file(path, field + " is missing");
  return root[field];
}

std::string read_word(const YAML::Node& root, const std::string& field) {
  const YAML::Node node = root[field];
  return node && node.IsScalar() ? node.Scalar() : "nothing";
}

LensCamera read_camera(const std::string& path, const YAML::Node& root) {
  const std::string model = read_word(root, "camera_model");
  if (model != "pinhole") fail_file(path, fmt::format("camera_model = {}, expected pinhole", model));
  const std::string coefficients = "distortion_coefficients";
  const std::string lens = read_word(root, "distortion_model");
  const std::vector<double> intrinsics = read_numbers(path, "intrinsics", required(path, root, "intrinsics"), 4);
  const std::vector<double> resolution = read_numbers(path, "resolution", required(path, root, "resolution"), 2);
  const std::vector<double> distortion = read_numbers(path, coefficients, required(path, root, coefficients));
  return make_lens(path, intrinsics, "distortion_model", lens, distortion, make_size(path, "resolution", resolution));
}

}  // namespace

bool looks_like_euroc(const YAML::Node& root) { return root["T_BS"] || root["camera_model"]; }

Eigen::Isometry3d read_body_from_sensor(const std::string& path, const YAML::Node& root) {
  constexpr std::size_t kSize = 16;
  return make_isometry(path, "T_BS", read_numbers(path, "T_BS", required(path, root, "T_BS"), kSize));
}

StereoCalibration read_euroc(const CalibrationRequest& request, const YAML::Node& root) {
  const std::string& right_path = request.files.right_path;
  const LensCamera left = read_camera(request.files.path, root);
  if (right_path.empty()) return from_single(request, "EuRoC sensor.yaml", left);
  const YAML::Node right_root = parse_opencv_yaml(right_path, read_file(right_path), "those of an ASL camera: T_BS, ...");
  const LensCamera right = read_camera(right_path, right_root);
  const Eigen::Isometry3d body_from_left = read_body_from_sensor(request.files.path, root);
  return from_lenses(request, "EuRoC sensor.yaml pair", left, right,
                     read_body_from_sensor(right_path, right_root).inverse() * body_from_left);
}

}  // namespace brink
