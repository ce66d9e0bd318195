#include "brink/ego_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "ego_motion/bucketing.hpp"
#include "ego_motion/features.hpp"
#include "ego_motion/kalman.hpp"
#include "ego_motion/local_map.hpp"
#include "ego_motion/matching.hpp"
#include "ego_motion/motion.hpp"
#include "ego_motion/outlier_removal.hpp"

namespace brink {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kTukeyCutoff = 4.685;   // standard deviations: 95 % efficiency on Gaussian noise
constexpr double kScaleShare = 0.3;      // the scale of errors is told by this share of the points: the rest may be outliers
constexpr double kScaleError3 = 1.1932;  // that share of unit Gaussian errors is shorter in three dimensions ...
constexpr double kScaleError4 = 1.4815;  // ... and in four
constexpr double kOffsetWander = 0.005;  // px: by which the constant error of disparities is less certain each frame
constexpr double kLeastMatchDisparity = 0.5;  // px: less tells nothing about depth at the accuracy of features

/// What is kept of a frame: all that the next one is compared with.
struct View {
  int index = 0;
  double time = 0.0;
  StereoCamera camera;
  cv::Mat1b left;
  cv::Mat1b right;
  StereoFeatures features;
  SmoothPair smooth;
  [[nodiscard]] bool has_disparity() const { return !smooth.disparity.empty(); }
};

View make_view(const Frame& frame, const EgoMotionParams& params) {
  const std::vector<Feature> left = find_features(frame.left, params);
  const std::vector<Feature> right = find_right_features(frame, left, params);
  return {frame.index,
          frame.time,
          frame.camera,
          frame.left,
          frame.right,
          {FeatureIndex(left, frame.size()), FeatureIndex(right, frame.size())},
          make_smooth_pair(frame)};
}

/// A motion, or why there is none.
struct Attempt {
  std::optional<MotionFit> fit;
  std::string reason;
  int matches = 0;
  int inliers = 0;
};

bool are_equal(const cv::Mat1b& a, const cv::Mat1b& b) {
  for (int v = 0; v < a.rows; ++v) {
    if (!std::equal(a[v], a[v] + a.cols, b[v])) return false;
  }
  return true;
}

bool are_equal(const StereoCamera& a, const StereoCamera& b) {
  return a.focal == b.focal && a.cx == b.cx && a.cy == b.cy && a.baseline == b.baseline;
}

/// Why these two frames cannot be compared at all; empty when they can.
std::string find_fault(const View& previous, const View& current, const EgoMotionParams& params) {
  if (previous.left.size() != current.left.size()) return "the size of the pictures changed";
  if (!are_equal(previous.camera, current.camera)) return "the camera changed";
  if (previous.has_disparity() != current.has_disparity()) return "disparities are given for one of the frames only";
  const std::array<std::pair<const char*, const FeatureIndex*>, 2> eyes = {
      {{"left", &current.features.left}, {"right", &current.features.right}}};
  for (const auto& [name, features] : eyes) {
    if (features->size() >= params.min_inliers) continue;
    if (current.has_disparity() && features == &current.features.right)
      return fmt::format("the disparity image tells too little: {} features have a disparity", features->size());
    return fmt::format("the {} picture has no texture: {} features", name, features->size());
  }
  if (current.has_disparity()) return {};
  // Two pictures of a sensor are never equal to the last bit, unless one of them is old.
  const bool left_stands = are_equal(previous.left, current.left);
  const bool right_stands = are_equal(previous.right, current.right);
  if (left_stands != right_stands) {
    return fmt::format("the {} picture is frozen: it is that of the last frame", left_stands ? "left" : "right");
  }
  return {};
}

/// Matches as observations of equation 1.
std::vector<Observation> make_observations(const std::vector<CircularMatch>& matches, const StereoCamera& camera,
                                           const Eigen::Isometry3d& predicted, const EgoMotionParams& params) {
  const double variance = params.match_noise_px * params.match_noise_px;
  std::vector<Observation> observations;
  for (const CircularMatch& match : matches) {
    const double disparity = match.previous_left.x - match.previous_right.x;
    if (disparity < kLeastMatchDisparity) continue;
    const Eigen::Vector3d point = camera.triangulate(match.previous_left.x, match.previous_left.y, disparity);
    const Eigen::Vector3d now = predicted * point;
    if (now.z() <= 0.0) continue;
    const Eigen::Vector4d by_disparity = project_stereo_jacobian(camera, now) * (predicted.linear() * point) / -disparity;
    const Eigen::Vector4d pixel(match.current_left.x, match.current_left.y, match.current_right.x, match.current_right.y);
    observations.push_back({point, pixel, Eigen::Vector4d::Zero(),
                            compute_sqrt_information(variance * Eigen::Matrix4d::Identity(), 2.0 * variance, by_disparity)});
  }
  return observations;
}

/// Features, circular matching, outlier removal, bucketing, RANSAC: the motion to about a pixel.
Attempt estimate_roughly(const View& previous, const View& current, const Eigen::Isometry3d& predicted, double search_deg,
                         const EgoMotionParams& params) {
  const double radius = current.camera.focal * std::tan(search_deg * kDegree);
  const auto circles = match_circular(previous.features, current.features, current.camera, predicted, radius, params);
  const auto matches = thin_out(remove_outliers(circles, params), params.bucket_px, params.matches_per_bucket);
  const auto observations = make_observations(matches, current.camera, predicted, params);
  Attempt attempt{std::nullopt, "", static_cast<int>(observations.size()), 0};
  if (attempt.matches < params.min_inliers) {
    attempt.reason = fmt::format("too few matches: {}", attempt.matches);
    return attempt;
  }
  const auto motion = find_motion(observations, current.camera, predicted, params);
  if (!motion) {
    attempt.reason = "no motion agrees with the matches";
    return attempt;
  }
  attempt.inliers = static_cast<int>(find_inliers(observations, current.camera, *motion, params.inlier_sigmas).size());
  if (attempt.inliers < std::max<double>(params.min_inliers, params.min_inlier_ratio * attempt.matches)) {
    attempt.reason = fmt::format("too few inliers: {} of {} matches agree with one motion", attempt.inliers, attempt.matches);
    return attempt;
  }
  attempt.fit = fit_motion(observations, current.camera, *motion, params.inlier_sigmas);
  if (!attempt.fit) attempt.reason = "the motion does not converge";
  return attempt;
}

/// The spread of the errors, robustly, in expected standard deviations.
double estimate_scale(const std::vector<Sighting>& sightings, const View& current, const Eigen::Isometry3d& motion) {
  std::vector<double> errors;
  errors.reserve(sightings.size());
  for (const Sighting& sighting : sightings) errors.push_back(compute_error(sighting.observation, current.camera, motion));
  const auto quantile = errors.begin() + static_cast<std::ptrdiff_t>(kScaleShare * static_cast<double>(errors.size()));
  std::nth_element(errors.begin(), quantile, errors.end());
  return std::max(*quantile / (current.has_disparity() ? kScaleError3 : kScaleError4), 1e-3);
}

/// Robust final fit to the points of the keyframes. @param scale of the errors, told for the inlier limit.
Attempt refine(const std::vector<Sighting>& sightings, const View& current, const Eigen::Isometry3d& rough,
               double offset_variance, const EgoMotionParams& params, double& scale) {
  const StereoCamera& camera = current.camera;
  Attempt attempt{MotionFit{rough, Matrix6d::Zero(), 0.0, offset_variance}, "", static_cast<int>(sightings.size()), 0};
  if (attempt.matches < params.min_inliers)
    return {std::nullopt, fmt::format("too few points found again: {}", attempt.matches), attempt.matches, 0};
  std::vector<Observation> observations;
  observations.reserve(sightings.size());
  for (const Sighting& sighting : sightings) observations.push_back(sighting.observation);
  constexpr int kRounds = 4;  // the scale settles with the motion
  for (int round = 0; round < kRounds; ++round) {
    scale = estimate_scale(sightings, current, attempt.fit->current_from_previous);
    attempt.fit = fit_motion(observations, camera, attempt.fit->current_from_previous, kTukeyCutoff * scale, offset_variance);
    if (!attempt.fit) return {std::nullopt, "the motion does not converge", attempt.matches, 0};
  }
  if (scale > params.max_error_scale) {
    return {std::nullopt,
            fmt::format("the four pictures do not fit one scene: errors are {:.1f} times what is expected", scale),
            attempt.matches, 0};
  }
  attempt.fit->covariance *= scale * scale;
  attempt.inliers = static_cast<int>(
      find_inliers(observations, camera, attempt.fit->current_from_previous, params.inlier_sigmas * scale).size());
  if (attempt.inliers < std::max<double>(params.min_inliers, params.min_inlier_ratio * attempt.matches)) {
    return {std::nullopt,
            fmt::format("too few inliers: {} of {} points agree with one motion", attempt.inliers, attempt.matches),
            attempt.matches, attempt.inliers};
  }
  return attempt;
}

/// Both ends of the motion were measured against the keyframes: the covariance of (w, t) with that of the last frame's place.
/// @param previous of the last frame's place: its own small turns and shifts, in its own axes.
Matrix6d with_previous(const MotionFit& fit, const Matrix6d& previous) {
  // A small turn and shift of the previous frame is turned into the current one; the turn moves it about the new origin.
  Matrix6d by_previous = Matrix6d::Zero();
  by_previous.topLeftCorner<3, 3>() = fit.current_from_previous.linear();
  by_previous.bottomRightCorner<3, 3>() = fit.current_from_previous.linear();
  return fit.covariance + by_previous * previous * by_previous.transpose();
}

/// Covariance of small turns and shifts of the current frame, from that of (w, t).
Matrix6d to_place(const MotionFit& fit) {
  // p -> exp(w) (p - translation) + translation + t: about the origin, the shift is t - w x translation.
  const Eigen::Vector3d& translation = fit.current_from_previous.translation();
  Matrix6d by_motion = Matrix6d::Identity();
  for (int i = 0; i < 3; ++i) by_motion.block<3, 1>(3, i) = -Eigen::Vector3d::Unit(i).cross(translation);
  return by_motion * fit.covariance * by_motion.transpose();
}

double angle_deg(const Eigen::Matrix3d& rotation) { return Eigen::AngleAxisd(rotation).angle() / kDegree; }

double largest_sd(const Eigen::Matrix3d& covariance) {
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff());
}

