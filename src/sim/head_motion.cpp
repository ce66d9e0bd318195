// Head motion of a walk. Everything that depends on the way walked (position, ground, heading) is a uniform cubic B-spline over
// equal steps of arc length, whose control points were smoothed by a Gaussian before; everything that depends on time alone
// (gait, looking around) is made of sines and quintic steps. All of these are twice differentiable.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "brink/sim/simulate.hpp"
#include "sim/random.hpp"

namespace brink::sim {
namespace {

constexpr double kStep = 0.05;    // m between control points
constexpr double kMargin = 3.0;   // m of straight way before and after the path
constexpr double kCorner = 0.4;   // m, Gaussian that rounds corners
constexpr double kRamp = 0.3;     // m, Gaussian over the ground's height: a kerb takes about a step
constexpr double kHeading = 0.3;  // m, Gaussian over the heading
constexpr double kReach = 4.0;    // of a Gaussian, in its sigma
constexpr double kRadians = std::numbers::pi / 180.0;

void require(bool valid, const char* name, double value, const char* expected) {
  if (!valid) throw std::invalid_argument(fmt::format("walk.{} = {}, must be {}", name, value, expected));
}

void require_within(const char* name, double value, double low, double high) {
  require(value >= low && value <= high, name, value, fmt::format("{} to {}", low, high).c_str());
}

void check(const Walk& walk) {
  const std::size_t count = walk.waypoints.size();
  require(count >= 2, "waypoints.size()", static_cast<double>(count), "at least 2");
  for (std::size_t i = 0; i < count; ++i) {
    require(walk.waypoints[i].allFinite(), "waypoints", static_cast<double>(i), "a finite point");
    const double step = i == 0 ? 1.0 : (walk.waypoints[i] - walk.waypoints[i - 1]).norm();
    require(step >= 0.01, "waypoints", static_cast<double>(i), "at least 0.01 m from the one before");
  }
  require_within("speed_mps", walk.speed_mps, 0.01, 10.0);
  require_within("camera_height_m", walk.camera_height_m, 0.01, 10.0);
  require_within("pitch_deg", walk.pitch_deg, -90.0, 90.0);
  require_within("step_length_m", walk.step_length_m, 0.1, 2.0);
  require_within("bob_m", walk.bob_m, 0.0, 0.5);
  require_within("sway_m", walk.sway_m, 0.0, 0.5);
  require_within("roll_deg", walk.roll_deg, 0.0, 45.0);
  require_within("pitch_swing_deg", walk.pitch_swing_deg, 0.0, 45.0);
  require_within("yaw_swing_deg", walk.yaw_swing_deg, 0.0, 45.0);
  require_within("look_yaw_deg", walk.look_yaw_deg, 0.0, 90.0);
  require_within("look_pitch_deg", walk.look_pitch_deg, 0.0, 90.0);
  require_within("look_period_s", walk.look_period_s, 1.0, 1e6);
}

// Points at equal steps along a polyline, from its start; less than a step is left over at its end.
std::vector<Eigen::Vector2d> resample(const std::vector<Eigen::Vector2d>& line, double step) {
  std::vector<Eigen::Vector2d> points{line.front()};
  double missing = step;  // to the next point
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Eigen::Vector2d side = line[i] - line[i - 1];
    const double length = side.norm();
    while (missing <= length) {
      points.emplace_back(line[i - 1] + missing / length * side);
      missing += step;
    }
    missing -= length;
  }
  return points;
}

// Gaussian smoothing, sigma in samples; beyond the ends the outermost values go on.
template <typename Value>
std::vector<Value> smooth(const std::vector<Value>& values, double sigma) {
  const int reach = static_cast<int>(std::ceil(kReach * sigma));
  const int last = static_cast<int>(values.size()) - 1;
  std::vector<double> kernel;
  double total = 0.0;
  for (int k = -reach; k <= reach; ++k) total += kernel.emplace_back(std::exp(-0.5 * k * k / (sigma * sigma)));
  std::vector<Value> smoothed;
  smoothed.reserve(values.size());
  for (int i = 0; i <= last; ++i) {
    Value sum = 0.0 * values.front();
    for (int k = 0; k <= 2 * reach; ++k) {
      const int at = std::clamp(i + k - reach, 0, last);
      sum += kernel[static_cast<std::size_t>(k)] / total * values[static_cast<std::size_t>(at)];
    }
    smoothed.push_back(sum);
  }
  return smoothed;
}

// The path with round corners as points at equal steps, with kMargin straight on before and after it.
std::vector<Eigen::Vector2d> round_corners(const std::vector<Eigen::Vector2d>& waypoints) {
  constexpr double kFine = kStep / 5.0;
  constexpr double kCut = kReach * kCorner;  // where smoothing sees the end of the line
  const Eigen::Vector2d first = (waypoints[1] - waypoints[0]).normalized();
  const Eigen::Vector2d last = (waypoints.back() - waypoints[waypoints.size() - 2]).normalized();
  std::vector<Eigen::Vector2d> line = waypoints;
  line.insert(line.begin(), waypoints.front() - (kMargin + kCut) * first);
  line.emplace_back(waypoints.back() + (kMargin + kCut) * last);
  const std::vector<Eigen::Vector2d> smoothed = smooth(resample(line, kFine), kCorner / kFine);
  const auto cut = static_cast<std::ptrdiff_t>(std::lround(kCut / kFine));
  return resample({smoothed.begin() + cut, smoothed.end() - cut}, kStep);
}

// Ground under the points, in order. The margins are no part of the path: whatever lies there, they go on level.
std::vector<double> follow_ground(const std::vector<Eigen::Vector2d>& points, const GroundHeight& ground_height) {
  const auto margin = static_cast<std::size_t>(std::lround(kMargin / kStep));
  std::vector<double> heights;
  double height = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d& point = points[std::clamp(i, margin, points.size() - 1 - margin)];
    const double found = ground_height(point.x(), point.y(), height);
    if (std::isfinite(found)) height = found;
    heights.push_back(height);
  }
  return smooth(heights, kRamp / kStep);
}

