// Ego-motion on simulated walks and on real pictures. The bounds leave room over what was measured (docs/algorithm.md).
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <yaml-cpp/yaml.h>

#include "brink/ego_motion.hpp"
#include "brink/sequence.hpp"
#include "brink/sim/simulate.hpp"
#include "test_data.hpp"

namespace brink {
namespace {

using Path = std::vector<Eigen::Isometry3d>;  // world_from_camera

double angle_deg(const Eigen::Matrix3d& rotation) { return Eigen::AngleAxisd(rotation).angle() * 180.0 / std::numbers::pi; }

/// Estimates every step; a step without motion is a failure.
Path follow(int frames, const auto& read) {
  EgoMotionEstimator estimator;
  Path path = {Eigen::Isometry3d::Identity()};
  (void)estimator.estimate(read(0));
  for (int i = 1; i < frames; ++i) {
    const EgoMotionEstimate estimate = estimator.estimate(read(i));
    EXPECT_TRUE(estimate.motion) << i << ": " << estimate.reason;
    path.push_back(estimate.motion ? path.back() * estimate.motion->current_from_previous.inverse() : path.back());
  }
  return path;
}

TEST(EgoMotionOnWalks, AccumulatesLittleErrorOnASimulatedWalk) {
  sim::SimulationParams params;
  params.family = "motion";
  params.frames = 20;
  params.width = 480;
  params.height = 270;
  params.focal_px = 262.5;
  sim::Simulator simulator(params);
  const Path path = follow(params.frames, [&](int i) {
    const sim::StereoPictures pictures = simulator.pictures(i);
    return make_frame(pictures.left, pictures.right, simulator.camera(), i, simulator.time(i));
  });
  double turn = 0.0;
  double way = 0.0;
  for (int i = 0; i < params.frames; ++i) {
    const Eigen::Isometry3d truth = simulator.world_from_camera(0).inverse() * simulator.world_from_camera(i);
    turn += (truth.linear() - path[static_cast<std::size_t>(i)].linear()).norm() / params.frames;
    way += (truth.translation() - path[static_cast<std::size_t>(i)].translation()).norm() / params.frames;
  }
  // The paper's, over 376 frames: 0.1027 and 0.1719 m.
  EXPECT_LT(turn, 0.002);
  EXPECT_LT(way, 0.004);
}

Path read_poses(const std::string& file) {
  Path poses;
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream numbers(line);
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    for (int i = 0; i < 12; ++i) numbers >> pose(i / 4, i % 4);
    poses.push_back(pose);
  }
  return poses;
}

TEST(EgoMotionOnWalks, MeetsTheSegmentsOfKitti) {
  BRINK_REQUIRE_DATA(folder, "kitti_straight");
  constexpr double kSegment = 20.0;  // m
  const Sequence sequence = open_sequence(folder);
  const Path truth = read_poses(folder + "/poses.txt");
  const Path path = follow(sequence.size(), [&](int i) { return sequence.read(i).frame; });
  ASSERT_EQ(path.size(), truth.size());
  std::vector<double> ways = {0.0};
  for (std::size_t i = 1; i < truth.size(); ++i)
    ways.push_back(ways.back() + (truth[i - 1].inverse() * truth[i]).translation().norm());
  double translation = 0.0;
  double rotation = 0.0;
  int segments = 0;
  for (std::size_t from = 0; from < truth.size(); ++from) {
    std::size_t to = from;
    while (to < truth.size() && ways[to] < ways[from] + kSegment) ++to;
    if (to == truth.size()) break;
    const Eigen::Isometry3d error = (path[from].inverse() * path[to]).inverse() * (truth[from].inverse() * truth[to]);
    translation += error.translation().norm() / kSegment;
    rotation += angle_deg(error.linear()) / kSegment;
    ++segments;
  }
  ASSERT_GT(segments, 20);
  EXPECT_LE(translation / segments, 0.006);
  EXPECT_LE(rotation / segments, 0.020);
}

/// One camera of the EuRoC data.
struct EurocCamera {
  cv::Matx33d matrix;
  std::vector<double> distortion;
  Eigen::Matrix4d body_from_camera;
};

EurocCamera read_euroc_camera(const std::string& folder) {
  std::ifstream file(folder + "/sensor.yaml");
  std::string text((std::istreambuf_iterator<char>(file)), {});
  const YAML::Node node = YAML::Load(text.substr(text.find('\n') + 1));  // "%YAML:1.0" is not YAML
  const auto f = node["intrinsics"].as<std::vector<double>>();
  const auto pose = node["T_BS"]["data"].as<std::vector<double>>();
  EurocCamera camera{{f[0], 0, f[2], 0, f[1], f[3], 0, 0, 1}, node["distortion_coefficients"].as<std::vector<double>>(), {}};
  camera.body_from_camera = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(pose.data());
  return camera;
}

/// Lines of numbers after a heading; what is no number (a file name) is left out.
std::vector<std::vector<double>> read_euroc_table(const std::string& file) {
  std::vector<std::vector<double>> rows;
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::vector<double> row;
    std::istringstream fields(line);
    for (std::string field; std::getline(fields, field, ',') && field.find("png") == std::string::npos;)
      row.push_back(std::stod(field));
    rows.push_back(row);
  }
  return rows;
}

