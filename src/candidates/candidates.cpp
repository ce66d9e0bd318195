#include "brink/candidates.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "brink/disparity.hpp"
#include "candidates/agreement.hpp"
#include "candidates/far_rim.hpp"
#include "candidates/ground_hypothesis.hpp"
#include "candidates/kind.hpp"
#include "candidates/masks.hpp"
#include "candidates/region.hpp"
#include "candidates/rim_slope.hpp"
#include "evenly_spread.hpp"
#include "ground/roughness.hpp"

namespace brink {
namespace {

constexpr double kLeastRoughnessPx = 0.05;  // what walls and rubble show in the clearest pictures
constexpr double kDepthQuantile = 0.9;      // the deepest tenth is noise as often as it is depth

void check_sizes(const Frame& frame, const cv::Mat1f& disparity, const cv::Mat1f& elevation) {
  const cv::Size size = frame.size();
  if (disparity.size() != size || elevation.size() != size) {
    throw std::invalid_argument(fmt::format("sizes differ: picture {}x{}, disparity {}x{}, elevation {}x{}", size.width,
                                            size.height, disparity.cols, disparity.rows, elevation.cols, elevation.rows));
  }
}

enum class PixelKind : std::uint8_t { none, ground, below_ground, other };

PixelKind pixel_kind(float disparity, float elevation, const CandidateParams& params) {
  if (disparity < kLeastDisparity) return PixelKind::none;
  if (elevation <= -params.min_depth_m) return PixelKind::below_ground;
  return std::abs(elevation) < params.ground_tolerance_m ? PixelKind::ground : PixelKind::other;
}

/// How many pixels of each kind a region touches in its 1-px ring.
struct Touching {
  int ground = 0;
  int below_ground = 0;
  int above_ground = 0;
  int valid = 0;
  double ground_brightness = 0.0;  ///< mean grey of the ground pixels; 0 without any, or without a picture
};

/// @param none 255 = no disparity.
Touching count_touching(const Region& region, const cv::Mat1b& none, const cv::Mat1b& left, const cv::Mat1f& disparity,
                        const cv::Mat1f& elevation, const CandidateParams& params) {
  Touching touching;
  for (const cv::Point& p : ring_pixels(region, none, params.touching_gap_px)) {
    const PixelKind kind = pixel_kind(disparity(p), elevation(p), params);
    touching.valid += kind != PixelKind::none ? 1 : 0;
    touching.ground += kind == PixelKind::ground ? 1 : 0;
    touching.below_ground += kind == PixelKind::below_ground ? 1 : 0;
    touching.above_ground += kind == PixelKind::other && elevation(p) > 0.0F ? 1 : 0;
    if (kind == PixelKind::ground && !left.empty()) touching.ground_brightness += left(p);
  }
  touching.ground_brightness /= std::max(1, touching.ground);
  return touching;
}

/// The 3D contour, its mean, and its point nearest to the camera: what the paper tracks and tells (III.C.4).
void measure_contour(Candidate& candidate, const cv::Mat1f& disparity, const StereoCamera& camera) {
  for (const cv::Point& p : candidate.contour) {
    if (disparity(p) >= kLeastDisparity) candidate.contour_3d.push_back(camera.triangulate(p.x, p.y, disparity(p)));
  }
  if (candidate.contour_3d.empty()) return;
  for (const Eigen::Vector3d& point : candidate.contour_3d) candidate.centroid += point;
  candidate.centroid /= static_cast<double>(candidate.contour_3d.size());
  candidate.nearest = *std::ranges::min_element(candidate.contour_3d, {}, [](const auto& point) { return point.norm(); });
}

/// The opening in the ground. The region is seen through it, so the rays through the region's outline meet the ground at the
/// rim: no disparity of a depth edge, where matching is worst, takes part.
void measure_rim(Candidate& candidate, const std::vector<cv::Point>& outline, const GroundSurface& ground,
                 const StereoCamera& camera) {
  const GroundPose& pose = ground.pose;
  std::vector<Eigen::Vector3d>& rim = candidate.rim;
  for (const cv::Point& p : outline) {
    if (const auto point = ground.intersect(p.x, p.y, camera)) rim.push_back(*point);
  }
  if (rim.empty()) return;
  candidate.rim_nearest = *std::ranges::min_element(rim, {}, [&](const auto& point) { return pose.distance(point); });
  candidate.distance_m = pose.distance(candidate.rim_nearest);
  candidate.bearing_deg = pose.bearing_deg(candidate.rim_nearest);
  candidate.width_m = compute_width(rim, pose);
}

cv::Scalar compute_mean_color(const Frame& frame, const Region& region) {
  if (frame.left.empty()) return {};
  const cv::Rect in_picture = region.box & cv::Rect(cv::Point(0, 0), frame.left.size());
  const cv::Mat1b mask = region.mask(in_picture - region.box.tl());
  if (!frame.left_color.empty()) return cv::mean(frame.left_color(in_picture), mask);
  const double grey = cv::mean(frame.left(in_picture), mask)[0];
  return {grey, grey, grey};
}

/// The brightness, greatest of B, G and R, that half of a region's pixels do not exceed.
double compute_median_brightness(const Frame& frame, const Region& region) {
  std::vector<std::uint8_t> levels;
  for (int v = 0; v < region.mask.rows; ++v) {
    for (int u = 0; u < region.mask.cols; ++u) {
      const cv::Point p = region.box.tl() + cv::Point(u, v);
      if (region.mask(v, u) == 0 || !p.inside({{0, 0}, frame.left.size()})) continue;
      if (frame.left_color.empty()) {
        levels.push_back(frame.left(p));
      } else {
        const cv::Vec3b& color = frame.left_color(p);
        levels.push_back(std::max({color[0], color[1], color[2]}));
      }
    }
  }
  const auto middle = levels.begin() + static_cast<std::ptrdiff_t>((levels.size() - 1) / 2);
  std::ranges::nth_element(levels, middle);
  return *middle;
}

double compute_depth(const Region& region, const cv::Mat1f& elevation) {
  std::vector<float> depths;
  for (int v = 0; v < region.mask.rows; ++v) {
    for (int u = 0; u < region.mask.cols; ++u) {
      if (region.mask(v, u) != 0) depths.push_back(-elevation(region.box.y + v, region.box.x + u));
    }
  }
  const auto place = depths.begin() + static_cast<std::ptrdiff_t>(kDepthQuantile * static_cast<double>(depths.size() - 1));
  std::ranges::nth_element(depths, place);
  return *place;
}

/// How many standard deviations half of the deep part lies below the ground, at least. All of one size.
double compute_sigmas(const cv::Mat1b& deep, const cv::Mat1f& disparity, const cv::Mat1f& elevation,
                      const GroundSurface& ground) {
  std::vector<double> sigmas;
  for (int v = 0; v < deep.rows; ++v) {
    for (int u = 0; u < deep.cols; ++u) {
      if (deep(v, u) == 0) continue;
      const double sd_m = ground.pose.height_m * ground.disparity_sd_px / disparity(v, u);
      sigmas.push_back(-elevation(v, u) / sd_m);
    }
  }
  if (sigmas.empty()) return 0.0;
  const auto middle = sigmas.begin() + static_cast<std::ptrdiff_t>(sigmas.size() / 2);
  std::ranges::nth_element(sigmas, middle);
  return *middle;
}

/// Evenly spread pixels that are judged of a part of the picture, in picture coordinates.
std::vector<cv::Point> choose_pixels(const cv::Mat1b& part, const cv::Point& origin) {
  constexpr int kTarget = 400;
  std::vector<cv::Point> pixels = spread_evenly(part, kTarget);
  for (cv::Point& p : pixels) p += origin;
  return pixels;
}

double compute_solid_angle_msr(int area_px, const StereoCamera& camera) {
  return 1000.0 * area_px / (camera.focal * camera.focal);
}

Measures measure_border(const Touching& touching) {
  Measures measures;
  if (touching.valid == 0) return measures;
  measures.ground_share = static_cast<double>(touching.ground) / touching.valid;
  measures.standing_share = static_cast<double>(touching.above_ground) / touching.valid;
  return measures;
}

/// Notes the first rule that fails.
void require(Candidate& candidate, const char* rule, bool passed, double value, double limit) {
  if (!passed && !candidate.rejection) candidate.rejection = Rejection{rule, value, limit};
}

/// By how much a region may be rougher than the ground the better both pictures agree about it: edges and rubble are rough,
/// too.
double allowance(double agreement) {
  constexpr double kFair = 0.45;  // surfaces in noise agree no better
  constexpr double kGain = 2.0;
  return 1.0 + kGain * std::max(0.0, agreement - kFair);
}

/// Everything about one region that does not depend on its type.
Candidate measure(const Frame& frame, const Region& region, CandidateType type, const cv::Mat1f& disparity,
                  const GroundSurface& ground) {
  Candidate candidate;
  candidate.type = type;
  candidate.area_px = region.area_px;
  const std::vector<cv::Point> outline = trace_contour(region.dilated, region.box);
  candidate.contour = type == CandidateType::no_disparity ? outline : trace_contour(region.mask, region.box);
  candidate.mean_color = compute_mean_color(frame, region);
  measure_contour(candidate, disparity, frame.camera);
  measure_rim(candidate, outline, ground, frame.camera);
  return candidate;
}

}  // namespace

std::string to_string(CandidateType type) { return type == CandidateType::below_ground ? "below_ground" : "no_disparity"; }

std::string to_string(ObstacleKind kind) {
  switch (kind) {
    case ObstacleKind::stairs_down:
      return "stairs_down";
    case ObstacleKind::edge:
      return "edge";
    case ObstacleKind::hole:
      return "hole";
    case ObstacleKind::unknown:
      break;
  }
  return "unknown";
}

double compute_width(const std::vector<Eigen::Vector3d>& rim, const GroundPose& pose) {
  if (rim.empty()) return 0.0;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : rim) middle += point;
  const Eigen::Vector3d across = pose.down.cross(middle).normalized();
  const auto [left, right] = std::ranges::minmax(rim, {}, [&](const auto& point) { return across.dot(point); });
  return across.dot(right - left);
}

