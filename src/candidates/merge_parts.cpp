#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "brink/candidates.hpp"
#include "candidates/grow.hpp"
#include "candidates/region.hpp"
#include "ground/level.hpp"

namespace brink {
namespace {

/// The pixels of a part and of what lies around it that is not ground.
struct Reach {
  cv::Rect box;
  int steps = 0;
  cv::Mat1b mask;  ///< 255 = reached; of the box's size; empty until it is asked for
};

cv::Rect whole(const cv::Mat& picture) { return {cv::Point(0, 0), picture.size()}; }

/// How far a part reaches: half the gap at the distance of its rim, px.
int reach_px(const Candidate& part, const StereoCamera& camera, double gap_m) {
  constexpr double kNearest = 0.5;  // m: nearer rims reach no farther in the picture
  return static_cast<int>(std::lround(0.5 * gap_m * camera.focal / std::max(kNearest, part.rim_nearest.z())));
}

cv::Rect widened(const cv::Rect& box, int by) { return {box.x - by, box.y - by, box.width + 2 * by, box.height + 2 * by}; }

Reach make_reach(const Candidate& part, const cv::Mat1b& passable, const StereoCamera& camera, double gap_m) {
  Reach reach;
  reach.steps = reach_px(part, camera, gap_m);
  reach.box = widened(cv::boundingRect(part.contour), reach.steps) & whole(passable);
  return reach;
}

/// Grows a part through what is not ground: through a handrail, a person in front of it, the rest of the drop.
void fill(Reach& reach, const Candidate& part, const cv::Mat1b& passable) {
  if (!reach.mask.empty()) return;
  cv::Mat1b start(reach.box.size(), uchar{0});
  cv::fillPoly(start, std::vector{part.contour}, cv::Scalar(255), cv::LINE_8, 0, -reach.box.tl());
  reach.mask = grow(start, passable(reach.box), reach.steps) == static_cast<uchar>(Growth::grown);
}

/// Which parts belong together: for each the first of its group.
std::vector<std::size_t> find_groups(const std::vector<Candidate>& parts, const cv::Mat1b& passable, const StereoCamera& camera,
                                     double gap_m) {
  std::vector<std::size_t> group(parts.size());
  std::iota(group.begin(), group.end(), std::size_t{0});
  std::vector<Reach> reaches;
  reaches.reserve(parts.size());
  for (const Candidate& part : parts) reaches.push_back(make_reach(part, passable, camera, gap_m));
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      Reach& a = reaches[i];
      Reach& b = reaches[j];
      const cv::Rect common = a.box & b.box;
      if (group[i] == group[j] || common.empty()) continue;
      fill(a, parts[i], passable);
      fill(b, parts[j], passable);
      if (cv::countNonZero(a.mask(common - a.box.tl()) & b.mask(common - b.box.tl())) == 0) continue;
      const auto [first, later] = std::minmax(group[i], group[j]);
      std::ranges::replace(group, later, first);
    }
  }
  return group;
}

/// Square of the distance to a rectangle around points; 0 inside.
int distance2(const cv::Point& p, const cv::Rect& box) {
  const int across = std::max({box.x - p.x, p.x - (box.br().x - 1), 0});
  const int down = std::max({box.y - p.y, p.y - (box.br().y - 1), 0});
  return across * across + down * down;
}

/// The shortest line between two outlines; of equally short ones the first. Pieces that are farther away are not looked at.
std::pair<cv::Point, cv::Point> find_bridge(const std::vector<cv::Point>& from, const std::vector<cv::Point>& to) {
  constexpr std::size_t kPiece = 64;
  std::vector<std::span<const cv::Point>> pieces;
  std::vector<cv::Rect> boxes;
  for (std::size_t begin = 0; begin < to.size(); begin += kPiece) {
    pieces.emplace_back(to.data() + begin, std::min(kPiece, to.size() - begin));
    boxes.push_back(cv::boundingRect(std::vector(pieces.back().begin(), pieces.back().end())));
  }
  std::pair<cv::Point, cv::Point> bridge;
  int least = std::numeric_limits<int>::max();
  for (const cv::Point& p : from) {
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      if (distance2(p, boxes[i]) >= least) continue;
      for (const cv::Point& q : pieces[i]) {
        const cv::Point gap = p - q;
        const int length = gap.dot(gap);
        if (length < least) {
          least = length;
          bridge = {p, q};
        }
      }
    }
  }
  return bridge;
}

