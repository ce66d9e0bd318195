#include "ego_motion/motion.hpp"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

namespace brink {
namespace {

constexpr double kAll = std::numeric_limits<double>::infinity();
const StereoCamera kCamera{350.0, 319.5, 179.5, 0.15};

Eigen::Isometry3d make_motion() {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.linear() = Eigen::AngleAxisd(0.08, Eigen::Vector3d(0.3, 1.0, -0.2).normalized()).toRotationMatrix();
  motion.translation() << 0.05, -0.02, -0.12;
  return motion;
}

std::vector<Eigen::Vector3d> make_points(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) {
    const double z = 4.0 + 2.5 * uniform(random);
    points.emplace_back(0.8 * z * uniform(random), 0.4 * z * uniform(random), z);
  }
  return points;
}

std::vector<Observation> observe(const std::vector<Eigen::Vector3d>& points, const Eigen::Isometry3d& motion) {
  std::vector<Observation> observations;
  observations.reserve(points.size());
  for (const Eigen::Vector3d& point : points) {
    observations.push_back(
        {point, project_stereo(kCamera, motion * point), Eigen::Vector4d::Zero(), Eigen::Matrix4d::Identity()});
  }
  return observations;
}

double difference(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) { return (a.matrix() - b.matrix()).norm(); }

TEST(ProjectStereo, IsTheCamerasProjectionInBothEyes) {
  const Eigen::Vector3d point(0.4, -0.2, 3.0);
  const Eigen::Vector3d pixel = kCamera.project(point);
  EXPECT_TRUE(project_stereo(kCamera, point).isApprox(Eigen::Vector4d(pixel.x(), pixel.y(), pixel.x() - pixel.z(), pixel.y())));
}

TEST(ProjectStereo, HasTheDerivativeThatDifferencesTell) {
  const Eigen::Vector3d point(0.4, -0.2, 3.0);
  const auto jacobian = project_stereo_jacobian(kCamera, point);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(i);
    const Eigen::Vector4d slope = (project_stereo(kCamera, point + step) - project_stereo(kCamera, point - step)) / (2 * kStep);
    EXPECT_TRUE(jacobian.col(i).isApprox(slope, 1e-6)) << i;
  }
}

TEST(FitMotion, RecoversAnExactMotionFromExactPoints) {
  for (const int count : {3, 8, 200}) {
    const auto fit = fit_motion(observe(make_points(count, 3), make_motion()), kCamera, Eigen::Isometry3d::Identity(), kAll);
    ASSERT_TRUE(fit) << count;
    EXPECT_LT(difference(fit->current_from_previous, make_motion()), 1e-6) << count;
  }
}

TEST(FitMotion, IsEmptyWhenThePointsDoNotTellAllSixUnknowns) {
  EXPECT_FALSE(fit_motion({}, kCamera, Eigen::Isometry3d::Identity(), kAll));
  const Eigen::Vector3d point(0.1, 0.2, 3.0);
  EXPECT_FALSE(fit_motion(observe({point, point, point}, make_motion()), kCamera, Eigen::Isometry3d::Identity(), kAll));
  EXPECT_FALSE(fit_motion(observe({-point, -2.0 * point, {1.0, 1.0, -4.0}}, make_motion()), kCamera,
                          Eigen::Isometry3d::Identity(), kAll))
      << "all behind the camera";
}

TEST(FitMotion, FindsTheConstantErrorOfDisparitiesBesideTheMotion) {
  constexpr double kOffset = 0.1;  // px
  std::vector<Observation> observations;
  for (const Eigen::Vector3d& point : make_points(300, 4)) {
    Eigen::Vector4d pixel = project_stereo(kCamera, make_motion() * point);
    pixel[2] += kOffset;  // the right columns of both frames are off by it
    const Eigen::Vector3d seen = kCamera.project(point);
    const Eigen::Vector3d measured = kCamera.triangulate(seen.x(), seen.y(), seen.z() - kOffset);
    const Eigen::Vector4d by_disparity = project_stereo_jacobian(kCamera, make_motion() * measured) *
                                         (make_motion().linear() * measured) / -(seen.z() - kOffset);
    observations.push_back({measured, pixel, by_disparity + Eigen::Vector4d::Unit(2), 20.0 * Eigen::Matrix4d::Identity()});
  }
  const auto fit = fit_motion(observations, kCamera, make_motion(), kAll, 1.0);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->offset, kOffset, 0.01);
  EXPECT_LT(fit->offset_variance, 0.05);
  const auto without = fit_motion(observations, kCamera, make_motion(), kAll);
  ASSERT_TRUE(without);
  EXPECT_EQ(without->offset, 0.0);
  EXPECT_GT(difference(without->current_from_previous, make_motion()),
            4.0 * difference(fit->current_from_previous, make_motion()));
}