/// Why a motion is not to be believed; empty when it is.
std::string find_doubt(const MotionFit& fit, const std::optional<Eigen::Matrix3d>& gyroscope, const EgoMotionParams& params) {
  const double rotation_sd = largest_sd(fit.covariance.topLeftCorner<3, 3>()) / kDegree;
  const double translation_sd = largest_sd(fit.covariance.bottomRightCorner<3, 3>());
  if (!(rotation_sd <= params.max_rotation_sd_deg))
    return fmt::format("ambiguous: rotation known to {:.1f} degrees only", rotation_sd);
  if (!(translation_sd <= params.max_translation_sd_m))
    return fmt::format("ambiguous: translation known to {:.2f} m only", translation_sd);
  if (gyroscope) {
    const double off = angle_deg(fit.current_from_previous.linear().transpose() * *gyroscope);
    if (off > params.gyroscope_tolerance_deg) return fmt::format("implausible: {:.1f} degrees off the gyroscope", off);
  }
  return {};
}

}  // namespace

struct EgoMotionEstimator::State {
  explicit State(const EgoMotionParams& given) : params(given), velocity(given) { forget_rectification(); }

  EgoMotionParams params;
  VelocityFilter velocity;
  std::vector<Keyframe> keyframes;
  std::size_t newest_points = 0;  ///< of the newest keyframe, when it was made
  std::optional<View> previous;
  Matrix6d previous_place = Matrix6d::Zero();  ///< covariance of the last frame's place among the keyframes
  double offset = 0.0;                         ///< constant error of all columns in right pictures, px
  double offset_variance = 0.0;                ///< px^2

