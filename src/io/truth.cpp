#include "brink/truth.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "brink/calibration.hpp"
#include "brink/files.hpp"
#include "brink/pictures.hpp"
#include "brink/trajectory.hpp"
#include "io/rim_plane.hpp"
#include "io/sequence_files.hpp"
#include "io/text.hpp"
#include "io/yaml_fields.hpp"

namespace brink {
namespace fs = std::filesystem;
namespace {

struct TypeOfInstance {
  std::string_view name;
  ObstacleKind kind;
};

// A lower ground is a place with ground around it, as the simulator makes it, not what lies beyond an edge: a shallow wide
// hole.
constexpr std::array<TypeOfInstance, 7> kTypes = {{{"stairs_down", ObstacleKind::stairs_down},
                                                   {"platform_edge", ObstacleKind::edge},
                                                   {"manhole", ObstacleKind::hole},
                                                   {"trench", ObstacleKind::hole},
                                                   {"pothole", ObstacleKind::hole},
                                                   {"lower_ground", ObstacleKind::hole},
                                                   {"curb", ObstacleKind::edge}}};

std::string list_types() {
  std::string names;
  for (const TypeOfInstance& type : kTypes) names += (names.empty() ? "" : ", ") + std::string(type.name);
  return names;
}

bool is_there(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error);
}

/// A field of an instance as text, for parse_number. @param where the file and the instance, for messages.
std::string read_scalar(const YAML::Node& map, const std::string& where, const char* name) {
  const YAML::Node field = map[name];
  if (!field || !field.IsScalar()) throw std::runtime_error(fmt::format("{}: {} is missing or no value", where, name));
  return field.Scalar();
}

Eigen::Vector3d read_point(const YAML::Node& node, const std::string& where, std::size_t index) {
  Eigen::Vector3d point;
  bool valid = node.IsSequence() && node.size() == 3;
  for (int i = 0; valid && i < 3; ++i) {
    const YAML::Node coordinate = node[i];
    const std::optional<double> number = coordinate.IsScalar() ? parse_number(coordinate.Scalar()) : std::nullopt;
    valid = number.has_value();
    point[i] = number.value_or(0.0);
  }
  if (!valid) throw std::runtime_error(fmt::format("{}: opening[{}], expected three finite numbers", where, index));
  return point;
}

InstanceTruth read_instance(const YAML::Node& node, const std::string& where) {
  if (!node.IsMap()) throw std::runtime_error(where + ": expected id, type, depth_m and opening");
  InstanceTruth instance;
  const std::string id = read_scalar(node, where, "id");
  instance.id = parse_number<int>(id).value_or(0);
  if (instance.id < 1 || instance.id >= kNotLabelled) {
    throw std::runtime_error(fmt::format("{}: id = {}, expected an integer from 1 to 254", where, id));
  }
  instance.type = read_scalar(node, where, "type");
  if (std::ranges::find(kTypes, instance.type, &TypeOfInstance::name) == kTypes.end()) {
    throw std::runtime_error(fmt::format("{}: type = {}, expected one of {}", where, instance.type, list_types()));
  }
  const std::string depth = read_scalar(node, where, "depth_m");
  instance.depth_m = parse_number(depth).value_or(0.0);
  if (instance.depth_m <= 0.0) throw std::runtime_error(fmt::format("{}: depth_m = {}, expected more than 0", where, depth));
  const YAML::Node opening = node["opening"];
  if (!opening || opening.IsNull()) return instance;  // nobody measured the rim
  if (!opening.IsSequence()) throw std::runtime_error(where + ": opening, expected a list of points");
  for (std::size_t i = 0; i < opening.size(); ++i) instance.opening.push_back(read_point(opening[i], where, i));
  if (!fit_rim_plane(instance.opening)) {
    throw std::runtime_error(
        fmt::format("{}: opening of {} points, expected at least 3 that are not on a line", where, instance.opening.size()));
  }
  return instance;
}

std::vector<InstanceTruth> read_instances(const fs::path& path) {
  std::vector<InstanceTruth> instances;
  const YAML::Node root = parse_yaml(path.string(), read_file(path.string()));
  if (!root.IsSequence()) fail_file(path, "is no list of negative obstacles, expected [] when there is none");
  for (const YAML::Node& node : root) {
    const std::string where = fmt::format("{}: line {}", path.string(), node.Mark().line + 1);
    instances.push_back(read_instance(node, where));
    const auto is_same = [&](const InstanceTruth& other) { return other.id == instances.back().id; };
    if (std::ranges::count_if(instances, is_same) > 1) {
      throw std::runtime_error(fmt::format("{}: id = {} is there already", where, instances.back().id));
    }
  }
  return instances;
}

std::vector<Eigen::Isometry3d> read_poses(const fs::path& path, int last_number) {
  Trajectory trajectory = read_trajectory(path.string());
  if (!trajectory.times.empty()) fail_file(path, "has 8 numbers a line, expected 12 (KITTI: row-major 3x4)");
  if (trajectory.world_from_camera.size() <= static_cast<std::size_t>(last_number)) {
    fail_file(path, fmt::format("has {} poses, expected one for each frame from 0 to {}", trajectory.world_from_camera.size(),
                                last_number));
  }
  return std::move(trajectory.world_from_camera);
}

void check_size(const std::string& path, const cv::Size& size, const cv::Size& expected) {
  if (size != expected) {
    fail_file(path, fmt::format("is {}x{} px, expected {}x{} like the first mask", size.width, size.height, expected.width,
                                expected.height));
  }
}

std::vector<VisibleInstance> count_instances(const cv::Mat1b& negative) {
  std::array<int, 256> pixels{};
  for (const uchar id : negative) ++pixels[id];
  std::vector<VisibleInstance> instances;
  for (int id = 1; id < kNotLabelled; ++id) {
    const int count = pixels[static_cast<std::size_t>(id)];
    if (count > 0)
      instances.push_back({.id = id, .visible_px = count, .depth_m = {}, .distance_m = {}, .bearing_deg = {}, .opening = {}});
  }
  return instances;
}

std::vector<Eigen::Vector3d> move_opening(const std::vector<Eigen::Vector3d>& opening,
                                          const Eigen::Isometry3d& camera_from_world) {
  std::vector<Eigen::Vector3d> moved;
  moved.reserve(opening.size());
  for (const Eigen::Vector3d& point : opening) moved.emplace_back(camera_from_world * point);
  return moved;
}

std::vector<RimPlace> locate_rims(const std::vector<InstanceTruth>& instances, const Eigen::Isometry3d& camera_from_world) {
  std::vector<RimPlace> rims;
  for (const InstanceTruth& instance : instances) {
    if (instance.opening.empty()) continue;
    rims.push_back(locate_rim(move_opening(instance.opening, camera_from_world)));
    rims.back().id = instance.id;
    rims.back().depth_m = instance.depth_m;
  }
  return rims;
}

}  // namespace

