#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "brink/detections.hpp"
#include "io/measure_fields.hpp"
#include "io/text.hpp"

namespace brink {
namespace {

using Json = nlohmann::json;

constexpr int kLargestCoordinate = 1000000;  // px: no picture is as large

/// A JSON object with the way to it, "" or "obstacles[0].", so that a fault can be named.
struct Node {
  const Json& object;
  std::string way;
};

[[noreturn]] void fail(const std::string& name, const Json& value, const std::string& expected) {
  constexpr std::size_t kLongest = 40;
  std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
  if (text.size() > kLongest) text = text.substr(0, kLongest) + "...";
  throw std::runtime_error(fmt::format("{} = {}, expected {}", name, text, expected));
}

const Json& member(const Node& node, const char* name, const std::string& expected) {
  const auto found = node.object.find(name);
  if (found == node.object.end())
    throw std::runtime_error(fmt::format("{}{} is missing, expected {}", node.way, name, expected));
  return *found;
}

Node child(const Node& node, const char* name) {
  const Json& value = member(node, name, "an object");
  if (!value.is_object()) fail(node.way + name, value, "an object");
  return {value, node.way + name + "."};
}

double read_number(const Node& node, const char* name) {
  const Json& value = member(node, name, "a number");
  if (!value.is_number()) fail(node.way + name, value, "a number");
  return value.get<double>();
}

std::optional<double> read_number_or_null(const Node& node, const char* name) {
  const Json& value = member(node, name, "a number or null");
  if (value.is_null()) return std::nullopt;
  if (!value.is_number()) fail(node.way + name, value, "a number or null");
  return value.get<double>();
}

bool is_integer(const Json& value, int least, int greatest) {
  if (value.is_number_unsigned()) return value.get<std::uint64_t>() <= static_cast<std::uint64_t>(greatest);
  return value.is_number_integer() && value.get<std::int64_t>() >= least && value.get<std::int64_t>() <= greatest;
}

int read_count(const Node& node, const char* name) {
  constexpr const char* kExpected = "an integer from 0 to 2147483647";
  const Json& value = member(node, name, kExpected);
  if (!is_integer(value, 0, std::numeric_limits<int>::max())) fail(node.way + name, value, kExpected);
  return value.get<int>();
}

std::string read_text(const Node& node, const char* name) {
  const Json& value = member(node, name, "text");
  if (!value.is_string()) fail(node.way + name, value, "text");
  return value.get<std::string>();
}

/// The one of `choices` that the text names.
template <typename Choice, std::size_t Count>
Choice read_choice(const Node& node, const char* name, const std::array<Choice, Count>& choices) {
  std::string expected;
  for (const Choice choice : choices) expected += (expected.empty() ? "" : " or ") + to_string(choice);
  const Json& value = member(node, name, expected);
  for (const Choice choice : choices) {
    if (value == to_string(choice)) return choice;
  }
  fail(node.way + name, value, expected);
}

Eigen::Vector3d to_point(const Json& value, const std::string& name) {
  constexpr const char* kExpected = "three numbers";
  if (!value.is_array() || value.size() != 3) fail(name, value, kExpected);
  Eigen::Vector3d point;
  for (int i = 0; i < 3; ++i) {
    const Json& coordinate = value[static_cast<std::size_t>(i)];
    if (!coordinate.is_number()) fail(name, value, kExpected);
    point[i] = coordinate.get<double>();
  }
  return point;
}

Eigen::Vector3d read_point(const Node& node, const char* name) {
  return to_point(member(node, name, "three numbers"), node.way + name);
}

std::vector<cv::Point> read_contour(const Node& node) {
  constexpr const char* kName = "contour";
  const Json& list = member(node, kName, "a list of points");
  if (!list.is_array()) fail(node.way + kName, list, "a list of points");
  const auto is_coordinate = [](const Json& value) { return is_integer(value, -kLargestCoordinate, kLargestCoordinate); };
  std::vector<cv::Point> contour;
  contour.reserve(list.size());
  for (const Json& point : list) {
    if (!point.is_array() || point.size() != 2 || !is_coordinate(point[0]) || !is_coordinate(point[1])) {
      fail(fmt::format("{}{}[{}]", node.way, kName, contour.size()), point,
           fmt::format("two integers from -{0} to {0}", kLargestCoordinate));
    }
    contour.emplace_back(point[0].get<int>(), point[1].get<int>());
  }
  return contour;
}

constexpr std::array kTypes{CandidateType::below_ground, CandidateType::no_disparity};

/// Of a merged obstacle; empty where none are told.
std::vector<CandidateType> read_types(const Node& node) {
  constexpr const char* kName = "types";
  std::vector<CandidateType> types;
  if (!node.object.contains(kName)) return types;
  const Json& list = node.object.at(kName);
  if (!list.is_array()) fail(node.way + kName, list, "a list of types");
  for (const Json& value : list) {
    const auto type = std::ranges::find_if(kTypes, [&value](CandidateType one) { return value == to_string(one); });
    if (type == kTypes.end())
      fail(fmt::format("{}{}[{}]", node.way, kName, types.size()), value, "below_ground or no_disparity");
    types.push_back(*type);
  }
  return types;
}

/// What older versions wrote has the kind, too: always "unknown".
ObstacleKind read_kind(const Node& node) {
  return read_choice(node, "kind",
                     std::array{ObstacleKind::unknown, ObstacleKind::stairs_down, ObstacleKind::edge, ObstacleKind::hole});
}

/// Files of older versions have none.
Measures read_measures(const Node& node) {
  Measures measures;
  if (!node.object.contains("measures")) return measures;
  const Node object = child(node, "measures");
  for (const MeasureField& field : kMeasureFields) measures.*field.value = read_number(object, field.name);
  return measures;
}

std::optional<double> read_probability(const Node& node) {
  constexpr const char* kName = "probability";
  if (!node.object.contains(kName)) return std::nullopt;
  const std::optional<double> probability = read_number_or_null(node, kName);
  if (probability && !(*probability >= 0.0 && *probability <= 1.0))
    fail(node.way + kName, *probability, "a number from 0 to 1");
  return probability;
}

NegativeObstacle read_obstacle(const Node& node) {
  NegativeObstacle obstacle;
  obstacle.id = read_count(node, "id");
  obstacle.track_length = read_count(node, "track_length");
  if (node.object.contains("unseen_s")) obstacle.unseen_s = read_number(node, "unseen_s");
  if (node.object.contains("time_to_edge_s")) obstacle.time_to_edge_s = read_number(node, "time_to_edge_s");
  obstacle.probability = read_probability(node);
  Candidate& candidate = obstacle.candidate;
  candidate.type = read_choice(node, "type", kTypes);
  candidate.types = read_types(node);
  candidate.kind = read_kind(node);
  candidate.area_px = read_count(node, "area_px");
  candidate.measures = read_measures(node);
  candidate.contour = read_contour(node);
  candidate.centroid = read_point(node, "centroid");
  candidate.nearest = read_point(node, "nearest");
  candidate.rim_nearest = read_point(node, "rim_nearest");
  candidate.distance_m = read_number(node, "distance_m");
  candidate.bearing_deg = read_number(node, "bearing_deg");
  candidate.depth_m = read_number_or_null(node, "depth_m");
  candidate.width_m = read_number(node, "width_m");
  return obstacle;
}

Candidate read_rejected(const Node& node) {
  Candidate candidate;
  candidate.type = read_choice(node, "type", kTypes);
  candidate.area_px = read_count(node, "area_px");
  candidate.rejection = Rejection{read_text(node, "rule"), read_number(node, "value"), read_number(node, "limit")};
  // A centroid is the mean of the contour's points: where there is one there were such points.
  const Json& centroid = member(node, "centroid", "three numbers or null");
  if (!centroid.is_null()) {
    candidate.centroid = to_point(centroid, node.way + "centroid");
    candidate.contour_3d = {candidate.centroid};
  }
  return candidate;
}

/// Reads every object of a list.
template <typename Read>
auto read_list(const Node& node, const char* name, Read read) {
  const Json& list = member(node, name, "a list");
  if (!list.is_array()) fail(node.way + name, list, "a list");
  std::vector<decltype(read(node))> items;
  for (const Json& value : list) {
    const std::string way = fmt::format("{}{}[{}]", node.way, name, items.size());
    if (!value.is_object()) fail(way, value, "an object");
    items.push_back(read(Node{value, way + "."}));
  }
  return items;
}

GroundEstimate read_ground(const Node& node) {
  GroundEstimate ground;
  ground.state = read_choice(node, "state", std::array{GroundState::seen, GroundState::uncertain, GroundState::not_visible});
  if (node.object.contains("reason")) ground.reason = read_text(node, "reason");
  ground.confidence = read_number(node, "confidence");
  if (ground.state == GroundState::not_visible) return ground;
  ground.plane = GroundPlane{};
  ground.pose.height_m = read_number(node, "height_m");
  ground.pose.pitch_deg = read_number(node, "pitch_deg");
  ground.pose.roll_deg = read_number(node, "roll_deg");
  return ground;
}

StageTimes read_times(const Node& node) {
  StageTimes times;
  times.disparity = read_number(node, "disparity");
  times.ground = read_number(node, "ground");
  times.below_ground = read_number(node, "below_ground");
  times.no_disparity = read_number(node, "no_disparity");
  times.ego_motion = read_number(node, "ego_motion");
  times.tracking = read_number(node, "tracking");
  times.total = read_number(node, "total");
  return times;
}

Eigen::Isometry3d read_motion(const Node& node) {
  const Json& rows = node.object.at("current_from_previous");
  const std::string name = node.way + "current_from_previous";
  Eigen::Matrix4d matrix;
  if (!rows.is_array() || rows.size() != 4) fail(name, rows, "4 rows of 4 numbers");
  for (Eigen::Index row = 0; row < 4; ++row) {
    const Json& numbers = rows[static_cast<std::size_t>(row)];
    if (!numbers.is_array() || numbers.size() != 4) fail(name, rows, "4 rows of 4 numbers");
    for (Eigen::Index column = 0; column < 4; ++column) {
      const Json& number = numbers[static_cast<std::size_t>(column)];
      if (!number.is_number()) fail(name, number, "a number");
      matrix(row, column) = number.get<double>();
    }
  }
  return Eigen::Isometry3d(matrix);
}

void read_ego_motion(const Node& node, Detection& detection) {
  detection.ego_motion_state = read_choice(node, "state",
                                           std::array{EgoMotionState::none, EgoMotionState::ok, EgoMotionState::failed,
                                                      EgoMotionState::given, EgoMotionState::ground});
  if (node.object.contains("reason")) detection.ego_motion.reason = read_text(node, "reason");
  if (detection.ego_motion_state == EgoMotionState::none) return;
  detection.ego_motion.matches = read_count(node, "matches");
  detection.ego_motion.inliers = read_count(node, "inliers");
  if (!node.object.contains("current_from_previous")) return;
  detection.ego_motion.motion = EgoMotion{.current_from_previous = read_motion(node)};
}

Json parse_object(const std::string& line) {
  Json json;
  try {
    json = Json::parse(line);
  } catch (const Json::parse_error& error) {
    // The parser stops one past the end when something is missing there.
    if (error.byte > line.size()) throw std::runtime_error("is cut off");
    throw std::runtime_error(fmt::format("is no JSON at column {}", error.byte));
  } catch (const Json::out_of_range&) {
    throw std::runtime_error("holds a number that is too large");
  }
  if (!json.is_object()) fail("the line", json, "an object");
  return json;
}

Detection parse_detection(const std::string& line) {
  const Json json = parse_object(line);
  const Node node{json, ""};
  Detection detection;
  detection.frame = read_count(node, "frame");
  detection.time = read_number(node, "time");
  detection.status = read_choice(node, "status", std::array{FrameStatus::ok, FrameStatus::no_picture, FrameStatus::bad_frame});
  if (json.contains("reason")) detection.reason = read_text(node, "reason");
  const Node ground = child(node, "ground");
  detection.ground = read_ground(ground);
  if (ground.object.contains("disparity_sd_px")) detection.disparity_sd_px = read_number(ground, "disparity_sd_px");
  read_ego_motion(child(node, "ego_motion"), detection);
  detection.obstacles = read_list(node, "obstacles", read_obstacle);
  detection.tracks = read_list(node, "tracks", read_obstacle);
  detection.rejected = read_list(node, "rejected", read_rejected);
  if (json.contains("no_disparity_off")) detection.no_disparity_off = read_text(node, "no_disparity_off");
  detection.times = read_times(child(node, "times_ms"));
  return detection;
}

}  // namespace

std::vector<Detection> read_detections(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw std::runtime_error(path + ": no such file");
  if (std::filesystem::is_directory(path, error)) throw std::runtime_error(path + ": is a folder, expected a file");
  std::ifstream lines(path, std::ios::binary);
  if (!lines) throw std::runtime_error(path + ": cannot be read");
  std::vector<Detection> detections;
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (trimmed(line).empty()) continue;
    try {
      Detection detection = parse_detection(line);
      if (!detections.empty() && detection.frame <= detections.back().frame) {
        throw std::runtime_error(
            fmt::format("frame = {}, expected more than the one before, {}", detection.frame, detections.back().frame));
      }
      detections.push_back(std::move(detection));
    } catch (const std::runtime_error& fault) {
      throw std::runtime_error(fmt::format("{}: line {}: {}", path, number, fault.what()));
    }
  }
  if (lines.bad()) throw std::runtime_error(path + ": cannot be read");
  if (detections.empty()) throw std::runtime_error(path + ": is empty, expected one line for each frame");
  return detections;
}

}  // namespace brink
