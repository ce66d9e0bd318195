#include "brink/calibration.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "brink/files.hpp"
#include "io/text.hpp"
#include "io/yaml_fields.hpp"

namespace brink {
namespace {

constexpr std::size_t kProjectionSize = 12;  // 3x4, row by row
constexpr std::size_t kReprojectionSize = 16;
using Numbers = std::vector<double>;

void check_same(const std::string& path, const std::string& what, double first, double second, double tolerance) {
  if (std::abs(first - second) > tolerance) {
    fail_file(path,
              fmt::format("{} = {} and {}, expected equal values: rectified cameras with square pixels", what, first, second));
  }
}

// The last word on every calibration: turns the checks of StereoCamera into a fault of the file.
StereoCalibration checked(const std::string& path, const StereoCamera& camera, const std::string& source) {
  if (camera.baseline <= 0.0) {
    fail_file(path,
              fmt::format("{}: baseline = {} m, expected more than 0: are left and right swapped?", source, camera.baseline));
  }
  try {
    camera.validate();
  } catch (const std::invalid_argument& error) {
    const char* hint = camera.baseline > 10.0 ? " (is it in millimetres?)" : "";
    fail_file(path, fmt::format("{}: {}{}", source, error.what(), hint));
  }
  return {camera, source, {}};
}

// Projection matrices: f 0 cx tx, 0 f cy ty, 0 0 1 tz, row by row.
StereoCalibration from_projections(const std::string& path, const std::string& left_name, const Numbers& left,
                                   const std::string& right_name, const Numbers& right, const std::string& source) {
  for (const auto& [name, p] : {std::pair(left_name, left), std::pair(right_name, right)}) {
    if (p[0] <= 0.0) fail_file(path, fmt::format("{} focal length = {}, expected more than 0 px", name, p[0]));
    if (p[1] != 0.0 || p[4] != 0.0 || p[8] != 0.0 || p[9] != 0.0 || p[10] != 1.0) {
      fail_file(path, name + " is not the projection of a rectified camera, expected f 0 cx tx, 0 f cy ty, 0 0 1 tz");
    }
    check_same(path, name + " focal lengths along x and y", p[0], p[5], 1e-3 * p[0]);
  }
  const double focal = right[0];
  const std::string both = left_name + " and " + right_name + " ";
  check_same(path, both + "focal lengths", left[0], focal, 1e-3 * focal);
  constexpr double kPixelTolerance = 0.01;
  check_same(path, both + "principal columns", left[2], right[2], kPixelTolerance);
  check_same(path, both + "principal rows", left[6], right[6], kPixelTolerance);
  const double baseline = (left[3] - right[3]) / focal;
  const double vertical = (left[7] - right[7]) / focal;
  if (std::abs(vertical) > 0.1 * std::abs(baseline)) {
    fail_file(path, fmt::format("{}are {} m apart vertically, expected cameras side by side", both, vertical));
  }
  return checked(path, {left[0], left[2], left[6], baseline}, source);
}

// "name: value value ..." on each line.
std::map<std::string, std::vector<std::string>> read_kitti_lines(const std::string& text) {
  std::map<std::string, std::vector<std::string>> fields;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos) continue;
    std::istringstream words(line.substr(colon + 1));
    std::vector<std::string> values;
    for (std::string word; words >> word;) values.push_back(word);
    fields[std::string(trimmed(std::string_view(line).substr(0, colon)))] = std::move(values);
  }
  return fields;
}

StereoCalibration read_kitti(const std::string& path, const std::string& text, CameraPair pair) {
  const auto fields = read_kitti_lines(text);
  const bool color = pair == CameraPair::color || (pair == CameraPair::any && fields.contains("P2") && fields.contains("P3"));
  const std::array<std::string, 2> names =
      color ? std::array<std::string, 2>{"P2", "P3"} : std::array<std::string, 2>{"P0", "P1"};
  std::array<Numbers, 2> projections;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto field = fields.find(names[i]);
    if (field == fields.end()) {
      fail_file(path, fmt::format("{} is missing, expected {} and {} of 12 numbers each", names[i], names[0], names[1]));
    }
    check_count(path, names[i], field->second.size(), kProjectionSize);
    for (std::size_t n = 0; n < kProjectionSize; ++n) {
      projections[i].push_back(read_number(path, names[i], n, field->second[n]));
    }
  }
  return from_projections(path, names[0], projections[0], names[1], projections[1],
                          fmt::format("KITTI, {} and {}", names[0], names[1]));
}

