#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "brink/ground_tracking.hpp"
#include "ground/assess.hpp"
#include "ground/first_ground.hpp"
#include "ground/footing.hpp"
#include "ground/plane_search.hpp"

namespace brink {
namespace {

constexpr double kRadians = std::numbers::pi / 180.0;
constexpr double kRollReachDeg = 7.5;     // around the last roll: heads roll no faster from frame to frame
constexpr double kMaxTiltDeg = 20.0;      // between one ground and the next: from a ramp up to a ramp down
constexpr double kUnevenDeg = 1.5;        // that a walking surface is tilted against its plane
constexpr double kNearShare = 0.7;        // of what is near the feet that lies on a ground that is tilted by more
constexpr double kUnevenness = 0.05;      // m that a walking surface departs from its plane
constexpr double kMeasuredSd = 0.01;      // m of the height of a ground that this frame shows
constexpr double kMotionSd = 0.002;       // m that a measured motion adds to it
constexpr double kBlindSd = 0.03;         // m that an unknown motion adds: gait
constexpr double kMeasuredTiltDeg = 0.3;  // standard deviations of the tilt, likewise
constexpr double kMotionTiltDeg = 0.05;
constexpr double kGravityTiltDeg = 0.5;  // where only gravity, or a gyroscope, is known
constexpr double kBlindTiltDeg = 3.0;    // where nothing is known
constexpr double kMaxSd = 0.15;          // m: a ground known no better is not known
constexpr double kStep = 0.15;           // m: surfaces this far apart are different floors, and so high is a negative obstacle
constexpr double kGait = 0.08;           // m by which walking changes the camera's height, and more
constexpr double kMinShare = 0.02;       // of all samples of a frame that must lie on a ground that it is said to show
constexpr double kExplained = 0.95;   // of the score of the last ground on what lies on it, that another plane must have there
constexpr double kPriorShare = 0.05;  // what is known of the ground before a frame weighs as much as this share of its samples
constexpr double kLearnStanding = 1.0;   // s in which the standing height is learned ...
constexpr double kAdaptStanding = 20.0;  // s in which it adapts
constexpr double kOnAir = 0.5;           // m walked over a surface that is not the ground: the ground was wrong
constexpr double kSettled = 0.5;         // m walked on a ground that was doubtful at first

GroundPose make_pose(const Eigen::Vector3d& down, double height_m, const StereoCamera& camera) {
  GroundPose pose;
  pose.down = down;
  pose.height_m = height_m;
  return compute_ground_pose(make_ground_plane(pose, camera), camera);
}

double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::acos(std::clamp(a.dot(b), -1.0, 1.0)) / kRadians;
}

}  // namespace

struct GroundTracker::State {
  explicit State(const GroundParams& given) : params(given) {}

  GroundParams params;

  // Of this frame.
  cv::Mat1f disparity;
  GroundSamples samples;
  std::optional<Eigen::Vector3d> gravity;
  std::vector<PlaneHypothesis> planes;

  // Of the frames before.
  std::optional<GroundPose> ground;
  double sd_m = 0.0;         ///< of its height
  double tilt_sd_deg = 0.0;  ///< of its normal
  double residual_px = 0.0;  ///< of the last frame that showed it
  double shown_time = 0.0;   ///< s, of that frame
  std::optional<double> standing_m;
  double standing_s = 0.0;  ///< for which it has been learned
  Footing footing;
  double on_air_m = 0.0;    ///< walked over a surface that is not the ground
  std::string doubt;        ///< of FirstGround, until the bearer has walked on that ground
  double doubtful_m = 0.0;  ///< walked since
  std::optional<Eigen::Vector3d> last_gravity;
  std::optional<double> last_time;

  /// A ground that this frame may show.
  struct Choice {
    GroundPlane plane;
    GroundPose pose;
    PlaneCounts counts;
    double confidence = 0.0;
    bool is_shown = false;  ///< enough of the frame lies on it
  };