// Direction of the path at its points, rad, without jumps by a full turn.
std::vector<double> follow_heading(const std::vector<Eigen::Vector2d>& points) {
  std::vector<double> headings;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d along = points[std::min(i + 1, points.size() - 1)] - points[i == 0 ? 0 : i - 1];
    double heading = std::atan2(along.y(), along.x());
    if (!headings.empty()) heading = headings.back() + std::remainder(heading - headings.back(), 2.0 * std::numbers::pi);
    headings.push_back(heading);
  }
  return smooth(headings, kHeading / kStep);
}

// Uniform cubic B-spline. @param position in control points; before the first and after the last it goes straight on.
Eigen::Vector4d evaluate(const std::vector<Eigen::Vector4d>& control, double position) {
  const std::size_t last = control.size() - 2;
  const double inside = std::clamp(position, 1.0, static_cast<double>(last));
  const std::size_t start = std::min(static_cast<std::size_t>(inside), last - 1);
  const double t = inside - static_cast<double>(start);
  const double s = 1.0 - t;
  const std::array<double, 4> weights{s * s * s, (3.0 * t - 6.0) * t * t + 4.0, (3.0 * s - 6.0) * s * s + 4.0, t * t * t};
  Eigen::Vector4d value = Eigen::Vector4d::Zero();
  for (std::size_t k = 0; k < weights.size(); ++k) value += weights[k] / 6.0 * control[start - 1 + k];
  const std::size_t end = position < 1.0 ? 1 : last;
  return value + (position - inside) / 2.0 * (control[end + 1] - control[end - 1]);
}

// The step of least jerk from 0 to 1 (Flash and Hogan 1985): velocity and acceleration vanish at both ends.
double ease(double t) {
  const double x = std::clamp(t, 0.0, 1.0);
  return x * x * x * (10.0 + x * (6.0 * x - 15.0));
}
constexpr double kEasePeak = 1.875;  // its greatest velocity

}  // namespace