// Q: 1 0 0 -cx, 0 1 0 -cy, 0 0 0 f, 0 0 1/baseline (cx - cx_right)/baseline.
StereoCalibration from_reprojection(const std::string& path, const Numbers& q) {
  const double focal = q[11];
  if (focal <= 0.0) fail_file(path, fmt::format("Q focal length = {}, expected more than 0 px", focal));
  if (q[14] == 0.0) fail_file(path, "Q row 4, column 3 = 0, expected 1 / baseline");
  const double baseline = 1.0 / q[14];
  check_same(path, "Q principal columns", -q[3], -q[3] - q[15] * baseline, 0.01);
  return checked(path, {focal, -q[3], -q[7], baseline}, "OpenCV, Q");
}

cv::Size read_size(const std::string& path, const YAML::Node& root) {
  if (!root["image_width"] || !root["image_height"]) return {};
  cv::Size size;
  for (const auto& [field, side] : {std::pair("image_width", &size.width), std::pair("image_height", &size.height)}) {
    const std::string text = root[field].IsScalar() ? root[field].Scalar() : "a list";
    const std::optional<int> number = parse_number<int>(text);
    if (!number || *number < 1) fail_file(path, fmt::format("{} = {}, expected a whole number of pixels", field, text));
    *side = *number;
  }
  return size;
}

StereoCalibration read_rectified_opencv(const std::string& path, const YAML::Node& root) {
  if (root["P1"] && root["P2"]) {
    return from_projections(path, "P1", read_numbers(path, "P1", root["P1"], kProjectionSize), "P2",
                            read_numbers(path, "P2", root["P2"], kProjectionSize), "OpenCV, P1 and P2");
  }
  if (root["Q"]) return from_reprojection(path, read_numbers(path, "Q", root["Q"], kReprojectionSize));
  if (root["M1"] || root["D1"]) {
    fail_file(
        path,
        "holds M1, D1, ... of pictures that are not rectified, expected P1 and P2, or Q: rectify the pictures first, this "
        "version "
        "does not");
  }
  fail_file(path, fmt::format("{} is missing, expected P1 and P2, or Q", root["P1"] ? "P2" : "P1"));
}

StereoCalibration read_opencv(const std::string& path, const std::string& text) {
  const YAML::Node root = parse_opencv_yaml(path, text, "P1 and P2, or Q");
  StereoCalibration calibration = read_rectified_opencv(path, root);
  calibration.size = read_size(path, root);
  return calibration;
}

bool looks_like_kitti(const std::string& text) {
  const auto fields = read_kitti_lines(text);
  return std::any_of(fields.begin(), fields.end(), [](const auto& field) {
    return field.first.size() == 2 && field.first[0] == 'P' && field.first[1] >= '0' && field.first[1] <= '3';
  });
}

StereoCalibration read_text(const std::string& path, const std::string& text, CameraPair pair) {
  if (text.starts_with("%YAML") || text.find("opencv-matrix") != std::string::npos) return read_opencv(path, text);
  if (looks_like_kitti(text)) return read_kitti(path, text, pair);
  fail_file(path,
            "is not a calibration that this version knows, expected KITTI calib.txt (P0: ... P3: ...) or OpenCV stereo YAML");
}

}  // namespace

StereoCalibration read_calibration(const CalibrationFiles& files, cv::Size picture_size, CameraPair pair) {
  const std::string& path = files.path;
  const std::string text = read_file(path);
  StereoCalibration calibration = read_text(path, text, pair);
  if (calibration.size.empty()) calibration.size = picture_size;
  return calibration;
}

StereoCalibration read_depth_calibration(const CalibrationFiles& files, cv::Size picture_size, CameraPair pair) {
  return read_calibration(files, picture_size, pair);
}

std::string describe(const StereoCalibration& calibration) {
  const auto angle = [&](int side) { return 2.0 * std::atan(side / (2.0 * calibration.camera.focal)) * 180.0 / CV_PI; };
  const cv::Size& size = calibration.size;
  std::string text = calibration.source;
  if (!size.empty()) text += fmt::format(", {}x{} px", size.width, size.height);
  text += fmt::format(", focal length {:.2f} px, baseline {:.4f} m", calibration.camera.focal, calibration.camera.baseline);
  if (calibration.single) text += " (nominal: the file is about one camera)";
  if (!size.empty()) text += fmt::format(", field of view {:.0f} x {:.0f} degrees", angle(size.width), angle(size.height));
  return text + (calibration.rectification ? ", rectified on the fly" : ", rectified already");
}

}  // namespace brink