/// One outline around both, which a bridge connects.
std::vector<cv::Point> join_contours(const std::vector<cv::Point>& a, const std::vector<cv::Point>& b) {
  constexpr int kBridgeWidth = 3;  // px
  const cv::Rect box = cv::boundingRect(a) | cv::boundingRect(b);
  cv::Mat1b mask(box.size(), uchar{0});
  cv::fillPoly(mask, std::vector{a}, cv::Scalar(255), cv::LINE_8, 0, -box.tl());
  cv::fillPoly(mask, std::vector{b}, cv::Scalar(255), cv::LINE_8, 0, -box.tl());
  const auto [p, q] = find_bridge(a, b);
  cv::line(mask, p - box.tl(), q - box.tl(), cv::Scalar(255), kBridgeWidth);
  return trace_contour(mask, box);
}

void append(std::vector<Eigen::Vector3d>& points, const std::vector<Eigen::Vector3d>& more) {
  points.insert(points.end(), more.begin(), more.end());
}

/// The larger part tells type, colour, kind and measures; the nearest point of each sort is that of the part which has it.
Candidate join(Candidate larger, Candidate other, const GroundPose& pose) {
  if (larger.area_px < other.area_px) std::swap(larger, other);
  std::vector<CandidateType> types = larger.types.empty() ? std::vector{larger.type} : larger.types;
  for (const CandidateType type : other.types.empty() ? std::vector{other.type} : other.types) {
    if (std::ranges::find(types, type) == types.end()) types.push_back(type);
  }
  larger.types = std::move(types);
  if (larger.kind == ObstacleKind::unknown) larger.kind = other.kind;
  const auto points = static_cast<double>(larger.contour_3d.size());
  const auto more = static_cast<double>(other.contour_3d.size());
  if (points + more > 0.0) larger.centroid = (points * larger.centroid + more * other.centroid) / (points + more);
  larger.contour = join_contours(larger.contour, other.contour);
  append(larger.contour_3d, other.contour_3d);
  append(larger.rim, other.rim);
  larger.area_px += other.area_px;
  larger.measures.solid_angle_msr += other.measures.solid_angle_msr;
  if (other.nearest.norm() < larger.nearest.norm()) larger.nearest = other.nearest;
  if (other.depth_m) larger.depth_m = std::max(larger.depth_m.value_or(0.0), *other.depth_m);
  if (other.distance_m < larger.distance_m) {
    larger.rim_nearest = other.rim_nearest;
    larger.distance_m = other.distance_m;
    larger.bearing_deg = other.bearing_deg;
  }
  larger.width_m = compute_width(larger.rim, pose);
  return larger;
}

}  // namespace

std::vector<Candidate> merge_parts(std::vector<Candidate> candidates, const cv::Mat1f& elevation, const GroundPose& pose,
                                   const StereoCamera& camera, const CandidateParams& params) {
  params.validate();
  if (params.merge_gap_m <= 0.0 || candidates.size() < 2) return candidates;
  const cv::Mat1b passable(~select_level(elevation, params.ground_tolerance_m));  // where nothing is known, too
  const std::vector<std::size_t> group = find_groups(candidates, passable, camera, params.merge_gap_m);
  std::vector<Candidate> merged;
  std::vector<std::size_t> place(candidates.size());
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (group[i] == i) {
      place[i] = merged.size();
      merged.push_back(std::move(candidates[i]));
    } else {
      Candidate& whole_one = merged[place[group[i]]];
      whole_one = join(std::move(whole_one), std::move(candidates[i]), pose);
    }
  }
  return merged;
}

}  // namespace brink
