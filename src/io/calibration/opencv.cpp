#include <array>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "brink/files.hpp"
#include "io/calibration/kinds.hpp"
#include "io/text.hpp"
#include "io/yaml_fields.hpp"

namespace brink {
namespace {

constexpr std::size_t kProjectionSize = 12;  // 3x4, row by row
constexpr std::size_t kReprojectionSize = 16;

/// A file, or two that tell what the other one does not.
struct Fields {
  std::string path;
  YAML::Node root;
  std::string other_path;
  std::optional<YAML::Node> other;

  [[nodiscard]] bool has(const std::string& name) const { return root[name] || (other && (*other)[name]); }

  [[nodiscard]] std::vector<double> numbers(const std::string& name) const {
    if (root[name]) return read_numbers(path, name, root[name]);
    if (other && (*other)[name]) return read_numbers(other_path, name, (*other)[name]);
    fail_file(path, name + " is missing");
  }

  [[nodiscard]] std::vector<double> numbers(const std::string& name, std::size_t count) const {
    std::vector<double> all = numbers(name);
    check_count(path, name, all.size(), count);
    return all;
  }

  [[nodiscard]] std::string word(const std::string& name) const {
    const YAML::Node node = root[name] ? root[name] : other ? (*other)[name] : root[name];
    return node && node.IsScalar() ? node.Scalar() : "";
  }
};

/// What the camera matrix and the distortion of a camera are called; `left` and `right` by M1 and M2, or others.
struct LensNames {
  const char* matrix;
  const char* distortion;
};
constexpr std::array<std::array<LensNames, 2>, 4> kLensNames{
    {{{{"M1", "D1"}, {"M2", "D2"}}},
     {{{"K1", "D1"}, {"K2", "D2"}}},
     {{{"cameraMatrix1", "distCoeffs1"}, {"cameraMatrix2", "distCoeffs2"}}},
     {{{"left_camera_matrix", "left_distortion_coefficients"}, {"right_camera_matrix", "right_distortion_coefficients"}}}}};
constexpr LensNames kSingle{"camera_matrix", "distortion_coefficients"};

const std::array<LensNames, 2>* find_lenses(const Fields& fields) {
  for (const auto& names : kLensNames) {
    if (fields.has(names[0].matrix)) return &names;
  }
  return nullptr;
}

cv::Size read_size(const Fields& fields) {
  for (const char* name : {"image_size", "imageSize", "size", "resolution"}) {
    if (fields.has(name)) return make_size(fields.path, name, fields.numbers(name, 2));
  }
  if (!fields.has("image_width") || !fields.has("image_height")) return {};
  std::vector<double> sides;
  for (const char* name : {"image_width", "image_height"}) {
    const std::string text = fields.word(name);
    const std::optional<int> number = parse_number<int>(text);
    if (!number || *number < 1) {
      fail_file(fields.path, fmt::format("{} = {}, expected a whole number of pixels", name, text.empty() ? "a list" : text));
    }
    sides.push_back(*number);
  }
  return make_size(fields.path, "image_width, image_height", sides);
}

LensCamera read_lens(const Fields& fields, const LensNames& names, cv::Size size) {
  const std::vector<double> k = fields.numbers(names.matrix, 9);
  if (k[1] != 0.0 || k[3] != 0.0 || k[6] != 0.0 || k[7] != 0.0 || k[8] != 1.0) {
    fail_file(fields.path, fmt::format("{} is no camera matrix, expected f 0 cx, 0 f cy, 0 0 1", names.matrix));
  }
  const std::string model = fields.word("distortion_model");
  return make_lens(fields.path, {k[0], k[4], k[2], k[5]}, names.distortion, model.empty() ? "radial-tangential" : model,
                   fields.numbers(names.distortion), size);
}

// R and T of cv::stereoCalibrate: a point of the left camera is at R p + T in the right one.
StereoCalibration read_lenses(const CalibrationRequest& request, const Fields& fields, const std::array<LensNames, 2>& names,
                              cv::Size size) {
  if (size.empty()) size = request.picture_size;
  const LensCamera left = read_lens(fields, names[0], size);
  const LensCamera right = read_lens(fields, names[1], size);
  Eigen::Isometry3d right_from_left = Eigen::Isometry3d::Identity();
  right_from_left.linear() = make_rotation(fields.path, "R", fields.numbers("R", 9));
  const std::vector<double> shift = fields.numbers("T", 3);
  right_from_left.translation() = Eigen::Vector3d(shift[0], shift[1], shift[2]);
  return from_lenses(request, fmt::format("OpenCV, {} and {}", names[0].matrix, names[1].matrix), left, right, right_from_left);
}

// Q: 1 0 0 -cx, 0 1 0 -cy, 0 0 0 f, 0 0 1/baseline (cx_right - cx)/baseline; OpenCV writes both with Tx = -baseline.
StereoCalibration read_reprojection(const CalibrationRequest& request, const Fields& fields, cv::Size size) {
  const std::vector<double> q = fields.numbers("Q", kReprojectionSize);
  const double focal = q[11];
  if (focal <= 0.0) fail_file(fields.path, fmt::format("Q focal length = {}, expected more than 0 px", focal));
  if (q[14] == 0.0) fail_file(fields.path, "Q row 4, column 3 = 0, expected 1 / baseline");
  const double baseline = 1.0 / q[14];
  return from_rectified(request, "OpenCV, Q", {focal, -q[3], -q[7], baseline}, size, q[15] * baseline);
}

StereoCalibration read_rectified(const CalibrationRequest& request, const Fields& fields, cv::Size size) {
  if (fields.has("P1") && fields.has("P2")) {
    return from_projections(request, "OpenCV, P1 and P2", {"P1", fields.numbers("P1", kProjectionSize)},
                            {"P2", fields.numbers("P2", kProjectionSize)}, size, true);
  }
  if (fields.has("Q")) return read_reprojection(request, fields, size);
  fail_file(fields.path,
            fmt::format("{} is missing, expected P1 and P2, or Q, or M1, D1, M2, D2, R and T", fields.has("P1") ? "P2" : "P1"));
}

}  // namespace

bool looks_like_opencv(const YAML::Node& root) {
  const Fields fields{"", root, "", std::nullopt};
  return find_lenses(fields) != nullptr || fields.has("P1") || fields.has("Q") || fields.has(kSingle.matrix) ||
         is_whole_opencv(root);
}

bool is_whole_opencv(const YAML::Node& root) { return (root["R"] && root["T"]) || (root["P1"] && root["P2"]) || root["Q"]; }

StereoCalibration read_opencv(const CalibrationRequest& request, const YAML::Node& root) {
  const auto& [path, other_path, pictures] = request.files;
  Fields fields{path, root, other_path, std::nullopt};
  if (!other_path.empty()) fields.other = parse_opencv_yaml(other_path, read_file(other_path), "R and T, or P1 and P2");
  const cv::Size size = read_size(fields);
  const std::array<LensNames, 2>* lenses = find_lenses(fields);
  const bool rectified = (fields.has("P1") && fields.has("P2")) || fields.has("Q");
  if (lenses == nullptr && !rectified && fields.has(kSingle.matrix)) {
    return from_single(request, "OpenCV, camera_matrix", read_lens(fields, kSingle, size));
  }
  if (lenses != nullptr && rectified && !pictures) {
    throw std::invalid_argument(fmt::format("pictures = not told, must be raw or rectified: {} (OpenCV) describes both", path));
  }
  const bool raw = lenses != nullptr && (!rectified || *pictures == PictureState::raw);
  return raw ? read_lenses(request, fields, *lenses, size) : read_rectified(request, fields, size);
}

}  // namespace brink
