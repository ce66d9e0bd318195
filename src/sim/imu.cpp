#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "brink/sim/simulate.hpp"
#include "sim/random.hpp"

namespace brink::sim {
namespace {

constexpr double kRadians = std::numbers::pi / 180.0;

void require_within(const char* name, double value, double low, double high) {
  if (value >= low && value <= high) return;
  throw std::invalid_argument(fmt::format("imu.{} = {}, must be {} to {}", name, value, low, high));
}

Eigen::Vector3d normal_vector(Random& random) {
  const double x = random.normal();
  const double y = random.normal();
  return {x, y, random.normal()};
}

// White noise and wandering bias of three axes.
class Disturbance {
 public:
  Disturbance(double density, double bias, const ImuParams& params, Random& random)
      : noise_(density * std::sqrt(params.rate_hz)),
        kept_(std::exp(-1.0 / (params.rate_hz * params.bias_time_s))),
        fresh_(bias * std::sqrt(1.0 - kept_ * kept_)),
        bias_(bias * normal_vector(random)) {}

  Eigen::Vector3d next(Random& random) {
    Eigen::Vector3d now = bias_ + noise_ * normal_vector(random);
    bias_ = kept_ * bias_ + fresh_ * normal_vector(random);
    return now;
  }

 private:
  double noise_;
  double kept_;   // share of the bias that is left after one sample
  double fresh_;  // standard deviation of what is added, so that the bias keeps its own
  Eigen::Vector3d bias_;
};

// By central differences: their error falls with the square of the step, rounding grows with its inverse square.
ImuSample read_exactly(const CameraMotion& world_from_camera, double time) {
  constexpr double kStep = 1e-3;  // s
  const Eigen::Isometry3d before = world_from_camera(time - kStep);
  const Eigen::Isometry3d now = world_from_camera(time);
  const Eigen::Isometry3d after = world_from_camera(time + kStep);
  const Eigen::AngleAxisd turned(Eigen::Matrix3d(before.linear().transpose() * after.linear()));
  const Eigen::Vector3d acceleration = (after.translation() - 2.0 * now.translation() + before.translation()) / (kStep * kStep);
  const Eigen::Vector3d gravity(0.0, 0.0, -kGravity);
  return {time, turned.axis() * (turned.angle() / (2.0 * kStep)), now.linear().transpose() * (acceleration - gravity)};
}

}  // namespace

void ImuParams::validate() const {
  require_within("rate_hz", rate_hz, 1.0, 1e4);
  require_within("gyro_noise_dps", gyro_noise_dps, 0.0, 10.0);
  require_within("gyro_bias_dps", gyro_bias_dps, 0.0, 100.0);
  require_within("accel_noise_mps2", accel_noise_mps2, 0.0, 10.0);
  require_within("accel_bias_mps2", accel_bias_mps2, 0.0, 10.0);
  require_within("bias_time_s", bias_time_s, 1.0, 1e6);
}

std::vector<ImuSample> make_imu(const CameraMotion& world_from_camera, double duration_s, const ImuParams& params,
                                unsigned seed) {
  params.validate();
  require_within("duration_s", duration_s, 0.0, 1e5);
  Random random(seed);
  Disturbance gyroscope(kRadians * params.gyro_noise_dps, kRadians * params.gyro_bias_dps, params, random);
  Disturbance accelerometer(params.accel_noise_mps2, params.accel_bias_mps2, params, random);
  constexpr double kRounding = 1e-6;  // samples
  const int count = static_cast<int>(std::floor(duration_s * params.rate_hz + kRounding)) + 1;
  std::vector<ImuSample> samples;
  samples.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    ImuSample sample = read_exactly(world_from_camera, i / params.rate_hz);
    sample.angular_rate += gyroscope.next(random);
    sample.specific_force += accelerometer.next(random);
    samples.push_back(sample);
  }
  return samples;
}

}  // namespace brink::sim
