#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <stdexcept>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "brink/files.hpp"
#include "brink/sequence.hpp"
#include "io/text.hpp"

namespace brink {
namespace {

constexpr double kGravityWindow = 3.0;  // s: steps cancel in one; a turn of 1.7 m/s^2 for a second weighs less in three
constexpr std::size_t kFewestSamples = 20;
constexpr double kLongestGap = 0.1;        // s: a head turns by up to 10 degrees in this time
constexpr double kGravityTolerance = 1.5;  // m/s^2 that the mean may differ from gravity before it is not believed

/// t,gx,gy,gz,ax,ay,az; empty when the line is not seven numbers.
std::optional<ImuSample> parse_sample(const std::string& line) {
  std::array<double, 7> values{};
  std::istringstream fields(line);
  std::size_t count = 0;
  for (std::string field; std::getline(fields, field, ','); ++count) {
    const std::optional<double> number = parse_number(trimmed(field));
    if (!number || count >= values.size()) return std::nullopt;
    values[count] = *number;
  }
  if (count != values.size()) return std::nullopt;
  return ImuSample{values[0], {values[1], values[2], values[3]}, {values[4], values[5], values[6]}};
}

/// The angular rate at a time between two readings.
Eigen::Vector3d rate_at(const ImuSample& before, const ImuSample& after, double time) {
  const double share = (time - before.time) / (after.time - before.time);
  return (1.0 - share) * before.angular_rate + share * after.angular_rate;
}

}  // namespace

std::vector<ImuSample> read_imu(const std::string& path) {
  std::vector<ImuSample> samples;
  std::istringstream lines(read_file(path));
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    const bool heading = number == 1 && line.starts_with('t');
    if (heading || trimmed(line).empty()) continue;
    const std::optional<ImuSample> sample = parse_sample(line);
    if (!sample) {
      throw std::runtime_error(
          fmt::format("{}: line {} = {}, expected seven numbers t,gx,gy,gz,ax,ay,az", path, number, trimmed(line)));
    }
    if (!samples.empty() && sample->time <= samples.back().time) {
      throw std::runtime_error(fmt::format("{}: line {}: time {}, expected more than the one before, {}", path, number,
                                           sample->time, samples.back().time));
    }
    samples.push_back(*sample);
  }
  return samples;
}

std::optional<Eigen::Vector3d> estimate_gravity(const std::vector<ImuSample>& samples, double time) {
  const auto first = std::ranges::lower_bound(samples, time - kGravityWindow, {}, &ImuSample::time);
  const auto last = std::ranges::upper_bound(samples, time, {}, &ImuSample::time);
  if (static_cast<std::size_t>(last - first) < kFewestSamples) return std::nullopt;
  // The head turns within that time: each reading is brought into the frame of the last one by the gyroscope.
  Eigen::Matrix3d last_from_sample = Eigen::Matrix3d::Identity();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (auto sample = last; sample-- != first;) {
    if (sample + 1 != last) {
      const Eigen::Vector3d turn = sample->angular_rate * ((sample + 1)->time - sample->time);
      last_from_sample *= Eigen::AngleAxisd(-turn.norm(), turn.stableNormalized()).toRotationMatrix();
    }
    sum += last_from_sample * sample->specific_force;
  }
  const Eigen::Vector3d mean = sum / static_cast<double>(last - first);
  if (std::abs(mean.norm() - kGravity) > kGravityTolerance) return std::nullopt;
  return -mean.normalized();
}

std::optional<Eigen::Matrix3d> integrate_gyroscope(const std::vector<ImuSample>& samples, double from, double to) {
  if (!(from < to) || samples.empty() || samples.front().time > from || samples.back().time < to) return std::nullopt;
  Eigen::Matrix3d current_from_previous = Eigen::Matrix3d::Identity();
  auto after = std::ranges::upper_bound(samples, from, {}, &ImuSample::time);
  for (double time = from; time < to; ++after) {
    const ImuSample& before = *(after - 1);
    if (after == samples.end() || after->time - before.time >= kLongestGap) return std::nullopt;
    const double until = std::min(after->time, to);
    const Eigen::Vector3d turn = rate_at(before, *after, 0.5 * (time + until)) * (until - time);
    // The camera turns by `turn`, so what stands still turns the other way in its axes.
    current_from_previous = Eigen::AngleAxisd(-turn.norm(), turn.stableNormalized()) * current_from_previous;
    time = until;
  }
  return current_from_previous;
}

}  // namespace brink