CandidateParams CandidateParams::paper() {
  CandidateParams params;
  params.below_ground_min_area_px = 150;
  params.below_ground_min_msr = 0.0;
  params.black_share = 0.0;
  params.black_by_median = false;
  params.measured_depth_ratio = 1.0;
  params.rim_depth_ratio = 1.0;
  params.min_slope_deg = 0.0;
  params.min_sigmas = 0.0;
  params.max_share_beyond = 1.0;
  params.max_roughness = 0.0;
  params.min_agreement = 0.0;
  params.min_ground_misfit = 0.0;
  params.max_share_standing = 1.0;
  params.touching_gap_px = 0;
  params.border_px = 0;
  params.tell_kind = false;
  params.merge_gap_m = 0.0;
  return params;
}

void CandidateParams::validate() const {
  const auto require_param = [](bool valid, const char* name, double value, const char* expected) {
    if (!valid) throw std::invalid_argument(fmt::format("candidates.{} = {}, must be {}", name, value, expected));
  };
  require_param(ground_tolerance_m > 0.0 && ground_tolerance_m <= 10.0, "ground_tolerance_m", ground_tolerance_m,
                "above 0 to 10");
  require_param(min_depth_m > 0.0 && min_depth_m <= 10.0, "min_depth_m", min_depth_m, "above 0 to 10");
  require_param(measured_depth_ratio > 0.0 && measured_depth_ratio <= 1.0, "measured_depth_ratio", measured_depth_ratio,
                "above 0 to 1");
  require_param(rim_depth_ratio > 0.0 && rim_depth_ratio <= 1.0, "rim_depth_ratio", rim_depth_ratio, "above 0 to 1");
  require_param(min_slope_deg >= 0.0 && min_slope_deg < 90.0, "min_slope_deg", min_slope_deg, "0 to below 90");
  require_param(max_share_beyond >= 0.0 && max_share_beyond <= 1.0, "max_share_beyond", max_share_beyond, "0 to 1");
  require_param(max_roughness >= 0.0 && max_roughness <= 1000.0, "max_roughness", max_roughness, "0 to 1000");
  require_param(min_agreement >= 0.0 && min_agreement <= 1.0, "min_agreement", min_agreement, "0 to 1");
  require_param(min_ground_misfit >= 0.0 && min_ground_misfit <= 1.0, "min_ground_misfit", min_ground_misfit, "0 to 1");
  require_param(max_share_standing >= 0.0 && max_share_standing <= 1.0, "max_share_standing", max_share_standing, "0 to 1");
  require_param(touching_gap_px >= 0 && touching_gap_px <= 1000, "touching_gap_px", touching_gap_px, "0 to 1000");
  require_param(min_sigmas >= 0.0 && min_sigmas <= 1000.0, "min_sigmas", min_sigmas, "0 to 1000");
  require_param(below_ground_min_area_px >= 0, "below_ground_min_area_px", below_ground_min_area_px, "0 or more");
  require_param(below_ground_min_msr >= 0.0 && below_ground_min_msr <= 1000.0, "below_ground_min_msr", below_ground_min_msr,
                "0 to 1000");
  require_param(no_disparity_min_area_px >= 0, "no_disparity_min_area_px", no_disparity_min_area_px, "0 or more");
  require_param(min_touching_px >= 0, "min_touching_px", min_touching_px, "0 or more");
  require_param(black_level >= 0.0 && black_level <= 255.0, "black_level", black_level, "0 to 255");
  require_param(black_share >= 0.0 && black_share <= 1.0, "black_share", black_share, "0 to 1");
  require_param(border_px >= 0 && border_px <= 1000, "border_px", border_px, "0 to 1000");
  require_param(merge_gap_m >= 0.0 && merge_gap_m <= 10.0, "merge_gap_m", merge_gap_m, "0 to 10");
  require_param(max_range_m > 0.0 && max_range_m <= 1000.0, "max_range_m", max_range_m, "above 0 to 1000");
  require_param(min_listed_area_px >= 1, "min_listed_area_px", min_listed_area_px, "1 or more");
}

