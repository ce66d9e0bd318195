#include "io/euroc.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "brink/calibration.hpp"
#include "brink/files.hpp"
#include "io/calibration/kinds.hpp"
#include "io/picture_source.hpp"
#include "io/sequence_files.hpp"
#include "io/text.hpp"
#include "io/yaml_fields.hpp"

namespace brink {
namespace fs = std::filesystem;
namespace {

using Nanoseconds = std::int64_t;

double seconds(Nanoseconds time) { return 1e-9 * static_cast<double>(time); }

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

Eigen::Matrix3d rectified_from_body(const StereoCalibration& calibration, const std::string& left_sensor) {
  const YAML::Node root = parse_opencv_yaml(left_sensor, read_file(left_sensor), "T_BS");
  const Eigen::Matrix3d left_from_body = read_body_from_sensor(left_sensor, root).linear().transpose();
  return calibration.rectification ? calibration.rectification->rectified_from_left * left_from_body : left_from_body;
}

// Both eyes' pictures by time. A camera that lacks one has an empty name there.
std::vector<FrameFiles> match(const std::string& list, const TimedFiles& left, const TimedFiles& right) {
  std::map<Nanoseconds, FrameFiles> frames;
  for (const auto& [time, path] : left) frames[time].left = path;
  for (const auto& [time, path] : right) frames[time].right = path;
  std::vector<FrameFiles> files;
  for (auto& [time, frame] : frames) {
    frame.index = static_cast<int>(files.size());
    frame.time = seconds(time - frames.begin()->first);
    if (!files.empty() && frame.time <= files.back().time) {  // in years of seconds nanoseconds are lost
      fail_file(list, fmt::format("time {} is {:.0f} s after the first one and cannot be told from the one before", time,
                                  frame.time));
    }
    files.push_back(std::move(frame));
  }
  return files;
}

}  // namespace

bool is_euroc(const std::string& folder) {
  std::error_code error;
  return fs::is_directory(fs::path(folder) / "mav0" / "cam0", error);
}

Sequence open_euroc(const std::string& folder, std::optional<PictureState> pictures) {
  const fs::path root = fs::path(folder) / "mav0";
  const std::string left_sensor = (root / "cam0" / "sensor.yaml").string();
  const std::string right_sensor = (root / "cam1" / "sensor.yaml").string();
  const TimedFiles left_pictures = read_pictures(root / "cam0");
  const TimedFiles right_pictures = read_pictures(root / "cam1");
  const std::vector<FrameFiles> files = match((root / "cam0" / "data.csv").string(), left_pictures, right_pictures);
  if (files.size() == left_pictures.size() + right_pictures.size()) {
    fail_file((root / "cam1" / "data.csv").string(), "shares no time with that of cam0, expected equal times for each pair");
  }
  const StereoCalibration calibration = read_calibration({left_sensor, right_sensor, pictures}, first_picture_size(files));
  const Nanoseconds start = std::min(left_pictures.begin()->first, right_pictures.begin()->first);
  std::error_code error;
  std::vector<ImuSample> imu;
  if (fs::exists(root / "imu0" / "data.csv", error)) {
    imu = read_euroc_imu(root / "imu0", start, rectified_from_body(calibration, left_sensor));
  }
  std::vector<std::string> remarks{fmt::format("{}: EuRoC/ASL, {} frames, {}; calibration: {}", folder, files.size(),
                                               imu.empty() ? "no IMU" : fmt::format("{} IMU readings", imu.size()),
                                               describe(calibration))};
  std::vector<FrameStamp> stamps;
  std::vector<int> left_indices;
  std::vector<int> right_indices;
  for (const FrameFiles& frame : files) {
    stamps.push_back({frame.index, frame.time});
    if (!frame.left.empty()) left_indices.push_back(frame.index);
    if (!frame.right.empty()) right_indices.push_back(frame.index);
  }
  if (const auto remark = unequal_counts(folder, left_indices, right_indices)) remarks.push_back(*remark);
  return {calibration.camera, std::move(stamps),
          std::make_unique<CalibratedSource>(std::make_unique<PictureFiles>(files), calibration), std::move(imu),
          std::move(remarks)};
}

}  // namespace brink