  [[nodiscard]] Plausibility plausibility() const { return {samples.camera, params, gravity}; }
  void predict(const MotionHint& motion);
  GroundEstimate start(double time);
  GroundEstimate follow(double time);
  [[nodiscard]] Choice judge(const GroundPlane& plane) const;
  [[nodiscard]] bool goes_on(const GroundPlane& plane) const;
  [[nodiscard]] std::optional<Choice> find_continuation() const;
  [[nodiscard]] std::optional<Choice> find_floor_at_standing_height() const;
  GroundEstimate show(const Choice& choice, double time);
  GroundEstimate carry(double time, const std::string& why);
  std::optional<double> step_onto_footing();
  void learn(double height_m, double time);
  void forget();
};

GroundTracker::GroundTracker(const GroundParams& params) : state_(std::make_unique<State>(params)) { params.validate(); }
GroundTracker::~GroundTracker() = default;
GroundTracker::GroundTracker(GroundTracker&&) noexcept = default;
GroundTracker& GroundTracker::operator=(GroundTracker&&) noexcept = default;

std::optional<double> GroundTracker::standing_height_m() const { return state_->standing_m; }

void GroundTracker::search(const cv::Mat1f& disparity, const StereoCamera& camera,
                           const std::optional<Eigen::Vector3d>& gravity) {
  camera.validate();
  check_gravity(gravity);
  State& state = *state_;
  state.disparity = disparity;
  state.gravity = gravity;
  if (gravity) state.gravity = gravity->normalized();
  state.samples = take_ground_samples(disparity, camera, state.params);
  state.planes.clear();
  if (state.samples.all.size() < kMinGroundSamples) return;
  RollRange rolls{-state.params.max_roll_deg, state.params.max_roll_deg};
  if (state.ground) {
    rolls.min_deg = std::max(rolls.min_deg, state.ground->roll_deg - kRollReachDeg);
    rolls.max_deg = std::min(rolls.max_deg, state.ground->roll_deg + kRollReachDeg);
  }
  state.planes = search_planes(state.samples, state.plausibility(), rolls, state.params);
}

GroundEstimate GroundTracker::update(const MotionHint& motion, double time) {
  State& state = *state_;
  state.predict(motion);
  GroundEstimate estimate;
  if (!state.ground) {
    estimate = state.start(time);
  } else if (state.samples.all.size() < kMinGroundSamples) {
    estimate = state.carry(time, make_ground_without_samples(state.samples, state.params).reason);
  } else {
    estimate = state.follow(time);
  }
  if (state.footing.is_started()) state.footing.add(state.samples);
  state.last_gravity = state.gravity;
  state.last_time = time;
  return estimate;
}

/// Moves what is known of the ground into this frame.
void GroundTracker::State::predict(const MotionHint& motion) {
  if (!ground) return;
  if (motion.current_from_previous) {
    const Eigen::Isometry3d& move = *motion.current_from_previous;
    const Eigen::Vector3d foot = move * Eigen::Vector3d(ground->height_m * ground->down);
    const Eigen::Vector3d down = (move.linear() * ground->down).normalized();
    constexpr double kMaxHeight = 100.0;  // m: given poses may be wrong by any factor
    if (!(down.dot(foot) > 0.01 && down.dot(foot) < kMaxHeight) || !down.allFinite() || !move.matrix().allFinite()) {
      return forget();  // the camera would be under it, or out of sight of it
    }
    ground = make_pose(down, down.dot(foot), samples.camera);
    sd_m = std::hypot(sd_m, kMotionSd);
    tilt_sd_deg = std::hypot(tilt_sd_deg, kMotionTiltDeg);
    footing.move(move);
    const Eigen::Vector3d shift = move.translation() - down.dot(move.translation()) * down;
    on_air_m += shift.norm();
    doubtful_m += shift.norm();
    return;
  }
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  if (motion.current_from_previous_rotation) {
    rotation = *motion.current_from_previous_rotation;
  } else if (gravity && last_gravity) {
    rotation = Eigen::Quaterniond::FromTwoVectors(*last_gravity, *gravity).toRotationMatrix();
  }
  const bool is_turn_known = motion.current_from_previous_rotation || (gravity && last_gravity);
  ground = make_pose((rotation * ground->down).normalized(), ground->height_m, samples.camera);
  sd_m = std::hypot(sd_m, kBlindSd);
  tilt_sd_deg = std::hypot(tilt_sd_deg, is_turn_known ? kGravityTiltDeg : kBlindTiltDeg);
  footing.start(*ground);  // where the bearer is among the places that he saw is not known any more
}