  [[nodiscard]] Attempt measure(const View& current, const std::optional<Eigen::Matrix3d>& gyroscope);
  [[nodiscard]] Attempt start(const View& current, const std::optional<Eigen::Matrix3d>& gyroscope) const;
  void add_keyframe();
  void forget_rectification();
};

/// The rough motion: searched around the predicted one, then everywhere.
Attempt EgoMotionEstimator::State::start(const View& current, const std::optional<Eigen::Matrix3d>& gyroscope) const {
  std::optional<Eigen::Isometry3d> predicted = velocity.predict(current.time - previous->time);
  if (gyroscope) {
    if (!predicted) predicted = Eigen::Isometry3d::Identity();
    predicted->linear() = *gyroscope;
  }
  if (predicted) {
    Attempt attempt = estimate_roughly(*previous, current, *predicted, params.search_deg, params);
    if (attempt.fit) return attempt;
  }
  return estimate_roughly(*previous, current, Eigen::Isometry3d::Identity(), params.wide_search_deg, params);
}

/// Makes the last frame a keyframe; the one that was seen least makes room.
void EgoMotionEstimator::State::add_keyframe() {
  if (std::ssize(keyframes) >= params.keyframes) {
    keyframes.erase(std::min_element(keyframes.begin(), keyframes.end(),
                                     [](const Keyframe& a, const Keyframe& b) { return a.inliers < b.inliers; }));
  }
  keyframes.push_back(make_keyframe(previous->smooth, previous->features, offset, params));
  newest_points = keyframes.back().points.size();
}