/// What the normal equations promise is what repeated trials with that noise show.
TEST(FitMotion, TellsTheCovarianceThatRepeatedNoisyTrialsHave) {
  constexpr int kTrials = 2000;
  constexpr double kNoise = 0.3;  // px
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.0, kNoise);
  auto exact = observe(make_points(40, 6), make_motion());
  for (Observation& observation : exact) observation.sqrt_information /= kNoise;
  Matrix6d scatter = Matrix6d::Zero();
  Matrix6d promised = Matrix6d::Zero();
  for (int trial = 0; trial < kTrials; ++trial) {
    auto observations = exact;
    for (Observation& observation : observations) {
      for (int i = 0; i < 4; ++i) observation.pixel[i] += noise(random);
    }
    const auto fit = fit_motion(observations, kCamera, make_motion(), kAll);
    ASSERT_TRUE(fit);
    const Eigen::AngleAxisd turn(make_motion().linear() * fit->current_from_previous.linear().transpose());
    Vector6d error;
    error << turn.angle() * turn.axis(), make_motion().translation() - fit->current_from_previous.translation();
    scatter += error * error.transpose() / kTrials;
    promised = fit->covariance;
  }
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(scatter(i, i) / promised(i, i), 1.0, 0.12) << i;
  EXPECT_NEAR((promised.inverse() * scatter).trace(), 6.0, 0.4);
}

TEST(FitMotion, IsNotMovedByWhatTheCutoffLeavesOut) {
  auto observations = observe(make_points(60, 7), make_motion());
  for (std::size_t i = 0; i < observations.size(); i += 6) observations[i].pixel[0] += 40.0;
  const auto fit = fit_motion(observations, kCamera, make_motion(), 5.0);
  ASSERT_TRUE(fit);
  EXPECT_LT(difference(fit->current_from_previous, make_motion()), 1e-6);
}

TEST(ComputeSqrtInformation, WhitensPixelNoiseAndDepthNoiseTogether) {
  const Eigen::Vector4d by_disparity(0.2, 0.1, -0.9, 0.1);
  const Eigen::Matrix4d covariance = 0.04 * Eigen::Matrix4d::Identity() + 0.25 * by_disparity * by_disparity.transpose();
  const Eigen::Matrix4d whitening = compute_sqrt_information(0.04 * Eigen::Matrix4d::Identity(), 0.25, by_disparity);
  EXPECT_TRUE((whitening * covariance * whitening.transpose()).isApprox(Eigen::Matrix4d::Identity(), 1e-9));
}

TEST(FindMotion, FindsTheMotionAmongSixtyPercentOutliers) {
  auto observations = observe(make_points(150, 8), make_motion());
  std::mt19937 random(9);
  std::uniform_real_distribution<double> anywhere(-60.0, 60.0);
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (i % 5 < 3)
      observations[i].pixel += Eigen::Vector4d(anywhere(random), anywhere(random), anywhere(random), anywhere(random));
  }
  const auto motion = find_motion(observations, kCamera, Eigen::Isometry3d::Identity(), {});
  ASSERT_TRUE(motion);
  EXPECT_LT(difference(*motion, make_motion()), 1e-3);
  const auto inliers = find_inliers(observations, kCamera, *motion, 1.0);
  EXPECT_NEAR(static_cast<double>(inliers.size()), 60.0, 1.0);
}

TEST(FindMotion, DependsOnTheSeedOnly) {
  auto observations = observe(make_points(50, 8), make_motion());
  for (std::size_t i = 0; i < observations.size(); i += 2) observations[i].pixel[1] += 0.7;
  const auto motion = find_motion(observations, kCamera, Eigen::Isometry3d::Identity(), {});
  const auto again = find_motion(observations, kCamera, Eigen::Isometry3d::Identity(), {});
  ASSERT_TRUE(motion && again);
  EXPECT_EQ(motion->matrix(), again->matrix());
}

TEST(FindMotion, IsEmptyWithFewerThanThreePoints) {
  EXPECT_FALSE(find_motion({}, kCamera, Eigen::Isometry3d::Identity(), {}));
  EXPECT_FALSE(find_motion(observe(make_points(2, 1), make_motion()), kCamera, Eigen::Isometry3d::Identity(), {}));
}

}  // namespace
}  // namespace brink
