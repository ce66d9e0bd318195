#include "io/euroc.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "brink/files.hpp"
#include "io/picture_source.hpp"
#include "io/sequence_files.hpp"
#include "io/text.hpp"
#include "io/yaml_fields.hpp"

namespace brink {
namespace fs = std::filesystem;
namespace {

using Nanoseconds = std::int64_t;

double seconds(Nanoseconds time) { return 1e-9 * static_cast<double>(time); }

/// A camera as sensor.yaml tells it.
struct EurocCamera {
  LensCamera lens;
  Eigen::Isometry3d body_from_camera;
};

void expect_word(const std::string& path, const YAML::Node& root, const std::string& field, const std::set<std::string>& known,
                 const std::string& expected) {
  const YAML::Node node = root[field];
  const std::string word = node && node.IsScalar() ? node.Scalar() : "";
  if (!known.contains(word)) {
    fail_file(path, fmt::format("{} = {}, expected {}", field, word.empty() ? "nothing" : word, expected));
  }
}

YAML::Node required(const std::string& path, const YAML::Node& root, const std::string& field) {
  if (!root[field]) fail_file(path, field + " is missing");
  return root[field];
}

// T_BS: 4x4, row by row, of the body from the sensor.
Eigen::Isometry3d read_body_from_sensor(const std::string& path, const YAML::Node& root) {
  constexpr std::size_t kSize = 16;
  const std::vector<double> numbers = read_numbers(path, "T_BS", required(path, root, "T_BS"), kSize);
  const Eigen::Matrix4d matrix = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers.data());
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  constexpr double kTolerance = 1e-3;
  const double skew = (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (skew > kTolerance || rotation.determinant() < 0.0 || matrix.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
    fail_file(path, "T_BS is no rotation and shift, expected R t, 0 0 0 1");
  }
  Eigen::Isometry3d body_from_sensor = Eigen::Isometry3d::Identity();
  body_from_sensor.linear() = Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
  body_from_sensor.translation() = matrix.topRightCorner<3, 1>();
  return body_from_sensor;
}

EurocCamera read_camera(const std::string& path) {
  const YAML::Node root = parse_opencv_yaml(path, read_file(path), "those of an ASL camera: T_BS, intrinsics, ...");
  expect_word(path, root, "camera_model", {"pinhole"}, "pinhole");
  expect_word(path, root, "distortion_model", {"radial-tangential", "radtan"},
              "radial-tangential: other lenses are not known to this version");
  const std::vector<double> intrinsics = read_numbers(path, "intrinsics", required(path, root, "intrinsics"), 4);
  const std::vector<double> resolution = read_numbers(path, "resolution", required(path, root, "resolution"), 2);
  const YAML::Node lens = required(path, root, "distortion_coefficients");
  constexpr std::size_t kWithK3 = 5;
  const std::vector<double> distortion =
      read_numbers(path, "distortion_coefficients", lens, lens.size() == kWithK3 ? kWithK3 : 4);
  for (const double side : resolution) {
    constexpr double kLargest = 20000;
    if (side < 1 || side > kLargest || side != std::floor(side)) {
      fail_file(path, fmt::format("resolution = {}, expected whole numbers from 1 to {} px", side, kLargest));
    }
  }
  for (const double focal : {intrinsics[0], intrinsics[1]}) {
    constexpr double kLargest = 1e6;
    if (focal < 1 || focal > kLargest) fail_file(path, fmt::format("focal length = {}, expected 1 to {} px", focal, kLargest));
  }
  return {{intrinsics[0], intrinsics[1], intrinsics[2], intrinsics[3], cv::Mat1d(distortion, true).reshape(1, 1),
           cv::Size(static_cast<int>(resolution[0]), static_cast<int>(resolution[1]))},
          read_body_from_sensor(path, root)};
}

// The fields of each line that is not a comment, the first one as time.
template <typename Take>
void read_csv(const std::string& path, std::size_t fields, Take take) {
  std::istringstream lines(read_file(path));
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (trimmed(line).empty() || line.starts_with('#')) continue;
    std::vector<std::string> words;
    std::istringstream stream(line);
    for (std::string word; std::getline(stream, word, ',');) words.emplace_back(trimmed(word));
    const std::optional<Nanoseconds> time = words.empty() ? std::nullopt : parse_number<Nanoseconds>(words[0]);
    if (words.size() != fields || !time || *time < 0) {
      fail_file(path,
                fmt::format("line {} = {}, expected {} fields, the first one a time in ns", number, trimmed(line), fields));
    }
    take(number, *time, words);
  }
}

using TimedFiles = std::map<Nanoseconds, std::string>;

TimedFiles read_pictures(const fs::path& camera) {
  const std::string path = (camera / "data.csv").string();
  TimedFiles pictures;
  read_csv(path, 2, [&](int line, Nanoseconds time, const std::vector<std::string>& words) {
    if (!pictures.emplace(time, (camera / "data" / words[1]).string()).second) {
      fail_file(path, fmt::format("line {}: time {} is there twice, expected each once", line, time));
    }
  });
  if (pictures.empty()) fail_file(path, "lists no pictures");
  return pictures;
}

// Readings in the frame of the rectified left camera. The lever arm between IMU and camera is left out: what it adds, the
// rate squared times its length, is small beside gravity.
std::vector<ImuSample> read_euroc_imu(const fs::path& imu, Nanoseconds start, const Eigen::Matrix3d& rectified_from_body) {
  const std::string path = (imu / "data.csv").string();
  const std::string sensor = (imu / "sensor.yaml").string();
  const YAML::Node root = parse_opencv_yaml(sensor, read_file(sensor), "T_BS");
  const Eigen::Matrix3d rectified_from_imu = rectified_from_body * read_body_from_sensor(sensor, root).linear();
  std::vector<ImuSample> samples;
  constexpr std::size_t kFields = 7;
  read_csv(path, kFields, [&](int line, Nanoseconds time, const std::vector<std::string>& words) {
    std::array<double, kFields - 1> values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = read_number(path, fmt::format("line {}", line), i + 1, words[i + 1]);
    }
    const double since_start = seconds(time - start);
    if (!samples.empty() && since_start <= samples.back().time) {
      fail_file(path, fmt::format("line {}: time {}, expected more than the one before", line, time));
    }
    samples.push_back({since_start, rectified_from_imu * Eigen::Vector3d(values[0], values[1], values[2]),
                       rectified_from_imu * Eigen::Vector3d(values[3], values[4], values[5])});
  });
  return samples;
}