SequenceTruth::SequenceTruth(const std::string& folder) : folder_(folder) {
  const fs::path root(folder);
  const fs::path masks = root / "negative";
  if (!is_there(masks)) fail_file(masks, "no such folder, expected masks 000000.png, ... of the negative obstacles");
  for (const auto& [number, path] : list_pictures(masks)) {
    if (fs::path(path).extension() != ".png") fail_file(path, "expected a PNG: other pictures do not keep ids");
    frames_.push_back(number);
    masks_.push_back(path);
  }
  if (frames_.empty()) fail_file(masks, "holds no masks, expected 000000.png, ...");
  size_ = read_mask(masks_.front()).size();
  times_ = read_times(root / "times.txt", frames_.back());
  if (is_there(root / "poses.txt")) poses_ = read_poses(root / "poses.txt", frames_.back());
  if (const CalibrationFiles calibration = find_calibration(root); is_there(calibration.path)) {
    const std::optional<Eyes> eyes = find_eyes(root);
    camera_ = read_calibration(calibration, size_, eyes ? eyes->cameras : CameraPair::any).camera;
  }
  has_instances_ = is_there(root / "instances.yaml");
  if (has_instances_) instances_ = read_instances(root / "instances.yaml");
  if (!is_there(root / "disparity")) return;
  const NumberedFiles disparities = list_pictures(root / "disparity");
  for (const int frame : frames_) {
    const auto found = disparities.find(frame);
    if (found == disparities.end())
      fail_file(root / "disparity", fmt::format("has no picture of frame {}, negative/ has", frame));
    disparities_.push_back(found->second);
  }
}

FrameTruth SequenceTruth::read(int position) const {
  const auto index = static_cast<std::size_t>(position);
  const std::string& path = masks_.at(index);
  FrameTruth truth;
  truth.frame = frames_[index];
  const auto number = static_cast<std::size_t>(truth.frame);
  truth.time = times_.empty() ? truth.frame : times_[number];
  if (!poses_.empty()) truth.world_from_camera = poses_[number];
  truth.camera = camera_;
  truth.negative = read_mask(path);
  check_size(path, truth.negative.size(), size_);
  truth.instances = count_instances(truth.negative);
  if (truth.world_from_camera) truth.rims = locate_rims(instances_, truth.world_from_camera->inverse());
  if (!has_instances_ || truth.instances.empty()) return truth;
  const cv::Mat1f disparity = read_disparity(position);
  for (VisibleInstance& visible : truth.instances) {
    const auto instance = std::ranges::find(instances_, visible.id, &InstanceTruth::id);
    if (instance == instances_.end()) fail_file(path, fmt::format("holds id {}, which instances.yaml lacks", visible.id));
    visible.depth_m = instance->depth_m;
    visible.kind = std::ranges::find(kTypes, instance->type, &TypeOfInstance::name)->kind;
    if (!truth.world_from_camera || !camera_ || instance->opening.empty()) continue;
    visible.opening = move_opening(instance->opening, truth.world_from_camera->inverse());
    const RimSighting rim = find_nearest_rim(visible.opening, *camera_, size_, disparity);
    visible.distance_m = rim.distance_m;
    visible.bearing_deg = rim.bearing_deg;
  }
  return truth;
}

cv::Mat1f SequenceTruth::read_disparity(int position) const {
  if (disparities_.empty()) return {};
  const std::string& path = disparities_.at(static_cast<std::size_t>(position));
  cv::Mat1f disparity = brink::read_disparity(path);
  check_size(path, disparity.size(), size_);
  return disparity;
}

}  // namespace brink