/// Another camera has errors of its own.
void EgoMotionEstimator::State::forget_rectification() {
  offset = 0.0;
  offset_variance = params.disparity_offset_sd_px * params.disparity_offset_sd_px;
}

Attempt EgoMotionEstimator::State::measure(const View& current, const std::optional<Eigen::Matrix3d>& gyroscope) {
  const std::string fault = find_fault(*previous, current, params);
  if (!fault.empty()) return {std::nullopt, fault, 0, 0};

  // Features, circular matching, outlier removal, bucketing, RANSAC.
  Attempt rough = start(current, gyroscope);
  if (!rough.fit) return rough;

  // Sub-pixel refinement against keyframes, Gauss-Newton with weights by expected noise.
  if (keyframes.empty() || keyframes.back().inliers < params.keyframe_overlap * static_cast<double>(newest_points))
    add_keyframe();
  const auto sightings = find_sightings(keyframes, current.smooth, current.camera, rough.fit->current_from_previous, offset);
  double scale = 1.0;
  Attempt fine = refine(sightings, current, rough.fit->current_from_previous, offset_variance, params, scale);
  if (!fine.fit) return fine;
  const Matrix6d place = to_place(*fine.fit);
  fine.fit->covariance = with_previous(*fine.fit, previous_place);
  fine.reason = find_doubt(*fine.fit, gyroscope, params);
  if (!fine.reason.empty()) {
    fine.fit.reset();
    return fine;
  }
  keyframes = move_on(std::move(keyframes), sightings, current.camera, *fine.fit, params.inlier_sigmas * scale);
  previous_place = place;
  offset += fine.fit->offset;
  offset_variance = fine.fit->offset_variance + (offset_variance > 0.0 ? kOffsetWander * kOffsetWander : 0.0);
  return fine;
}

EgoMotionEstimator::EgoMotionEstimator(const EgoMotionParams& params) {
  params.validate();
  state_ = std::make_unique<State>(params);
}
EgoMotionEstimator::~EgoMotionEstimator() = default;
EgoMotionEstimator::EgoMotionEstimator(EgoMotionEstimator&&) noexcept = default;
EgoMotionEstimator& EgoMotionEstimator::operator=(EgoMotionEstimator&&) noexcept = default;

EgoMotionEstimate EgoMotionEstimator::estimate(const Frame& frame) {
  frame.validate();
  if (frame.left.empty()) {
    *this = EgoMotionEstimator(state_->params);  // what it remembers is no longer the last frame
    return {std::nullopt, "no left picture", std::nullopt, 0, 0};
  }
  State& state = *state_;
  View current = make_view(frame, state.params);
  if (!state.previous) {
    state.previous = std::move(current);
    return {std::nullopt, "first frame", std::nullopt, 0, 0};
  }
  const double seconds = current.time - state.previous->time;
  const bool follows = current.index == state.previous->index + 1;  // else the gyroscope tells of another pair of frames
  const Attempt attempt = state.measure(current, follows ? frame.current_from_previous_rotation : std::nullopt);
  if (!are_equal(state.previous->camera, current.camera)) state.forget_rectification();
  state.previous = std::move(current);
  EgoMotionEstimate estimate{std::nullopt, attempt.reason, std::nullopt, attempt.matches, attempt.inliers};
  if (!attempt.fit) {
    state.velocity.reset();
    state.keyframes.clear();
    state.previous_place.setZero();  // it will be a keyframe itself
    return estimate;
  }
  estimate.motion = EgoMotion{attempt.fit->current_from_previous, attempt.fit->covariance};
  if (seconds > 0.0) {
    state.velocity.update(attempt.fit->current_from_previous, attempt.fit->covariance, seconds);
    estimate.velocity = EgoVelocity{state.velocity.velocity().head<3>(), state.velocity.velocity().tail<3>()};
  } else {
    state.velocity.reset();
  }
  return estimate;
}

}  // namespace brink
