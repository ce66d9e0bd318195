#include <string>
#include <vector>

#include <fmt/format.h>

#include "io/calibration/kinds.hpp"
#include "io/yaml_fields.hpp"

namespace brink {
namespace {

std::string word_of(const std::string& path, const std::string& field, const YAML::Node& node) {
  if (!node || !node.IsScalar()) fail_file(path, field + " is missing");
  return node.Scalar();
}

std::vector<double> numbers_of(const std::string& path, const std::string& field, const YAML::Node& node, std::size_t count) {
  if (!node) fail_file(path, field + " is missing");
  return read_numbers(path, field, node, count);
}

LensCamera read_camera(const std::string& path, const std::string& name, const YAML::Node& camera) {
  if (!camera.IsMap()) fail_file(path, name + " holds no fields");
  const std::string model = word_of(path, name + " camera_model", camera["camera_model"]);
  if (model != "pinhole") fail_file(path, fmt::format("{} camera_model = {}, expected pinhole", name, model));
  const std::string lens = word_of(path, name + " distortion_model", camera["distortion_model"]);
  const YAML::Node coefficients = camera["distortion_coeffs"];
  const std::vector<double> intrinsics = numbers_of(path, name + " intrinsics", camera["intrinsics"], 4);
  const std::vector<double> resolution = numbers_of(path, name + " resolution", camera["resolution"], 2);
  const std::vector<double> distortion =
      coefficients ? read_numbers(path, name + " distortion_coeffs", coefficients) : std::vector<double>();
  return make_lens(path, intrinsics, name + " distortion_model", lens, distortion,
                   make_size(path, name + " resolution", resolution));
}

}  // namespace

bool looks_like_kalibr(const YAML::Node& root) {
  const YAML::Node first = root["cam0"];
  return first && first.IsMap() && first["camera_model"];
}

StereoCalibration read_kalibr(const CalibrationRequest& request, const YAML::Node& root) {
  const std::string& path = request.files.path;
  const LensCamera left = read_camera(path, "cam0", root["cam0"]);
  if (!root["cam1"]) return from_single(request, "Kalibr, cam0", left);
  const LensCamera right = read_camera(path, "cam1", root["cam1"]);
  constexpr std::size_t kMotionSize = 16;
  const std::string field = "cam1 T_cn_cnm1";  // position of points in cam1 from that in cam0
  const std::vector<double> motion = numbers_of(path, field, root["cam1"]["T_cn_cnm1"], kMotionSize);
  return from_lenses(request, "Kalibr, cam0 and cam1", left, right, make_isometry(path, field, motion));
}

}  // namespace brink