GroundEstimate GroundTracker::State::start(double time) {
  if (samples.all.size() < kMinGroundSamples) return make_ground_without_samples(samples, params);
  const FirstGround first = choose_first_ground(samples, planes, plausibility(), params, gravity, standing_m);
  if (!first.plane) return make_invisible_ground(first.reason);
  GroundEstimate estimate = assess_plane(*first.plane, disparity, samples, params);
  if (!estimate.plane && !first.doubt.empty()) {  // a near strip of ground: too few pixels of all, but those at the feet
    estimate.plane = first.plane;
    estimate.confidence = params.uncertain_confidence;
  }
  if (!estimate.plane) return estimate;
  doubt = first.doubt;
  doubtful_m = 0.0;
  on_air_m = 0.0;
  sd_m = 2.0 * kMeasuredSd;
  tilt_sd_deg = 2.0 * kMeasuredTiltDeg;
  ground = estimate.pose;
  residual_px = estimate.residual_px;
  shown_time = time;
  footing.start(*ground);
  if (!doubt.empty()) {
    estimate.state = GroundState::uncertain;
    estimate.reason = doubt;
  } else {
    learn(ground->height_m, time);
  }
  return estimate;
}

GroundEstimate GroundTracker::State::follow(double time) {
  std::optional<Choice> choice = find_continuation();
  if (!choice || !choice->is_shown) {
    if (std::optional<Choice> floor = find_floor_at_standing_height()) choice = std::move(floor);
  }
  GroundEstimate estimate;
  if (choice && choice->is_shown) {
    estimate = show(*choice, time);
  } else {
    estimate =
        carry(time, fmt::format("the ground underfoot is not in this image: carried on for {:.1f} s", time - shown_time));
  }
  if (const std::optional<double> height = step_onto_footing()) {
    ground = make_pose(ground->down, *height, samples.camera);
    estimate = carry(time, fmt::format("the surface underfoot changed to one {:.2f} m below the camera", *height));
  }
  return estimate;
}

GroundTracker::State::Choice GroundTracker::State::judge(const GroundPlane& plane) const {
  Choice choice;
  choice.plane = plane;
  choice.pose = compute_ground_pose(plane, samples.camera);
  choice.counts = count_pixels(plane, disparity, samples, params);
  const auto on = static_cast<double>(choice.counts.level);
  const auto all = static_cast<double>(samples.size.area()) / (samples.step * samples.step);
  // Where the view goes through the plane, the ground ends; that says nothing against it.
  const double expected = static_cast<double>(choice.counts.expected) - static_cast<double>(choice.counts.below);
  choice.confidence = on > 0.0 ? std::min(1.0, on / std::max(expected, on) / kFullCoverage) : 0.0;
  choice.is_shown = on >= kMinShare * all && choice.confidence >= params.uncertain_confidence;
  return choice;
}

