#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "brink/files.hpp"
#include "io/calibration/kinds.hpp"
#include "io/yaml_fields.hpp"

namespace brink {
namespace {

/// One camera_info. Matrices are row by row.
struct CameraInfo {
  LensCamera lens;           ///< K, D
  std::vector<double> turn;  ///< R: axes of the camera to those of the rectified one
  std::vector<double> p;     ///< P: 3x4
};

// A field by the names that it has in files of camera_calibration, and in messages of ROS 1 and 2.
YAML::Node find_field(const YAML::Node& root, const char* file, const char* ros1, const char* ros2) {
  for (const char* name : {file, ros1, ros2}) {
    if (root[name]) return root[name];
  }
  return YAML::Node(YAML::NodeType::Undefined);
}

std::vector<double> read_field(const std::string& path, const YAML::Node& root, const char* file, const char* ros1,
                               const char* ros2, std::size_t count) {
  const YAML::Node field = find_field(root, file, ros1, ros2);
  if (!field.IsDefined()) fail_file(path, fmt::format("{} ({}) is missing", file, ros1));
  return read_numbers(path, file, field, count);
}

double read_side(const std::string& path, const YAML::Node& root, const char* file, const char* message) {
  const YAML::Node field = find_field(root, file, message, message);
  if (!field.IsDefined() || !field.IsScalar()) fail_file(path, fmt::format("{} is missing", file));
  return read_number(path, file, 0, field.Scalar());
}

CameraInfo read_camera(const std::string& path, const YAML::Node& root) {
  constexpr std::size_t kProjectionSize = 12;
  CameraInfo info;
  const cv::Size size =
      make_size(path, "image_width, image_height",
                {read_side(path, root, "image_width", "width"), read_side(path, root, "image_height", "height")});
  const std::vector<double> k = read_field(path, root, "camera_matrix", "K", "k", 9);
  const YAML::Node model = root["distortion_model"];
  const YAML::Node coefficients = find_field(root, "distortion_coefficients", "D", "d");
  info.lens = make_lens(
      path, {k[0], k[4], k[2], k[5]}, "distortion_model",
      model && model.IsScalar() && !model.Scalar().empty() ? model.Scalar() : "plumb_bob",
      coefficients.IsDefined() ? read_numbers(path, "distortion_coefficients", coefficients) : std::vector<double>(), size);
  info.turn = read_field(path, root, "rectification_matrix", "R", "r", 9);
  info.p = read_field(path, root, "projection_matrix", "P", "p", kProjectionSize);
  const YAML::Node binning = root["binning_x"];
  if (binning && binning.IsScalar() && read_number(path, "binning_x", 0, binning.Scalar()) > 1) {
    fail_file(path, fmt::format("binning_x = {}, expected pictures of all pixels", binning.Scalar()));
  }
  return info;
}

// Nothing is left to rectify: raw pictures and rectified ones are the same.
bool is_the_same(const CameraInfo& info) {
  const std::vector<double> identity{1, 0, 0, 0, 1, 0, 0, 0, 1};
  const LensCamera& lens = info.lens;
  return lens.is_pinhole() && info.turn == identity && info.p[0] == lens.focal_x && info.p[5] == lens.focal_y &&
         info.p[2] == lens.cx && info.p[6] == lens.cy;
}

// Some tools write a message under its name.
YAML::Node info_of(const std::string& path, const YAML::Node& root) {
  if (!root["camera_info"]) return root;
  if (!root["camera_info"].IsMap()) fail_file(path, "camera_info holds no fields");
  return root["camera_info"];
}

bool are_raw(const CalibrationRequest& request) {
  if (!request.files.pictures) {
    throw std::invalid_argument(
        fmt::format("pictures = not told, must be raw or rectified: {} (ROS camera_info) describes both", request.files.path));
  }
  return *request.files.pictures == PictureState::raw;
}

std::string name_of(const std::string& path) { return path.substr(path.find_last_of('/') + 1); }

// The motion between the cameras that R and P hold: both cameras are turned into the rectified axes, in which the right one is
// at (baseline, 0, 0).
Eigen::Isometry3d right_from_left(const CalibrationRequest& request, const CameraInfo& left, const CameraInfo& right) {
  if (right.p[0] <= 0.0) fail_file(request.files.right_path, fmt::format("projection_matrix focal length = {}", right.p[0]));
  const double baseline = (left.p[3] - right.p[3]) / right.p[0];
  const Eigen::Matrix3d rectified_from_left = make_rotation(request.files.path, "rectification_matrix", left.turn);
  const Eigen::Matrix3d rectified_from_right = make_rotation(request.files.right_path, "rectification_matrix", right.turn);
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.linear() = rectified_from_right.transpose() * rectified_from_left;
  motion.translation() = -rectified_from_right.transpose() * Eigen::Vector3d(baseline, 0.0, 0.0);
  return motion;
}

StereoCalibration read_single(const CalibrationRequest& request, CameraInfo info) {
  const bool raw = !is_the_same(info) && request.single_will_do && are_raw(request);
  if (!raw) info.lens = {info.p[0], info.p[5], info.p[2], info.p[6], LensModel::radial_tangential, {}, info.lens.size};
  return from_single(request, "ROS camera_info", info.lens);
}

}  // namespace

bool looks_like_ros(const YAML::Node& root) {
  const YAML::Node info = root["camera_info"] ? root["camera_info"] : root;
  return info.IsMap() && find_field(info, "camera_matrix", "K", "k").IsDefined() &&
         find_field(info, "projection_matrix", "P", "p").IsDefined();
}

StereoCalibration read_ros(const CalibrationRequest& request, const YAML::Node& root) {
  const auto& [path, right_path, pictures] = request.files;
  const CameraInfo left = read_camera(path, info_of(path, root));
  if (right_path.empty()) return read_single(request, left);
  const CameraInfo right = read_camera(
      right_path, info_of(right_path, parse_opencv_yaml(right_path, read_file(right_path), "those of a ROS camera_info")));
  if (left.lens.size != right.lens.size) {
    fail_file(right_path, fmt::format("is for {}x{} px, expected the size of {}, {}x{}", right.lens.size.width,
                                      right.lens.size.height, path, left.lens.size.width, left.lens.size.height));
  }
  const std::string source = fmt::format("ROS camera_info, {} and {}", name_of(path), name_of(right_path));
  if ((!is_the_same(left) || !is_the_same(right)) && are_raw(request)) {
    return from_lenses(request, source, left.lens, right.lens, right_from_left(request, left, right));
  }
  CalibrationRequest rectified = request;
  rectified.files.pictures = PictureState::rectified;  // if they are the same, the other word is right as well
  return from_projections(rectified, source, {"left P", left.p}, {"right P", right.p}, left.lens.size, true);
}

}  // namespace brink
