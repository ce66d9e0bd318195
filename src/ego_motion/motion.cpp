#include "ego_motion/motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "ego_motion/normal_equations_simd.hpp"

namespace brink {
namespace {

constexpr int kMaxIterations = 100;
constexpr double kConverged = 1e-2;        // standard deviations: a step this short changes nothing that can be told
constexpr double kLeastDepth = 0.01;       // m: nearer points are not in view
constexpr double kLeastEigenvalue = 1e-6;  // of the normal equations, 1/rad^2 and 1/m^2: 1 km and many turns of uncertainty

double tukey_weight(double error, double cutoff) {
  if (error >= cutoff) return 0.0;
  const double ratio = error / cutoff;
  const double root = 1.0 - ratio * ratio;
  return root * root;
}

/// Six unknowns of the motion and the constant error of disparities.
using Matrix7d = Eigen::Matrix<double, 7, 7>;
using Vector7d = Eigen::Matrix<double, 7, 1>;

struct NormalEquations {
  Matrix7d hessian = Matrix7d::Zero();  ///< lower triangle
  Vector7d gradient = Vector7d::Zero();
};

/// @param turned the point, turned as the camera did, but not moved. @param point the point in front of the camera now.
/// @param residual px.
LinearObservation linearise(const Observation& observation, const StereoCamera& camera, const Eigen::Vector3d& turned,
                            const Eigen::Vector3d& point, const Eigen::Vector4d& residual, double weight) {
  // By (w, t), a small turn and shift: the derivative by the point times (-[turned]x, 1).
  const Eigen::Matrix<double, 4, 3> by_point = project_stereo_jacobian(camera, point);
  const auto along_row = [&](int i) -> std::array<double, kEquationColumns> {
    const double by_x = by_point(i, 0);
    const double by_z = by_point(i, 2);
    return {residual[i], by_z * turned.y(),       by_x * turned.z() + by_z * -turned.x(), by_x * -turned.y(), by_x, 0.0,
            by_z,        observation.by_offset[i]};
  };
  const auto down_column = [&](int i) -> std::array<double, kEquationColumns> {
    const double by_y = by_point(i, 1);
    const double by_z = by_point(i, 2);
    return {residual[i],
            by_y * -turned.z() + by_z * turned.y(),
            by_z * -turned.x(),
            by_y * turned.x(),
            0.0,
            by_y,
            by_z,
            observation.by_offset[i]};
  };
  return {observation.sqrt_information.data(), {along_row(0), down_column(1), along_row(2), down_column(3)}, weight};
}

NormalEquations make_normal_equations(const std::vector<Observation>& observations, const StereoCamera& camera,
                                      const MotionFit& fit, double cutoff) {
  EquationSums sums{};
  std::array<LinearObservation, 16> some;
  std::size_t count = 0;
  for (const Observation& observation : observations) {
    const Eigen::Vector3d turned = fit.current_from_previous.linear() * observation.point;
    const Eigen::Vector3d point = turned + fit.current_from_previous.translation();
    if (point.z() < kLeastDepth) continue;
    const Eigen::Vector4d residual = observation.pixel - project_stereo(camera, point) - fit.offset * observation.by_offset;
    const double weight = tukey_weight((observation.sqrt_information * residual).norm(), cutoff);
    if (weight <= 0.0) continue;
    some[count++] = linearise(observation, camera, turned, point, residual, weight);
    if (count < some.size()) continue;
    sums = add_observations(some.data(), count, sums);
    count = 0;
  }
  sums = add_observations(some.data(), count, sums);
  NormalEquations equations;
  for (int i = 0; i < 7; ++i) {
    const auto& row = sums[static_cast<std::size_t>(i) + 1];
    equations.gradient[i] = row[0];
    for (int j = 0; j <= i; ++j) equations.hessian(i, j) = row[static_cast<std::size_t>(j) + 1];
  }
  return equations;
}

/// What is known of the constant error beforehand. Known to be none, it is left out.
void add_prior(NormalEquations& equations, double offset, double variance) {
  if (variance > 0.0) {
    equations.hessian(6, 6) += 1.0 / variance;
    equations.gradient[6] -= offset / variance;
  } else {
    equations.hessian.row(6).setZero();
    equations.hessian(6, 6) = 1.0;
    equations.gradient[6] = 0.0;
  }
}

Eigen::Matrix3d rotation_of(const Eigen::Vector3d& vector) {
  return Eigen::AngleAxisd(vector.norm(), vector.stableNormalized()).toRotationMatrix();
}

/// Truncated sum of squares: an inlier counts by how well it fits, an outlier by the limit. Summed up to `enough` only.
double compute_ransac_cost(const std::vector<Observation>& observations, const StereoCamera& camera,
                           const Eigen::Isometry3d& motion, double limit, double enough, int& inliers) {
  double cost = 0.0;
  inliers = 0;
  for (const Observation& observation : observations) {
    if (cost >= enough) break;
    const double error = compute_error(observation, camera, motion);
    inliers += error < limit ? 1 : 0;
    cost += std::min(error * error, limit * limit);
  }
  return cost;
}

/// Samples after which three inliers were drawn together with a probability of 99.9 %.
int enough_samples(int inliers, std::size_t count) {
  const double share = static_cast<double>(inliers) / static_cast<double>(count);
  const double all_good = share * share * share;
  if (all_good > 0.999) return 1;
  const double needed = std::log(0.001) / std::log1p(-std::max(all_good, 1e-9));
  return static_cast<int>(std::min(std::ceil(needed), 1e6));
}

}  // namespace

Eigen::Vector4d project_stereo(const StereoCamera& camera, const Eigen::Vector3d& point) {
  const double scale = camera.focal / point.z();
  const double u = scale * point.x() + camera.cx;
  const double v = scale * point.y() + camera.cy;
  return {u, v, u - scale * camera.baseline, v};
}

Eigen::Matrix<double, 4, 3> project_stereo_jacobian(const StereoCamera& camera, const Eigen::Vector3d& point) {
  const double scale = camera.focal / point.z();
  const double x = point.x() / point.z();
  const double y = point.y() / point.z();
  const double right_x = (point.x() - camera.baseline) / point.z();
  Eigen::Matrix<double, 4, 3> jacobian;
  jacobian << scale, 0, -scale * x, 0, scale, -scale * y, scale, 0, -scale * right_x, 0, scale, -scale * y;
  return jacobian;
}

Eigen::Matrix4d compute_sqrt_information(const Eigen::Matrix4d& pixel_covariance, double disparity_variance,
                                         const Eigen::Vector4d& by_disparity) {
  const Eigen::Matrix4d covariance = pixel_covariance + disparity_variance * by_disparity * by_disparity.transpose();
  // covariance = L L^T, so L^-1 residual has unit covariance.
  return covariance.llt().matrixL().solve(Eigen::Matrix4d::Identity());
}

double compute_error(const Observation& observation, const StereoCamera& camera,
                     const Eigen::Isometry3d& current_from_previous) {
  const Eigen::Vector3d point = current_from_previous * observation.point;
  if (point.z() < kLeastDepth) return std::numeric_limits<double>::infinity();
  return (observation.sqrt_information * (observation.pixel - project_stereo(camera, point))).norm();
}

std::optional<MotionFit> fit_motion(const std::vector<Observation>& observations, const StereoCamera& camera,
                                    const Eigen::Isometry3d& initial, double cutoff, double offset_variance) {
  MotionFit fit{initial, Matrix6d::Zero(), 0.0, offset_variance};
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    NormalEquations equations = make_normal_equations(observations, camera, fit, cutoff);
    add_prior(equations, fit.offset, offset_variance);
    const Eigen::LDLT<Matrix7d> solver(equations.hessian);
    if (solver.info() != Eigen::Success || solver.vectorD().minCoeff() < kLeastEigenvalue) return std::nullopt;
    const Vector7d step = solver.solve(equations.gradient);
    if (!step.allFinite()) return std::nullopt;
    fit.current_from_previous.linear() = rotation_of(step.head<3>()) * fit.current_from_previous.linear();
    fit.current_from_previous.translation() += step.segment<3>(3);
    fit.offset += step[6];
    if (step.dot(equations.gradient) < kConverged * kConverged) {
      const Matrix7d covariance = solver.solve(Matrix7d::Identity());
      fit.covariance = covariance.topLeftCorner<6, 6>();
      fit.offset_variance = offset_variance > 0.0 ? covariance(6, 6) : 0.0;
      return fit;
    }
  }
  return std::nullopt;
}

