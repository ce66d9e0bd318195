#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "io/calibration/kinds.hpp"
#include "io/calibration/text_fields.hpp"
#include "io/yaml_fields.hpp"

namespace brink {
namespace {

// Of the odometry data set, "P2"; of the raw one, "P_rect_02".
const char* prefix_of(const TextFields& fields) {
  const bool raw =
      std::any_of(fields.begin(), fields.end(), [](const auto& field) { return field.first.starts_with("P_rect_"); });
  return raw ? "P_rect_0" : "P";
}

}  // namespace

bool looks_like_kitti(const std::string& text) {
  if (text.starts_with('%')) return false;  // YAML, which has P1 and P2 too
  const TextFields fields = read_text_fields(text, ':');
  return std::any_of(fields.begin(), fields.end(), [](const auto& field) {
    const auto& [name, words] = field;
    const bool projection = name.starts_with("P_rect_0") || (name.size() == 2 && name[0] == 'P');
    const bool plain = !words.empty() && words[0].find_first_of("[{!") == std::string::npos;  // else YAML without a heading
    return projection && name.back() >= '0' && name.back() <= '3' && plain;
  });
}

StereoCalibration read_kitti(const CalibrationRequest& request, const std::string& text) {
  constexpr std::size_t kProjectionSize = 12;
  const std::string& path = request.files.path;
  const TextFields fields = read_text_fields(text, ':');
  const std::string prefix = prefix_of(fields);
  const auto all_there = [&](const char* left, const char* right) {
    return fields.contains(prefix + left) && fields.contains(prefix + right);
  };
  const bool color = request.pair == CameraPair::color || (request.pair == CameraPair::any && all_there("2", "3"));
  const std::string left = prefix + (color ? "2" : "0");
  const std::string right = prefix + (color ? "3" : "1");
  for (const std::string& name : {left, right}) {
    if (!fields.contains(name)) {
      fail_file(path, fmt::format("{} is missing, expected {} and {} of 12 numbers each", name, left, right));
    }
  }
  const std::string size_name = color ? "S_rect_02" : "S_rect_00";
  const cv::Size size =
      fields.contains(size_name) ? make_size(path, size_name, read_text_field(path, fields, size_name, 2)) : cv::Size();
  return from_projections(request, fmt::format("KITTI, {} and {}", left, right),
                          {left, read_text_field(path, fields, left, kProjectionSize)},
                          {right, read_text_field(path, fields, right, kProjectionSize)}, size, false);
}

}  // namespace brink