/// Whether a plane can be the ground that was moved into this frame: nearly at its height under the feet, not farther from the
/// standing height than the motion explains, and tilted against it only where nearly all that is near the feet lies on it, as
/// on a ramp.
bool GroundTracker::State::goes_on(const GroundPlane& plane) const {
  if (!plausibility()(plane)) return false;
  const GroundPose pose = compute_ground_pose(plane, samples.camera);
  const double change = std::abs(pose.height_m - ground->height_m);
  const double tilt_deg = angle_deg(pose.down, ground->down);
  if (change > kUnevenness + 3.0 * sd_m || tilt_deg > kMaxTiltDeg) return false;
  const double off_before = standing_m ? std::abs(ground->height_m - *standing_m) : 0.0;
  if (standing_m && std::abs(pose.height_m - *standing_m) > std::max(kStep, off_before + kUnevenness)) return false;
  return tilt_deg <= kUnevenDeg + 3.0 * tilt_sd_deg ||
         score_near(samples, plane, params) >= kNearShare * score_near(samples, std::nullopt, params);
}

/// The ground of the last frame as this one shows it: the best plane of this frame that goes on from it, or the last ground
/// itself, refined on what lies on it, where that is seen and the other one does not explain it. Far more pixels may lie on a
/// plane *between* two floors.
std::optional<GroundTracker::State::Choice> GroundTracker::State::find_continuation() const {
  std::optional<PlaneHypothesis> free;
  for (const PlaneHypothesis& plane : planes) {
    if ((!free || plane.score > free->score) && goes_on(plane.plane)) free = plane;
  }
  if (free) free->plane = finish_plane(samples, free->plane, params);
  if (free && !goes_on(free->plane)) free.reset();

  const GroundPlane last = make_ground_plane(*ground, samples.camera);
  const double all = static_cast<double>(samples.size.area()) / (samples.step * samples.step);
  const double widen = sd_m > 2.0 * kMeasuredSd ? 3.0 : 1.0;
  const GroundPlane refined = refine_plane(samples.all, last, samples, 6, widen, params, PlanePrior{last, kPriorShare * all});
  const bool is_refined = goes_on(refined);
  std::optional<Choice> choice;
  if (free) choice = judge(free->plane);
  // What is tilted against the ground before must be seen well: a plane through the edges of steps is not.
  const double tilt_deg = choice ? angle_deg(choice->pose.down, ground->down) : 0.0;
  if (choice && tilt_deg > kUnevenDeg + 3.0 * tilt_sd_deg && choice->confidence < params.seen_confidence) {
    choice.reset();
    free.reset();
  }
  const bool is_exact = tilt_sd_deg < kUnevenDeg;  // else the last ground is a start for the refinement, no more
  const auto explains = [&](const GroundPlane& plane) {
    return !is_exact ||
           score_near(samples, plane, params, refined) >= kExplained * score_near(samples, refined, params, refined);
  };
  if (is_refined && (!choice || !choice->is_shown || !explains(choice->plane))) {
    choice = judge(refined);
  }
  return choice;
}

/// When the camera moved away from the last ground, and this frame shows a floor at the standing height instead: the bearer
/// went down, or up, onto it.
std::optional<GroundTracker::State::Choice> GroundTracker::State::find_floor_at_standing_height() const {
  if (!standing_m) return std::nullopt;
  const double left_by = std::abs(ground->height_m - *standing_m);
  std::optional<Choice> best;
  double best_score = 0.0;
  for (const PlaneHypothesis& plane : planes) {
    if (!plausibility()(plane.plane)) continue;
    const GroundPlane finished = finish_plane(samples, plane.plane, params);
    if (!plausibility()(finished)) continue;
    const GroundPose pose = compute_ground_pose(finished, samples.camera);
    const double off = std::abs(pose.height_m - *standing_m);
    if (off > kGait + kUnevenness || off + kUnevenness > left_by) continue;
    if (angle_deg(pose.down, ground->down) > kMaxTiltDeg || plane.score <= best_score) continue;
    // A floor below the last ground may be that before an edge, while the bearer crouches.
    const std::optional<double> underfoot = footing.height_m();
    if (pose.height_m > ground->height_m && underfoot && std::abs(*underfoot - pose.height_m) > kStep) continue;
    Choice choice = judge(finished);
    if (!choice.is_shown) continue;
    best_score = plane.score;
    best = std::move(choice);
  }
  return best;
}

