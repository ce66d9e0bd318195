#include "brink/imu.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

#include "brink/pictures.hpp"
#include "brink/sequence.hpp"
#include "expect_error.hpp"
#include "temporary_folder.hpp"

namespace brink {
namespace {

TEST(ReadImu, ReadsSevenNumbersALine) {
  const test::TemporaryFolder folder;
  const auto samples =
      read_imu(folder.add("imu.csv", "t,gx,gy,gz,ax,ay,az\n0,0.1,0.2,0.3,1,-9.8,2\n0.005,0,0,0,0,-9.81,0\n\n"));
  ASSERT_EQ(samples.size(), 2U);
  EXPECT_EQ(samples[0].angular_rate, Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(samples[0].specific_force, Eigen::Vector3d(1.0, -9.8, 2.0));
  EXPECT_EQ(samples[1].time, 0.005);
  EXPECT_TRUE(read_imu(folder.add("empty.csv", "")).empty());
}

TEST(ReadImu, NamesTheLineAtFault) {
  const test::TemporaryFolder folder;
  const auto fault = [&](const std::string& text) {
    const std::string path = folder.add("imu.csv", text);
    return test::error_of<std::runtime_error>([&] { read_imu(path); });
  };
  EXPECT_NE(fault("0,1,2,3,4,5\n").find("imu.csv: line 1 = 0,1,2,3,4,5, expected seven numbers"), std::string::npos);
  EXPECT_NE(fault("0,1,2,3,4,5,6\n1,1,2,nan,4,5,6\n").find("line 2"), std::string::npos);
  EXPECT_NE(fault("0,1,2,3,4,5,6,7\n").find("line 1"), std::string::npos);
  EXPECT_NE(fault("1,0,0,0,0,0,0\n1,0,0,0,0,0,0\n").find("line 2: time 1, expected more"), std::string::npos);
}

/// 200 readings a second of a head that pitches down at an even rate; down is in the y-z plane.
std::vector<ImuSample> pitching_head(double rate_dps, double duration_s) {
  std::vector<ImuSample> samples;
  const double rate = rate_dps * std::numbers::pi / 180.0;
  for (int i = 0; i * 0.005 <= duration_s; ++i) {
    const double pitch = rate * i * 0.005;
    // Looking down turns the picture's down direction from y towards -z; x is to the right, so that is a negative turn about x.
    samples.push_back({i * 0.005, {-rate, 0.0, 0.0}, -kGravity * Eigen::Vector3d(0.0, std::cos(pitch), std::sin(pitch))});
  }
  return samples;
}

TEST(EstimateGravity, FollowsAHeadThatTurns) {
  for (const double rate_dps : {0.0, 40.0}) {
    const auto gravity = estimate_gravity(pitching_head(rate_dps, 1.5), 1.5);
    ASSERT_TRUE(gravity);
    const double pitch_deg = std::atan2(gravity->z(), gravity->y()) * 180.0 / std::numbers::pi;
    EXPECT_NEAR(pitch_deg, rate_dps * 1.5, 0.2);
  }
}

// Who turns a corner at 1.2 m/s is pushed aside by up to 1.9 m/s^2 for a second: 11 degrees in that second.
TEST(EstimateGravity, HoldsThroughATurnOfTheWalk) {
  std::vector<ImuSample> samples = pitching_head(0.0, 4.0);
  for (ImuSample& sample : samples) {
    if (sample.time > 3.0) sample.specific_force.x() += 1.9;
  }
  const auto gravity = estimate_gravity(samples, 4.0);
  ASSERT_TRUE(gravity);
  EXPECT_LT(std::acos(gravity->y()) * 180.0 / std::numbers::pi, 4.0);
}

TEST(EstimateGravity, IsEmptyWhenItCannotBeKnown) {
  EXPECT_FALSE(estimate_gravity({}, 1.0));
  EXPECT_FALSE(estimate_gravity(pitching_head(0.0, 1.0), 0.05)) << "11 readings only";
  EXPECT_FALSE(estimate_gravity(pitching_head(0.0, 1.0), 9.0)) << "readings from long ago";
  auto falling = pitching_head(0.0, 1.0);
  for (ImuSample& sample : falling) sample.specific_force *= 0.5;
  EXPECT_FALSE(estimate_gravity(falling, 1.0));
}

TEST(IntegrateGyroscope, TellsHowDirectionsTurnInTheCamera) {
  constexpr double kRate = 40.0;
  const auto samples = pitching_head(kRate, 1.5);
  // Neither time is that of a reading.
  const auto turn = integrate_gyroscope(samples, 0.2513, 0.7541);
  ASSERT_TRUE(turn);
  const Eigen::AngleAxisd angle(*turn);
  EXPECT_NEAR(angle.angle() * 180.0 / std::numbers::pi, kRate * (0.7541 - 0.2513), 1e-6);
  // What lies straight ahead goes up in the picture when the head pitches down.
  EXPECT_LT((*turn * Eigen::Vector3d::UnitZ()).y(), -0.3);
  // It is the turn that takes gravity from the camera's axes then to its axes now.
  const auto before = estimate_gravity(samples, 1.1);
  const auto after = estimate_gravity(samples, 1.4);
  ASSERT_TRUE(before && after);
  EXPECT_TRUE((*integrate_gyroscope(samples, 1.1, 1.4) * *before).isApprox(*after, 7e-3));
}

TEST(IntegrateGyroscope, IsEmptyUnlessReadingsCoverTheTime) {
  auto samples = pitching_head(10.0, 1.0);
  EXPECT_FALSE(integrate_gyroscope({}, 0.0, 1.0));
  EXPECT_FALSE(integrate_gyroscope(samples, -0.1, 0.5));
  EXPECT_FALSE(integrate_gyroscope(samples, 0.5, 1.1));
  EXPECT_FALSE(integrate_gyroscope(samples, 0.5, 0.5));
  EXPECT_TRUE(integrate_gyroscope(samples, 0.0, 0.995));
  samples.erase(samples.begin() + 40, samples.begin() + 70);
  EXPECT_FALSE(integrate_gyroscope(samples, 0.1, 0.9)) << "a gap of 0.15 s";
  EXPECT_TRUE(integrate_gyroscope(samples, 0.4, 0.9));
}

TEST(OpenSequence, GivesFramesTheTurnOfTheirGyroscope) {
  const test::TemporaryFolder folder;
  const std::string picture = folder.add("picture.png", encode_png(cv::Mat1b(40, 48, uchar{9})));
  const auto samples = pitching_head(20.0, 1.0);
  const Sequence sequence({700.0, 24.0, 20.0, 0.5}, {{0, 0.1, picture, picture}, {1, 0.2, picture, picture}}, samples);
  EXPECT_FALSE(sequence.read(0).frame.current_from_previous_rotation);
  ASSERT_TRUE(sequence.read(1).frame.current_from_previous_rotation);
  EXPECT_TRUE(sequence.read(1).frame.current_from_previous_rotation->isApprox(*integrate_gyroscope(samples, 0.1, 0.2)));
}

TEST(OpenSequence, GivesFramesTheGravityOfTheirImu) {
  const test::TemporaryFolder folder;
  const std::string picture = folder.add("picture.png", encode_png(cv::Mat1b(40, 48, uchar{9})));
  const Sequence sequence({700.0, 24.0, 20.0, 0.5}, {{0, 1.0, picture, picture}}, pitching_head(0.0, 1.0));
  ASSERT_TRUE(sequence.read(0).frame.gravity);
  EXPECT_TRUE(sequence.read(0).frame.gravity->isApprox(Eigen::Vector3d::UnitY()));
}

}  // namespace
}  // namespace brink
