#include "brink/envelope.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "brink/disparity.hpp"
#include "brink/frame.hpp"
#include "candidates/depth_wanted.hpp"
#include "disparity/parameters.hpp"
#include "ground/roughness.hpp"

namespace brink {
namespace {

constexpr double kLeastDepth = 0.02;    // m
constexpr double kGreatestDepth = 3.0;  // m
constexpr double kDepthStep = 0.005;    // m
constexpr double kDistanceStep = 0.01;  // m
constexpr double kCoarseStep = 0.25;    // m, of distances: what is seen is seen over more than this
constexpr double kLeastSeen = 1.0;      // px: a disparity below 1 is none

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// How often a polygon's border is crossed on the way from a point on the ground away from the camera, and where first.
struct WayOut {
  bool inside = false;
  double ratio = std::numeric_limits<double>::infinity();  ///< distance there / distance of the point
};

WayOut find_way_out(const Eigen::Vector2d& point, const std::vector<Eigen::Vector2d>& rim) {
  WayOut way;
  for (std::size_t i = 0; i < rim.size(); ++i) {
    const Eigen::Vector2d& a = rim[i];
    const Eigen::Vector2d& b = rim[(i + 1) % rim.size()];
    const double side_a = cross(point, a);
    const double side_b = cross(point, b);
    if ((side_a < 0.0) == (side_b < 0.0)) continue;
    const double ratio = point.dot(a + (b - a) * (side_a / (side_a - side_b))) / point.squaredNorm();
    if (ratio <= 1.0) continue;
    way.inside = !way.inside;
    way.ratio = std::min(way.ratio, ratio);
  }
  return way;
}

/// How far below the ground the ray through each pixel ends, m: 0 outside of the opening, -1 at and above the horizon.
cv::Mat1f compute_depths(const Drop& drop, const Viewpoint& viewpoint) {
  const GroundPose& pose = viewpoint.ground.pose;
  cv::Mat1f depths(viewpoint.size, -1.0F);
  for (int v = 0; v < depths.rows; ++v) {
    for (int u = 0; u < depths.cols; ++u) {
      const std::optional<Eigen::Vector3d> ground = pose.intersect(u, v, viewpoint.camera);
      if (!ground) continue;
      const WayOut way = find_way_out({pose.right.dot(*ground), pose.forward.dot(*ground)}, drop.rim);
      // The ray goes down by h on its way to the ground, and so by h (ratio - 1) from there to the wall.
      const double depth = way.inside ? std::min(drop.depth_m, pose.height_m * (way.ratio - 1.0)) : 0.0;
      depths(v, u) = static_cast<float>(depth);
    }
  }
  return depths;
}

cv::Mat1f to_disparity(const cv::Mat1f& depths, const Viewpoint& viewpoint) {
  const double height = viewpoint.ground.pose.height_m;
  cv::Mat1f disparity(depths.size(), kInvalidDisparity);
  for (int v = 0; v < depths.rows; ++v) {
    for (int u = 0; u < depths.cols; ++u) {
      if (depths(v, u) < 0.0F) continue;
      const double d = viewpoint.ground.plane.disparity(u, v) / (1.0 + depths(v, u) / height);
      if (d <= viewpoint.max_disparity && d <= u) disparity(v, u) = static_cast<float>(d);
    }
  }
  return disparity;
}

double find_deepest(const cv::Mat1f& depths) {
  double deepest = 0.0;
  cv::minMaxLoc(depths, nullptr, &deepest);
  return std::max(0.0, deepest);
}

/// Why no region was found at all.
Rejection explain_nothing(const cv::Mat1f& depths, const cv::Mat1f& disparity, const Viewpoint& viewpoint,
                          const CandidateParams& params) {
  constexpr double kNothing = std::numeric_limits<double>::infinity();
  const GroundPose& pose = viewpoint.ground.pose;
  double nearest_m = kNothing;
  double wanted_m = kNothing;
  for (int v = 0; v < depths.rows; ++v) {
    for (int u = 0; u < depths.cols; ++u) {
      if (depths(v, u) <= 0.0F || disparity(v, u) < kLeastSeen) continue;
      nearest_m = std::min(nearest_m, pose.distance(*pose.intersect(u, v, viewpoint.camera)));
      wanted_m = std::min(wanted_m, noise_depth_wanted(viewpoint.ground, params) / disparity(v, u));
    }
  }
  if (nearest_m == kNothing) return {"picture", 0.0, 1.0};
  if (nearest_m > params.max_range_m) return {"range", nearest_m, params.max_range_m};
  return {"depth", find_deepest(depths), std::max(wanted_m, measured_depth_wanted(params))};
}

void require_size(const char* name, const cv::Mat1b& mask, const cv::Size& size) {
  if (mask.empty() || mask.size() == size) return;
  throw std::invalid_argument(
      fmt::format("{} has {}x{} px, must be {}x{} like the picture", name, mask.cols, mask.rows, size.width, size.height));
}

bool is_seen(double distance_m, double depth_m, const DropShape& shape, const Viewpoint& viewpoint,
             const CandidateParams& params) {
  return !compute_sighting(make_drop(distance_m, depth_m, shape), viewpoint, params).rejection;
}

/// Halves the gap between what is seen and what is not.
template <typename Seen>
double narrow(double seen, double not_seen, double step, Seen is_seen_at) {
  while (std::abs(seen - not_seen) > step) {
    const double middle = 0.5 * (seen + not_seen);
    (is_seen_at(middle) ? seen : not_seen) = middle;
  }
  return seen;
}

}  // namespace

Viewpoint make_viewpoint(const StereoCamera& camera, const cv::Size& size, const ViewpointParams& params) {
  const auto require_angle = [](const char* name, double value) {
    require_parameter(std::abs(value) < 90.0, name, value, "above -90 to below 90");
  };
  camera.validate();
  require_between("width", size.width, kMinImageWidth, 1'000'000);
  require_between("height", size.height, kMinImageHeight, 1'000'000);
  require_parameter(params.height_m > 0.0 && params.height_m <= 100.0, "height_m", params.height_m, "above 0 to 100");
  require_angle("pitch_deg", params.pitch_deg);
  require_angle("roll_deg", params.roll_deg);
  require_between("disparity_sd_px", params.disparity_sd_px, 0.001, 100.0);
  Viewpoint viewpoint;
  viewpoint.camera = camera;
  viewpoint.size = size;
  viewpoint.ground.plane = make_ground_plane(params.height_m, params.pitch_deg, params.roll_deg, camera);
  viewpoint.ground.pose = compute_ground_pose(viewpoint.ground.plane, camera);
  viewpoint.ground.disparity_sd_px = params.disparity_sd_px;
  viewpoint.ground.roughness_px = params.disparity_sd_px / kNoiseOverRoughness;
  return viewpoint;
}

Drop make_drop(double distance_m, double depth_m, const DropShape& shape) {
  const auto require_length = [](const char* name, double value) {
    require_parameter(value > 0.0 && value <= kOpenEnded, name, value, fmt::format("above 0 to {}", kOpenEnded));
  };
  require_length("distance_m", distance_m);
  require_length("depth_m", depth_m);
  require_length("length_m", shape.length_m);
  require_length("width_m", shape.width_m);
  const double half = 0.5 * shape.width_m;
  const double far = distance_m + shape.length_m;
  return {{{-half, distance_m}, {half, distance_m}, {half, far}, {-half, far}}, depth_m};
}

cv::Mat1f compute_drop_disparity(const Drop& drop, const Viewpoint& viewpoint) {
  return to_disparity(compute_depths(drop, viewpoint), viewpoint);
}

DropSighting compute_sighting(const Drop& drop, const Viewpoint& viewpoint, const CandidateParams& params, const Shown& shown) {
  require_parameter(drop.rim.size() >= 3, "points of the rim", drop.rim.size(), "3 or more");
  require_parameter(drop.depth_m > 0.0, "depth_m", drop.depth_m, "above 0");
  require_size("shown.drop", shown.drop, viewpoint.size);
  require_size("shown.ground", shown.ground, viewpoint.size);
  cv::Mat1f depths = compute_depths(drop, viewpoint);
  const cv::Mat1b in_opening(depths > 0.0F);
  if (!shown.drop.empty()) depths.setTo(-1.0F, in_opening & (shown.drop == 0));
  if (!shown.ground.empty()) depths.setTo(-1.0F, ~in_opening & (shown.ground == 0));
  const cv::Mat1f disparity = to_disparity(depths, viewpoint);
  // Without pictures the rules that look at them have nothing to say.
  const Frame frame = make_frame_with_disparity({}, disparity, viewpoint.camera);
  const cv::Mat1f elevation = compute_elevation(disparity, viewpoint.ground, viewpoint.camera);
  DropSighting sighting;
  sighting.deepest_m = find_deepest(depths);
  const std::vector<Candidate> regions = select_below_ground(frame, disparity, elevation, viewpoint.ground, params);
  if (regions.empty()) sighting.rejection = explain_nothing(depths, disparity, viewpoint, params);
  int largest_px = 0;
  for (const Candidate& region : regions) {
    if (!region.rejection) return {sighting.deepest_m, std::nullopt};
    if (region.area_px <= largest_px) continue;
    largest_px = region.area_px;
    sighting.rejection = region.rejection;
  }
  return sighting;
}

std::optional<double> estimate_smallest_depth(double distance_m, const DropShape& shape, const Viewpoint& viewpoint,
                                              const CandidateParams& params) {
  const auto is_seen_at = [&](double depth_m) { return is_seen(distance_m, depth_m, shape, viewpoint, params); };
  double not_seen = 0.0;
  while (not_seen < kGreatestDepth) {
    const double depth = std::clamp(2.0 * not_seen, kLeastDepth, kGreatestDepth);
    if (is_seen_at(depth)) return not_seen > 0.0 ? narrow(depth, not_seen, kDepthStep, is_seen_at) : depth;
    not_seen = depth;
  }
  return std::nullopt;
}

std::vector<EnvelopePoint> compute_envelope(const std::vector<double>& distances_m, const DropShape& shape,
                                            const Viewpoint& viewpoint, const CandidateParams& params) {
  std::vector<EnvelopePoint> points(distances_m.size());
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
    points[i] = {distances_m[i], estimate_smallest_depth(distances_m[i], shape, viewpoint, params)};
  });
  return points;
}

std::optional<double> estimate_largest_distance(double depth_m, const DropShape& shape, const Viewpoint& viewpoint,
                                                const CandidateParams& params) {
  const auto is_seen_at = [&](double distance_m) { return is_seen(distance_m, depth_m, shape, viewpoint, params); };
  double not_seen = 0.0;
  for (int step = 0; params.max_range_m - step * kCoarseStep > 0.0; ++step) {
    const double distance = params.max_range_m - step * kCoarseStep;
    if (is_seen_at(distance)) return step > 0 ? narrow(distance, not_seen, kDistanceStep, is_seen_at) : distance;
    not_seen = distance;
  }
  return std::nullopt;
}

}  // namespace brink