/// What was seen earlier where the feet are now, when it is another floor than the ground: at once where it goes with the
/// standing height, or after some way on it, because then the ground was wrong from the start.
std::optional<double> GroundTracker::State::step_onto_footing() {
  const std::optional<double> underfoot = footing.is_started() ? footing.height_m() : std::nullopt;
  if (!underfoot || !(*underfoot >= params.min_height_m && *underfoot <= params.max_height_m) ||
      std::abs(*underfoot - ground->height_m) <= kStep) {
    on_air_m = 0.0;
    return std::nullopt;
  }
  const bool stands_as_before = standing_m && std::abs(*underfoot - *standing_m) <= kStep &&
                                std::abs(*underfoot - *standing_m) < std::abs(ground->height_m - *standing_m);
  if (!stands_as_before && on_air_m < kOnAir) return std::nullopt;
  if (!stands_as_before) {
    standing_m.reset();
    standing_s = 0.0;
    doubt.clear();
  }
  on_air_m = 0.0;
  sd_m = 3.0 * kMeasuredSd;
  return underfoot;
}

GroundEstimate GroundTracker::State::show(const Choice& choice, double time) {
  ground = choice.pose;
  sd_m = kMeasuredSd;
  tilt_sd_deg = kMeasuredTiltDeg;
  residual_px = choice.counts.residual_px;
  shown_time = time;
  GroundEstimate estimate;
  estimate.plane = choice.plane;
  estimate.pose = choice.pose;
  estimate.confidence = choice.confidence;
  estimate.residual_px = residual_px;
  if (choice.counts.valid > 0) {
    estimate.inlier_ratio = static_cast<double>(choice.counts.on) / static_cast<double>(choice.counts.valid);
  }
  set_state(estimate, params);
  if (!doubt.empty() && doubtful_m > kSettled) doubt.clear();
  if (doubt.empty()) {
    learn(ground->height_m, time);
  } else {
    estimate.state = GroundState::uncertain;
    estimate.reason = doubt;
  }
  return estimate;
}

GroundEstimate GroundTracker::State::carry(double time, const std::string& why) {
  if (sd_m > kMaxSd) {
    forget();
    return start(time);
  }
  GroundEstimate estimate;
  estimate.state = GroundState::uncertain;
  estimate.is_carried = true;
  estimate.reason = why;
  estimate.pose = *ground;
  estimate.plane = make_ground_plane(*ground, samples.camera);
  const double share = 1.0 - sd_m / kMaxSd;
  estimate.confidence = params.uncertain_confidence + share * (params.seen_confidence - params.uncertain_confidence);
  estimate.residual_px = residual_px;
  return estimate;
}

void GroundTracker::State::learn(double height_m, double time) {
  const double seconds = last_time ? time - *last_time : 0.0;
  standing_s += seconds;
  if (!standing_m) {
    standing_m = height_m;
    return;
  }
  const double memory =
      std::clamp(standing_s, kLearnStanding * 0.2, standing_s < kLearnStanding ? kLearnStanding : kAdaptStanding);
  *standing_m += std::min(1.0, seconds / memory) * (height_m - *standing_m);
}

void GroundTracker::State::forget() {
  ground.reset();
  sd_m = 0.0;
  doubt.clear();
}

GroundEstimate find_ground(const cv::Mat1f& disparity, const StereoCamera& camera, const GroundParams& params,
                           const std::optional<Eigen::Vector3d>& gravity) {
  GroundTracker tracker(params);
  tracker.search(disparity, camera, gravity);
  return tracker.update({}, 0.0);
}

}  // namespace brink