std::vector<Candidate> select_below_ground(const Frame& frame, const cv::Mat1f& disparity, const cv::Mat1f& elevation,
                                           const GroundSurface& ground, const CandidateParams& params) {
  check_sizes(frame, disparity, elevation);
  params.validate();
  const GroundPose& pose = ground.pose;
  const auto [none, deep, low, level] = find_below_ground(disparity, elevation, ground, frame.camera, params);
  const double min_area_px =
      std::max<double>(params.below_ground_min_area_px, params.below_ground_min_msr / compute_solid_angle_msr(1, frame.camera));
  const double ground_roughness_px = std::max(kLeastRoughnessPx, ground.roughness_px);

  std::vector<Candidate> candidates;
  for (const Region& region : find_regions(low, params.min_listed_area_px)) {
    const cv::Rect box = region.box & cv::Rect(cv::Point(0, 0), deep.size());
    const cv::Mat1b deep_here(deep(box) & region.mask(box - region.box.tl()));
    const int deep_px = cv::countNonZero(deep_here);
    if (deep_px < params.min_listed_area_px) continue;
    Candidate candidate = measure(frame, region, CandidateType::below_ground, disparity, ground);
    candidate.depth_m = compute_depth(region, elevation);
    const Touching touching = count_touching(region, none, frame.left, disparity, elevation, params);
    require(candidate, "area", deep_px > min_area_px, deep_px, min_area_px);
    require(candidate, "touches_ground", touching.ground >= params.min_touching_px, touching.ground, params.min_touching_px);
    Measures& measures = candidate.measures;
    measures = measure_border(touching);
    measures.solid_angle_msr = compute_solid_angle_msr(region.area_px, frame.camera);
    measures.sigmas = compute_sigmas(deep_here, disparity(box), elevation(box), ground);
    if (params.min_slope_deg > 0.0) {
      const double slope_deg = compute_rim_slope_deg(region, deep, level, disparity, frame.camera, pose);
      measures.slope_deg = slope_deg;
      require(candidate, "slope", slope_deg >= params.min_slope_deg, slope_deg, params.min_slope_deg);
    }
    if (params.max_share_beyond < 1.0) {
      const double beyond = compute_share_beyond_rim(region, level, disparity, frame.camera, pose, ground.disparity_sd_px);
      measures.share_beyond = beyond;
      require(candidate, "beyond_rim", beyond <= params.max_share_beyond, beyond, params.max_share_beyond);
    }
    const std::vector<cv::Point> pixels = choose_pixels(deep_here, box.tl());
    if (params.max_roughness > 0.0 || params.min_agreement > 0.0) {
      measures.agreement = compute_agreement(frame, pixels, disparity);
    }
    if (params.max_roughness > 0.0) {
      const double roughness = compute_roughness_px(deep_here, disparity(box)) / ground_roughness_px;
      measures.roughness = roughness;
      const double limit = params.max_roughness * allowance(measures.agreement);
      require(candidate, "rough", roughness <= limit, roughness, limit);
    }
    if (params.min_agreement > 0.0) {
      const double agreement = measures.agreement;
      require(candidate, "disagree", agreement >= params.min_agreement, agreement, params.min_agreement);
    }
    if (params.min_ground_misfit > 0.0) {
      const double misfit = compute_ground_misfit(frame, pixels, disparity, elevation, pose);
      measures.ground_misfit = misfit;
      require(candidate, "like_ground", misfit >= params.min_ground_misfit, misfit, params.min_ground_misfit);
    }
    if (params.tell_kind && !candidate.rejection) {
      candidate.kind = tell_kind(candidate, region, none, disparity, elevation, frame.camera, pose, params);
    }
    candidates.push_back(std::move(candidate));
  }
  return candidates;
}