HeadMotion::HeadMotion(const Walk& walk, const GroundHeight& ground_height) : walk_(walk) {
  check(walk);
  const std::vector<Eigen::Vector2d> points = round_corners(walk.waypoints);
  const std::vector<double> ground = follow_ground(points, ground_height);
  const std::vector<double> heading = follow_heading(points);
  for (std::size_t i = 0; i < points.size(); ++i) track_.emplace_back(points[i].x(), points[i].y(), ground[i], heading[i]);
  length_ = kStep * static_cast<double>(points.size() - 1) - 2.0 * kMargin;
  plan_looks();
}

// To one side, and back to about straight ahead, as people do.
void HeadMotion::plan_looks() {
  constexpr double kShortest = 0.4;  // s, of a turn
  constexpr double kSlowest = 40.0;  // deg/s, greatest rate on the way
  constexpr double kFastest = 100.0;
  constexpr double kBack = 0.15;  // share of the greatest angle that is still "ahead"
  Random random(static_cast<unsigned>(walk_.seed));
  Eigen::Vector2d from = Eigen::Vector2d::Zero();
  double start = walk_.look_period_s * random.uniform(0.2, 0.6);
  while (start < duration()) {
    const double share = looks_.size() % 2 == 0 ? 1.0 : kBack;
    const double yaw = share * walk_.look_yaw_deg * random.uniform(-1.0, 1.0);
    const Eigen::Vector2d angle(kRadians * yaw, kRadians * share * walk_.look_pitch_deg * random.uniform(-1.0, 1.0));
    const double rate = kRadians * random.uniform(kSlowest, kFastest);
    const double length = std::max(kEasePeak * (angle - from).norm() / rate, kShortest);
    looks_.push_back({start, length, angle});
    from = angle;
    start += std::max(length, walk_.look_period_s * random.uniform(0.3, 0.7));
  }
}

double HeadMotion::duration() const { return length_ / walk_.speed_mps; }

Eigen::Vector2d HeadMotion::look(double time) const {
  Eigen::Vector2d angle = Eigen::Vector2d::Zero();
  for (const Look& turn : looks_) {
    if (time <= turn.start) break;
    angle += ease((time - turn.start) / turn.length) * (turn.angle - angle);
  }
  return angle;
}

Eigen::Isometry3d HeadMotion::operator()(double time) const {
  const double way = time * walk_.speed_mps;
  const Eigen::Vector4d track = evaluate(track_, (way + kMargin) / kStep);
  const double step = 2.0 * std::numbers::pi * way / walk_.step_length_m;
  const double stride = 0.5 * step;  // a stride is two steps
  const double heading = track[3];

  const double sway = walk_.sway_m * std::sin(stride);  // to the left
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
  world_from_camera.translation() << track[0] - sway * std::sin(heading), track[1] + sway * std::cos(heading),
      track[2] + walk_.camera_height_m + walk_.bob_m * std::cos(step);

  // The phases are not those of sway and bob: a head is not a rigid part of the body.
  const Eigen::Vector2d looked = look(time);
  const double yaw = looked.x() + kRadians * walk_.yaw_swing_deg * std::sin(stride + 0.5);
  const double pitch = looked.y() + kRadians * (walk_.pitch_deg + walk_.pitch_swing_deg * std::sin(step + 0.3));
  const double roll = kRadians * walk_.roll_deg * std::sin(stride + 0.2);
  Eigen::Matrix3d world_from_level;                               // a camera that looks level along the path
  world_from_level << std::sin(heading), 0.0, std::cos(heading),  //
      -std::cos(heading), 0.0, std::sin(heading),                 //
      0.0, -1.0, 0.0;
  world_from_camera.linear() = world_from_level * Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitY()) *
                               Eigen::AngleAxisd(-pitch, Eigen::Vector3d::UnitX()) *
                               Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ());
  return world_from_camera;
}

}  // namespace brink::sim
