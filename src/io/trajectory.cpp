#include "brink/trajectory.hpp"

#include <cmath>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>

#include "brink/files.hpp"
#include "io/text.hpp"

namespace brink {
namespace {

constexpr std::size_t kKittiColumns = 12;  // row-major 3x4
constexpr std::size_t kTumColumns = 8;     // t tx ty tz qx qy qz qw
using Numbers = std::vector<double>;

Numbers read_numbers(const std::string& line) {
  Numbers numbers;
  std::istringstream words(line);
  for (std::string word; words >> word;) {
    const std::optional<double> number = parse_number(word);
    if (!number) throw std::runtime_error(fmt::format("number {} = {}, expected a finite number", numbers.size() + 1, word));
    numbers.push_back(*number);
  }
  return numbers;
}

Eigen::Isometry3d make_pose(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = rotation.normalized().toRotationMatrix();
  pose.translation() = translation;
  return pose;
}

Eigen::Isometry3d from_kitti(const Numbers& numbers) {
  constexpr double kTolerance = 1e-3;
  const Eigen::Matrix<double, 3, 4> rows = Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(numbers.data());
  const Eigen::Matrix3d rotation = rows.leftCols<3>();
  const double deviation = (rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(deviation <= kTolerance) || rotation.determinant() < 0.0) {
    throw std::runtime_error("is not a motion, expected columns 1 to 3 to be a rotation matrix");
  }
  return make_pose(Eigen::Quaterniond(rotation), rows.col(3));
}

Eigen::Isometry3d from_tum(const Numbers& numbers) {
  const Eigen::Quaterniond rotation(numbers[7], numbers[4], numbers[5], numbers[6]);
  constexpr double kShortest = 1e-6;
  if (!(rotation.norm() > kShortest))
    throw std::runtime_error("is not a motion, expected a quaternion qx qy qz qw that is not 0");
  return make_pose(rotation, {numbers[1], numbers[2], numbers[3]});
}

void add_pose(Trajectory& trajectory, const Numbers& numbers) {
  const bool is_kitti = numbers.size() == kKittiColumns;
  if (!is_kitti && numbers.size() != kTumColumns) {
    throw std::runtime_error(
        fmt::format("has {} numbers, expected 12 (KITTI: row-major 3x4) or 8 (TUM: t tx ty tz qx qy qz qw)", numbers.size()));
  }
  if (!trajectory.world_from_camera.empty() && is_kitti != trajectory.times.empty()) {
    throw std::runtime_error(fmt::format("has {} numbers, expected {} like the lines before", numbers.size(),
                                         is_kitti ? kTumColumns : kKittiColumns));
  }
  if (!is_kitti) {
    if (!trajectory.times.empty() && numbers[0] <= trajectory.times.back()) {
      throw std::runtime_error(
          fmt::format("time {}, expected more than the one before, {}", numbers[0], trajectory.times.back()));
    }
    trajectory.times.push_back(numbers[0]);
  }
  trajectory.world_from_camera.push_back(is_kitti ? from_kitti(numbers) : from_tum(numbers));
}

}  // namespace

Trajectory read_trajectory(const std::string& path) {
  Trajectory trajectory;
  std::istringstream lines(read_file(path));
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (trimmed(line).empty() || trimmed(line).starts_with('#')) continue;
    try {
      add_pose(trajectory, read_numbers(line));
    } catch (const std::runtime_error& fault) {
      throw std::runtime_error(fmt::format("{}: line {} {}", path, number, fault.what()));
    }
  }
  if (trajectory.world_from_camera.empty()) throw std::runtime_error(path + ": holds no poses, expected one a line");
  return trajectory;
}

std::string to_kitti(const Trajectory& trajectory) {
  std::string text;
  for (const Eigen::Isometry3d& pose : trajectory.world_from_camera) {
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column) {
        text += fmt::format("{:.9f}{}", pose(row, column), row == 2 && column == 3 ? '\n' : ' ');
      }
    }
  }
  return text;
}

std::string to_tum(const Trajectory& trajectory) {
  if (trajectory.times.size() != trajectory.world_from_camera.size()) {
    throw std::invalid_argument(fmt::format("trajectory has {} times, must be one for each of its {} poses",
                                            trajectory.times.size(), trajectory.world_from_camera.size()));
  }
  std::string text;
  for (std::size_t i = 0; i < trajectory.times.size(); ++i) {
    const Eigen::Isometry3d& pose = trajectory.world_from_camera[i];
    Eigen::Quaterniond q(pose.linear());
    if (q.w() < 0.0) q.coeffs() = -q.coeffs();  // the same rotation; of the two the one that readers expect
    text += fmt::format("{:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", trajectory.times[i],
                        pose.translation().x(), pose.translation().y(), pose.translation().z(), q.x(), q.y(), q.z(), q.w());
  }
  return text;
}

}  // namespace brink
