#include "ground/first_ground.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <random>

#include <Eigen/LU>
#include <fmt/format.h>

namespace brink {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;

double tolerance_m(const DisparitySample& sample, const GroundPose& pose, const GroundParams& params) {
  return ground_tolerance_px(sample.d, params) * pose.height_m / sample.d;
}

bool is_on(const DisparitySample& sample, const GroundPlane& plane, const GroundSamples& samples, const GroundParams& params) {
  return std::abs(sample.d - plane.disparity(sample.u + samples.camera.cx, sample.v)) <= ground_tolerance_px(sample.d, params);
}

/// A sample in the strip of ground ahead of the feet.
struct StripSample {
  double from_nadir = 0.0;  ///< tangent of the angle between its ray and the ground's normal: small = near the feet
  double elevation_m = 0.0;
  double ahead_m = 0.0;
  double tolerance_m = 0.0;
};

/// What is seen where the bearer would walk straight on, nearest to the feet first.
std::vector<StripSample> select_strip(const GroundSamples& samples, const GroundPose& pose, const GroundParams& params) {
  constexpr double kHalfWidth = 0.3;  // m
  std::vector<StripSample> strip;
  for (const DisparitySample& s : samples.coarse.samples()) {
    const Eigen::Vector3d point = samples.camera.triangulate(s.u + samples.camera.cx, s.v, s.d);
    const double below_camera = pose.down.dot(point);
    if (below_camera <= 0.0 || std::abs(pose.right.dot(point)) > kHalfWidth) continue;
    strip.push_back(
        {pose.distance(point) / below_camera, pose.elevation(point), pose.forward.dot(point), tolerance_m(s, pose, params)});
  }
  std::ranges::sort(strip, {}, &StripSample::from_nadir);
  return strip;
}

/// A level surface above the plane that is nearest to the feet.
struct NearSurface {
  double elevation_m = 0.0;
  double length_m = 0.0;  ///< how far it reaches ahead in the strip
};

/// The surface that most of the nearest samples of the strip lie on, if it is above the plane by more than a step.
std::optional<NearSurface> find_near_surface(const std::vector<StripSample>& strip) {
  constexpr double kNearest = 0.15;  // share of the strip's samples
  constexpr double kMost = 0.6;      // of these
  constexpr double kStep = 0.15;     // m
  constexpr double kBand = 0.05;     // m
  const auto count = static_cast<std::size_t>(kNearest * static_cast<double>(strip.size()));
  if (count < 20) return std::nullopt;
  std::vector<double> elevations;
  for (std::size_t i = 0; i < count; ++i) elevations.push_back(strip[i].elevation_m);
  const auto middle = elevations.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::ranges::nth_element(elevations, middle);
  NearSurface surface{*middle, 0.0};
  const auto lies_on = [&](const StripSample& s) {
    return std::abs(s.elevation_m - surface.elevation_m) <= std::max(kBand, s.tolerance_m);
  };
  if (surface.elevation_m < kStep) return std::nullopt;
  const auto lying = std::count_if(strip.begin(), strip.begin() + static_cast<std::ptrdiff_t>(count), lies_on);
  if (static_cast<double>(lying) < kMost * static_cast<double>(count)) return std::nullopt;
  // It ends where the strip shows something else for longer than a tenth of its samples.
  std::size_t others = 0;
  const double start = strip.front().ahead_m;
  for (const StripSample& s : strip) {
    if (lies_on(s)) {
      surface.length_m = std::max(surface.length_m, s.ahead_m - start);
      others = 0;
    } else if (++others > strip.size() / 10) {
      break;
    }
  }
  return surface;
}

/// The plane of most samples, whatever its height and tilt: three random samples a hypothesis.
GroundPlane find_unconstrained_plane(const GroundSamples& samples, const GroundParams& params) {
  constexpr int kIterations = 300;
  constexpr std::size_t kMaxCounted = 2000;
  const std::vector<DisparitySample>& coarse = samples.coarse.samples();
  const std::size_t every = coarse.size() / kMaxCounted + 1;
  std::mt19937 random(static_cast<std::mt19937::result_type>(params.seed));
  const auto draw = [&]() -> const DisparitySample& { return coarse[random() % coarse.size()]; };
  GroundPlane best;
  int most = 0;
  for (int i = 0; i < kIterations; ++i) {
    Eigen::Matrix3d places;
    Eigen::Vector3d disparities;
    for (int k = 0; k < 3; ++k) {
      const DisparitySample& s = draw();
      places.row(k) << s.u + samples.camera.cx, s.v, 1.0;
      disparities[k] = s.d;
    }
    const Eigen::FullPivLU<Eigen::Matrix3d> solver(places);
    if (!solver.isInvertible()) continue;
    const Eigen::Vector3d plane = solver.solve(disparities);
    const GroundPlane candidate{plane[0], plane[1], plane[2]};
    int count = 0;
    for (std::size_t j = 0; j < coarse.size(); j += every) count += is_on(coarse[j], candidate, samples, params) ? 1 : 0;
    if (count > most) {
      most = count;
      best = candidate;
    }
  }
  return most > 0 ? refine_plane(coarse, best, samples, 8, 2.0, params) : best;
}

/// The limits that a plane breaks: "pitch 88.9 degrees exceeds ground.max_pitch_deg = 80"; empty when there are none.
std::string name_limits(const GroundPose& pose, const GroundParams& params, const std::optional<Eigen::Vector3d>& gravity) {
  std::string text;
  const auto add = [&](bool breaks, const char* what, double value, const char* unit, const char* relation, const char* name,
                       double limit) {
    if (!breaks) return;
    if (!text.empty()) text += ", ";
    text += fmt::format("{} {:.4g}{} {} ground.{} = {}", what, value, unit, relation, name, limit);
  };
  add(pose.height_m < params.min_height_m, "height", pose.height_m, " m", "is below", "min_height_m", params.min_height_m);
  add(pose.height_m > params.max_height_m, "height", pose.height_m, " m", "exceeds", "max_height_m", params.max_height_m);
  add(pose.pitch_deg < params.min_pitch_deg, "pitch", pose.pitch_deg, " degrees", "is below", "min_pitch_deg",
      params.min_pitch_deg);
  add(pose.pitch_deg > params.max_pitch_deg, "pitch", pose.pitch_deg, " degrees", "exceeds", "max_pitch_deg",
      params.max_pitch_deg);
  add(std::abs(pose.roll_deg) > params.max_roll_deg, "roll", pose.roll_deg, " degrees", "exceeds", "max_roll_deg",
      params.max_roll_deg);
  if (gravity) {
    const double tilt_deg = std::acos(std::clamp(pose.down.dot(gravity->normalized()), -1.0, 1.0)) * kDegPerRad;
    add(tilt_deg > params.gravity_tolerance_deg, "tilt against gravity", tilt_deg, " degrees", "exceeds",
        "gravity_tolerance_deg", params.gravity_tolerance_deg);
  }
  return text;
}

/// Shares of the coarse samples.
struct Overlap {
  double on_first = 0.0;
  double on_second = 0.0;
  double on_both = 0.0;
};

Overlap compare_planes(const GroundPlane& first, const GroundPlane& second, const GroundSamples& samples,
                       const GroundParams& params) {
  Overlap overlap;
  const std::vector<DisparitySample>& coarse = samples.coarse.samples();
  const double one = 1.0 / static_cast<double>(coarse.size());
  for (const DisparitySample& s : coarse) {
    const bool on_first = is_on(s, first, samples, params);
    const bool on_second = is_on(s, second, samples, params);
    overlap.on_first += on_first ? one : 0.0;
    overlap.on_second += on_second ? one : 0.0;
    overlap.on_both += on_first && on_second ? one : 0.0;
  }
  return overlap;
}

/// Why a plane is not the ground although it is plausible: it is the unconstrained one, bent to meet a limit.
std::string find_broken_limit(const std::optional<GroundPlane>& plausible_plane, const GroundSamples& samples,
                              const GroundParams& params, const std::optional<Eigen::Vector3d>& gravity) {
  constexpr double kSame = 0.4;      // share of a bent plane's samples that the unconstrained one explains, too
  constexpr double kDominant = 0.5;  // share of all samples that the unconstrained one has
  const GroundPlane unconstrained = find_unconstrained_plane(samples, params);
  if (unconstrained.a == 0.0 && unconstrained.b == 0.0 && unconstrained.c == 0.0) return {};
  const std::string limits = name_limits(compute_ground_pose(unconstrained, samples.camera), params, gravity);
  if (limits.empty()) return {};
  const Overlap overlap = compare_planes(plausible_plane.value_or(unconstrained), unconstrained, samples, params);
  const bool bent = overlap.on_both >= kSame * overlap.on_first && overlap.on_second >= std::max(kDominant, overlap.on_first);
  const bool alone = !plausible_plane && overlap.on_second >= kDominant;
  return (plausible_plane && bent) || alone ? limits : std::string();
}

/// The plane of what is near the feet, where that fits it clearly better than a plane between two floors does; else the same.
GroundPlane prefer_near(const GroundPlane& plane, const GroundSamples& samples, const Plausibility& plausible,
                        const GroundParams& params) {
  constexpr double kNearShare = 0.3;       // of the samples, those with the greatest disparities
  constexpr double kClearlyBetter = 1.05;  // times the score near the feet
  std::vector<DisparitySample> near = samples.coarse.samples();
  const auto count = static_cast<std::ptrdiff_t>(kNearShare * static_cast<double>(near.size()));
  std::ranges::nth_element(near, near.begin() + count, std::greater<>(), &DisparitySample::d);
  near.resize(static_cast<std::size_t>(count));
  const GroundPlane nearer = refine_plane(near, plane, samples, 8, 3.0, params);
  const bool is_better =
      plausible(nearer) && score_near(samples, nearer, params) > kClearlyBetter * score_near(samples, plane, params);
  return is_better ? nearer : plane;
}

GroundPlane shift_up(const GroundPose& pose, double by_m, const StereoCamera& camera) {
  GroundPose shifted = pose;
  shifted.height_m -= by_m;
  return make_ground_plane(shifted, camera);
}

double standing_error(const PlaneHypothesis& hypothesis, const GroundSamples& samples, double standing_height_m) {
  return std::abs(compute_ground_pose(hypothesis.plane, samples.camera).height_m - standing_height_m);
}

}  // namespace