std::vector<int> find_inliers(const std::vector<Observation>& observations, const StereoCamera& camera,
                              const Eigen::Isometry3d& current_from_previous, double limit) {
  std::vector<int> inliers;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (compute_error(observations[i], camera, current_from_previous) < limit) inliers.push_back(static_cast<int>(i));
  }
  return inliers;
}

std::optional<Eigen::Isometry3d> find_motion(const std::vector<Observation>& observations, const StereoCamera& camera,
                                             const Eigen::Isometry3d& initial, const EgoMotionParams& params) {
  const std::size_t count = observations.size();
  if (count < 3) return std::nullopt;
  std::mt19937 random(static_cast<unsigned>(params.seed));
  std::optional<Eigen::Isometry3d> best;
  double best_cost = std::numeric_limits<double>::infinity();
  int enough = params.ransac_iterations;
  for (int iteration = 0; iteration < std::min(enough, params.ransac_iterations); ++iteration) {
    const std::size_t a = random() % count;
    const std::size_t b = random() % count;
    const std::size_t c = random() % count;
    if (a == b || b == c || c == a) continue;
    const auto fit = fit_motion({observations[a], observations[b], observations[c]}, camera, initial,
                                std::numeric_limits<double>::infinity());
    if (!fit) continue;
    int inliers = 0;
    const double cost =
        compute_ransac_cost(observations, camera, fit->current_from_previous, params.inlier_sigmas, best_cost, inliers);
    if (cost >= best_cost) continue;
    best_cost = cost;
    best = fit->current_from_previous;
    enough = enough_samples(inliers, count);
  }
  return best;
}

}  // namespace brink