std::vector<Candidate> select_no_disparity(const Frame& frame, const cv::Mat1f& disparity, const cv::Mat1f& elevation,
                                           const GroundSurface& ground, const CandidateParams& params) {
  check_sizes(frame, disparity, elevation);
  params.validate();
  if (frame.left.empty()) return {};
  const GroundPose& pose = ground.pose;
  const cv::Mat1b none(disparity < kLeastDisparity);
  const cv::Mat1b mask = find_no_disparity(none, ground, frame.camera, params);

  std::vector<Candidate> candidates;
  for (const Region& region : find_regions(mask, params.min_listed_area_px)) {
    Candidate candidate = measure(frame, region, CandidateType::no_disparity, disparity, ground);
    const Touching touching = count_touching(region, none, frame.left, disparity, elevation, params);
    candidate.measures = measure_border(touching);
    candidate.measures.solid_angle_msr = compute_solid_angle_msr(region.area_px, frame.camera);
    const int surface = touching.ground + touching.below_ground;
    double brightness = std::max({candidate.mean_color[0], candidate.mean_color[1], candidate.mean_color[2]});
    if (params.black_by_median) brightness = std::min(brightness, compute_median_brightness(frame, region));
    require(candidate, "area", region.area_px > params.no_disparity_min_area_px, region.area_px,
            params.no_disparity_min_area_px);
    require(candidate, "touches_valid", touching.valid >= params.min_touching_px, touching.valid, params.min_touching_px);
    require(candidate, "touches_ground", surface >= params.min_touching_px, surface, params.min_touching_px);
    const double black = std::max(params.black_level, params.black_share * touching.ground_brightness);
    require(candidate, "black", brightness <= black, brightness, black);
    if (params.max_share_standing < 1.0) {
      const double standing = candidate.measures.standing_share;
      require(candidate, "standing", standing <= params.max_share_standing, standing, params.max_share_standing);
    }
    require(candidate, "contour", !candidate.contour_3d.empty(), 0.0, 1.0);
    if (params.tell_kind && !candidate.rejection) {
      candidate.kind = tell_kind(candidate, region, none, disparity, elevation, frame.camera, pose, params);
    }
    candidates.push_back(std::move(candidate));
  }
  return candidates;
}

}  // namespace brink