// Both eyes' pictures by time. A camera that lacks one has an empty name there.
std::vector<FrameFiles> match(const TimedFiles& left, const TimedFiles& right) {
  std::map<Nanoseconds, FrameFiles> frames;
  for (const auto& [time, path] : left) frames[time].left = path;
  for (const auto& [time, path] : right) frames[time].right = path;
  std::vector<FrameFiles> files;
  for (auto& [time, frame] : frames) {
    frame.index = static_cast<int>(files.size());
    frame.time = seconds(time - frames.begin()->first);
    files.push_back(std::move(frame));
  }
  return files;
}

Rectification rectify(const std::string& path, const EurocCamera& left, const EurocCamera& right) {
  if (left.lens.size != right.lens.size) {
    fail_file(path, fmt::format("resolution = {}x{}, expected that of cam0, {}x{}", right.lens.size.width,
                                right.lens.size.height, left.lens.size.width, left.lens.size.height));
  }
  const Eigen::Isometry3d left_from_right = left.body_from_camera.inverse() * right.body_from_camera;
  const Eigen::Vector3d place = left_from_right.translation();
  if (place.x() <= std::abs(place.y())) {
    fail_file(path,
              fmt::format("T_BS puts cam1 at ({:.4f}, {:.4f}, {:.4f}) m in cam0, expected on its right: are they swapped?",
                          place.x(), place.y(), place.z()));
  }
  Rectification rectification = make_rectification(left.lens, right.lens, left_from_right.inverse());
  try {
    rectification.camera.validate();
  } catch (const std::invalid_argument& error) {
    fail_file(path, fmt::format("with cam0: {}", error.what()));
  }
  return rectification;
}

}  // namespace

bool is_euroc(const std::string& folder) {
  std::error_code error;
  return fs::is_directory(fs::path(folder) / "mav0" / "cam0", error);
}

Sequence open_euroc(const std::string& folder) {
  const fs::path root = fs::path(folder) / "mav0";
  const EurocCamera left = read_camera((root / "cam0" / "sensor.yaml").string());
  const std::string right_sensor = (root / "cam1" / "sensor.yaml").string();
  const EurocCamera right = read_camera(right_sensor);
  const TimedFiles left_pictures = read_pictures(root / "cam0");
  const TimedFiles right_pictures = read_pictures(root / "cam1");
  const std::vector<FrameFiles> files = match(left_pictures, right_pictures);
  if (files.size() == left_pictures.size() + right_pictures.size()) {
    fail_file((root / "cam1" / "data.csv").string(), "shares no time with that of cam0, expected equal times for each pair");
  }
  const Rectification rectification = rectify(right_sensor, left, right);
  const Nanoseconds start = std::min(left_pictures.begin()->first, right_pictures.begin()->first);
  std::error_code error;
  std::vector<ImuSample> imu;
  if (fs::exists(root / "imu0" / "data.csv", error)) {
    imu = read_euroc_imu(root / "imu0", start, rectification.rectified_from_left * left.body_from_camera.linear().transpose());
  }
  std::vector<std::string> remarks{
      fmt::format("{}: EuRoC/ASL, rectified on the fly: {}x{} px, focal length {:.2f} px, baseline {:.4f} m, {}", folder,
                  rectification.size.width, rectification.size.height, rectification.camera.focal,
                  rectification.camera.baseline, imu.empty() ? "no IMU" : fmt::format("{} IMU readings", imu.size()))};
  std::vector<FrameStamp> stamps;
  std::vector<int> left_indices;
  std::vector<int> right_indices;
  for (const FrameFiles& frame : files) {
    stamps.push_back({frame.index, frame.time});
    if (!frame.left.empty()) left_indices.push_back(frame.index);
    if (!frame.right.empty()) right_indices.push_back(frame.index);
  }
  if (const auto remark = unequal_counts(folder, left_indices, right_indices)) remarks.push_back(*remark);
  const StereoCamera camera = rectification.camera;
  return {camera, std::move(stamps), std::make_unique<RectifiedSource>(std::make_unique<PictureFiles>(files), rectification),
          std::move(imu), std::move(remarks)};
}

}  // namespace brink