/// The pictures of EuRoC, rectified, and its gyroscope in the rectified left camera.
struct EurocWalk {
  std::vector<Frame> frames;
  std::vector<ImuSample> imu;
};

EurocWalk read_euroc(const std::string& folder) {
  const cv::Size size(752, 480);
  const EurocCamera left = read_euroc_camera(folder + "/mav0/cam0");
  const EurocCamera right = read_euroc_camera(folder + "/mav0/cam1");
  const Eigen::Matrix4d right_from_left = right.body_from_camera.inverse() * left.body_from_camera;
  cv::Matx33d rotation;
  for (int i = 0; i < 9; ++i) rotation.val[i] = right_from_left(i / 3, i % 3);
  const cv::Vec3d translation(right_from_left(0, 3), right_from_left(1, 3), right_from_left(2, 3));
  cv::Matx33d r1;
  cv::Matx33d r2;
  cv::Matx34d p1;
  cv::Matx34d p2;
  cv::Matx44d q;
  cv::stereoRectify(left.matrix, left.distortion, right.matrix, right.distortion, size, rotation, translation, r1, r2, p1, p2,
                    q, cv::CALIB_ZERO_DISPARITY, 0.0);
  const StereoCamera camera{p1(0, 0), p1(0, 2), p1(1, 2), -p2(0, 3) / p2(0, 0)};
  EurocWalk walk;
  const auto rows = read_euroc_table(folder + "/mav0/cam0/data.csv");
  const double start = rows.front()[0];
  for (const auto& row : rows) {
    const auto read = [&](const char* eye, const EurocCamera& raw, const cv::Matx33d& turn, const cv::Matx34d& projection) {
      cv::Mat map_u;
      cv::Mat map_v;
      cv::initUndistortRectifyMap(raw.matrix, raw.distortion, turn, projection, size, CV_32FC1, map_u, map_v);
      const std::string file = folder + "/mav0/" + eye + "/data/" + std::to_string(static_cast<std::int64_t>(row[0])) + ".png";
      cv::Mat rectified;
      cv::remap(cv::imread(file, cv::IMREAD_GRAYSCALE), rectified, map_u, map_v, cv::INTER_CUBIC);
      return rectified;
    };
    walk.frames.push_back(make_frame(read("cam0", left, r1, p1), read("cam1", right, r2, p2), camera,
                                     static_cast<int>(walk.frames.size()), (row[0] - start) * 1e-9));
  }
  Eigen::Matrix3d rectified_from_left;
  for (int i = 0; i < 9; ++i) rectified_from_left(i / 3, i % 3) = r1.val[i];
  const Eigen::Matrix3d rectified_from_body = rectified_from_left * left.body_from_camera.topLeftCorner<3, 3>().transpose();
  for (const auto& row : read_euroc_table(folder + "/mav0/imu0/data.csv")) {
    walk.imu.push_back(
        {(row[0] - start) * 1e-9, rectified_from_body * Eigen::Vector3d(row[1], row[2], row[3]), Eigen::Vector3d::Zero()});
  }
  return walk;
}

TEST(EgoMotionOnWalks, StandsStillWithEurocAndThenAgreesWithItsGyroscope) {
  BRINK_REQUIRE_DATA(folder, "euroc_standing");
  EurocWalk walk = read_euroc(folder);
  ASSERT_EQ(walk.frames.size(), 10U);
  // At rest the gyroscope reads its bias.
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();
  int readings = 0;
  for (const ImuSample& sample : walk.imu) {
    if (sample.time > walk.frames[5].time) continue;
    bias += sample.angular_rate;
    ++readings;
  }
  for (ImuSample& sample : walk.imu) sample.angular_rate -= bias / readings;

  const Path path = follow(10, [&](int i) { return walk.frames[static_cast<std::size_t>(i)]; });
  for (std::size_t i = 1; i < 10; ++i) {
    const Eigen::Isometry3d motion = path[i].inverse() * path[i - 1];
    if (i <= 5) {
      EXPECT_LE(motion.translation().norm(), 0.0005) << i;
      EXPECT_LE(angle_deg(motion.linear()), 0.01) << i;
    } else {
      const auto turn = integrate_gyroscope(walk.imu, walk.frames[i - 1].time, walk.frames[i].time);
      ASSERT_TRUE(turn);
      EXPECT_LE(angle_deg(motion.linear() * turn->transpose()), 0.02) << i;
    }
  }
}

}  // namespace
}  // namespace brink
