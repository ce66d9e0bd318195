#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <boost/property_tree/ini_parser.hpp>
#include <boost/property_tree/ptree.hpp>
#include <fmt/format.h>

#include "io/calibration/kinds.hpp"
#include "io/yaml_fields.hpp"

namespace brink {
namespace {

using Sections = boost::property_tree::ptree;

/// A size of the camera's pictures and what the file calls it.
struct Resolution {
  cv::Size size;
  const char* name;
};
const std::array<Resolution, 7> kResolutions{{{{2208, 1242}, "2K"},
                                              {{1920, 1200}, "FHD1200"},
                                              {{1920, 1080}, "FHD"},
                                              {{1280, 720}, "HD"},
                                              {{960, 600}, "SVGA"},
                                              {{672, 376}, "VGA"},
                                              {{3840, 2160}, "4K"}}};

// Sections and names in capitals, in which files differ; values as they are.
std::string with_capital_names(std::string text) {
  bool name = true;
  for (char& letter : text) {
    if (letter == '=') name = false;
    if (letter == '\n') name = true;
    if (name) letter = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
  }
  return text;
}

Sections read_sections(const std::string& path, const std::string& text) {
  std::istringstream stream(with_capital_names(text));
  Sections sections;
  try {
    boost::property_tree::ini_parser::read_ini(stream, sections);
  } catch (const boost::property_tree::ini_parser_error& error) {
    fail_file(path, fmt::format("is no ZED calibration: line {}: {}", error.line(), error.message()));
  }
  return sections;
}

std::optional<double> find_number(const std::string& path, const Sections& sections, const std::string& section,
                                  const std::string& name) {
  const auto found = sections.find(section);
  if (found == sections.not_found()) return std::nullopt;
  const auto value = found->second.get_optional<std::string>(name);
  if (!value) return std::nullopt;
  return read_number(path, fmt::format("[{}] {}", section, name), 0, *value);
}

double get_number(const std::string& path, const Sections& sections, const std::string& section, const std::string& name) {
  const std::optional<double> number = find_number(path, sections, section, name);
  if (!number) fail_file(path, fmt::format("[{}] {} is missing", section, name));
  return *number;
}

// Rotations and, in old files, shifts are told for each resolution.
double get_stereo(const std::string& path, const Sections& sections, const std::string& name, const std::string& resolution) {
  const std::optional<double> number = find_number(path, sections, "STEREO", name + "_" + resolution);
  return number ? *number : get_number(path, sections, "STEREO", name);
}

// Lenses with more than three radial coefficients are told by the same names.
std::vector<double> get_lens(const std::string& path, const Sections& sections, const std::string& camera) {
  std::vector<double> coefficients;
  for (const char* name : {"K1", "K2", "P1", "P2"}) coefficients.push_back(get_number(path, sections, camera, name));
  for (const char* name : {"K3", "K4", "K5", "K6", "S1", "S2", "S3", "S4"}) {
    coefficients.push_back(find_number(path, sections, camera, name).value_or(0.0));
  }
  constexpr std::array<std::size_t, 2> kShorter{8, 5};  // lengths of OpenCV's lens models below 12
  for (const std::size_t count : kShorter) {
    const bool enough = std::all_of(coefficients.begin() + static_cast<std::ptrdiff_t>(count), coefficients.end(),
                                    [](double coefficient) { return coefficient == 0.0; });
    if (enough) coefficients.resize(count);
  }
  return coefficients;
}

LensCamera read_camera(const std::string& path, const Sections& sections, const std::string& side,
                       const Resolution& resolution) {
  const std::string camera = fmt::format("{}_CAM_{}", side, resolution.name);
  std::vector<double> intrinsics;
  for (const char* name : {"FX", "FY", "CX", "CY"}) intrinsics.push_back(get_number(path, sections, camera, name));
  return make_lens(path, intrinsics, camera, "radial-tangential", get_lens(path, sections, camera), resolution.size);
}

const Resolution& find_resolution(const std::string& path, const Sections& sections, const cv::Size& pictures) {
  std::string known;
  for (const Resolution& resolution : kResolutions) {
    if (sections.find(fmt::format("LEFT_CAM_{}", resolution.name)) == sections.not_found()) continue;
    if (resolution.size == pictures) return resolution;
    known += fmt::format("{}{}x{}", known.empty() ? "" : ", ", resolution.size.width, resolution.size.height);
  }
  if (pictures.empty()) {
    fail_file(path, "ZED: holds several sizes, and no picture that can be read tells which, expected one of " + known);
  }
  fail_file(path, fmt::format("ZED: is for pictures of {} px, these have {}x{}", known, pictures.width, pictures.height));
}

}  // namespace

bool looks_like_zed(const std::string& text) {
  const std::string names = with_capital_names(text);
  return names.find("[LEFT_CAM_") != std::string::npos || names.find("[STEREO]") != std::string::npos;
}

// RX, CV and RZ are a rotation vector. Baseline, TY and TZ are millimetres, with the sign that Stereolabs' own example hands to
// cv::stereoRectify, which turns the cameras the same way for either: a point of the left camera is at R p - (Baseline, TY, TZ)
// in the right one.
StereoCalibration read_zed(const CalibrationRequest& request, const std::string& text) {
  constexpr double kMillimetres = 1e-3;
  const std::string& path = request.files.path;
  const Sections sections = read_sections(path, text);
  const Resolution& resolution = find_resolution(path, sections, request.picture_size);
  const auto stereo = [&](const char* name) { return get_stereo(path, sections, name, resolution.name); };
  const Eigen::Vector3d turn(stereo("RX"), stereo("CV"), stereo("RZ"));
  const Eigen::Vector3d shift(get_number(path, sections, "STEREO", "BASELINE"), stereo("TY"), stereo("TZ"));
  Eigen::Isometry3d right_from_left = Eigen::Isometry3d::Identity();
  if (turn.norm() > 0.0) right_from_left.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  right_from_left.translation() = -kMillimetres * shift;
  const LensCamera left = read_camera(path, sections, "LEFT", resolution);
  const LensCamera right = read_camera(path, sections, "RIGHT", resolution);
  return from_lenses(request, fmt::format("ZED, {}", resolution.name), left, right, right_from_left);
}

}  // namespace brink