FirstGround choose_first_ground(const GroundSamples& samples, const std::vector<PlaneHypothesis>& planes,
                                const Plausibility& plausible, const GroundParams& params,
                                const std::optional<Eigen::Vector3d>& gravity, const std::optional<double>& standing_height_m) {
  constexpr double kSameHeight = 0.15;  // m: within gait of the standing height
  constexpr double kCertain = 1.5;      // m: what reaches this far ahead of the feet is no table
  constexpr double kParallel = 0.98;    // cosine
  std::optional<PlaneHypothesis> best;
  bool best_fits = false;
  for (const PlaneHypothesis& plane : planes) {
    if (!plausible(plane.plane)) continue;
    const bool fits = standing_height_m && standing_error(plane, samples, *standing_height_m) <= kSameHeight;
    if (!best || (fits && !best_fits) || (fits == best_fits && plane.score > best->score)) {
      best = plane;
      best_fits = fits;
    }
  }
  if (best) best->plane = finish_plane(samples, best->plane, params);
  if (best && !plausible(best->plane)) best.reset();
  if (best) best->plane = prefer_near(best->plane, samples, plausible, params);
  FirstGround ground;
  if (best) ground.plane = best->plane;
  ground.reason = find_broken_limit(ground.plane, samples, params, gravity);
  if (!ground.reason.empty() || !best) {
    if (ground.reason.empty()) ground.reason = "no plane of plausible height and tilt";
    ground.plane.reset();
    return ground;
  }
  if (best_fits) return ground;

  const GroundPose pose = compute_ground_pose(best->plane, samples.camera);
  const std::optional<NearSurface> near = find_near_surface(select_strip(samples, pose, params));
  if (!near || pose.height_m - near->elevation_m < params.min_height_m) return ground;
  const GroundPlane start = shift_up(pose, near->elevation_m, samples.camera);
  const GroundPlane nearer = refine_plane(samples.all, start, samples, 8, 1.0, params);
  if (!plausible(nearer)) return ground;
  const GroundPose nearer_pose = compute_ground_pose(nearer, samples.camera);
  if (nearer_pose.down.dot(pose.down) < kParallel) return ground;
  ground.plane = nearer;
  if (near->length_m < kCertain) {
    ground.doubt = fmt::format("two surfaces may be the ground: one {:.2f} m below the camera, one {:.2f} m",
                               nearer_pose.height_m, pose.height_m);
  }
  return ground;
}

}  // namespace brink
