#include "ego_motion/local_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <utility>

#include <Eigen/Cholesky>

namespace brink {
namespace {

constexpr double kTemporalReach = 3.0;   // px
constexpr double kMaxVariance = 0.25;    // px^2: disparities known worse are left out
constexpr double kLeastDisparity = 0.3;  // px

/// The strongest matched feature of each square of the left picture, so many squares that about `count` remain.
std::vector<StereoMatch> spread(const std::vector<StereoMatch>& matches, const StereoFeatures& features, cv::Size size,
                                int count) {
  const double side = std::sqrt(static_cast<double>(size.area()) / count);
  std::map<std::pair<int, int>, StereoMatch> squares;
  for (const StereoMatch& match : matches) {
    const Feature& feature = features.left[match.left];
    const std::pair square(static_cast<int>(feature.position.y / side), static_cast<int>(feature.position.x / side));
    const auto [kept, is_new] = squares.emplace(square, match);
    if (!is_new && feature.strength > features.left[kept->second.left].strength) kept->second = match;
  }
  std::vector<StereoMatch> result;
  result.reserve(squares.size());
  for (const auto& [square, match] : squares) result.push_back(match);
  return result;
}

/// How a patch of the left picture shows in the right one.
Eigen::Matrix2d stereo_warp(const Eigen::Vector2d& slope) {
  Eigen::Matrix2d warp;
  warp << 1.0 - slope.x(), -slope.y(), 0.0, 1.0;
  return warp;
}

/// Column, row and disparity of each point, px.
std::vector<Eigen::Vector3d> list_places(const std::vector<MapPoint>& points) {
  std::vector<Eigen::Vector3d> places;
  places.reserve(points.size());
  for (const MapPoint& point : points) places.emplace_back(point.patch.centre.x, point.patch.centre.y, point.disparity);
  return places;
}

/// Slope of the surface through its neighbours, by reweighted least squares: those of another surface count nothing.
Eigen::Vector2d fit_slope(const Eigen::Vector3d& place, const std::vector<Eigen::Vector3d>& places, double radius) {
  constexpr int kRounds = 4;
  constexpr double kTolerance = 0.5;        // px: disparity off the surface
  constexpr double kStiffness = 50.0;       // px^2: keeps a slope from one or two neighbours small
  std::vector<Eigen::Vector3d> neighbours;  // from the place
  for (const Eigen::Vector3d& other : places) {
    const Eigen::Vector3d apart = other - place;
    if (apart.head<2>().norm() <= radius) neighbours.push_back(apart);
  }
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix2d hessian = kStiffness * Eigen::Matrix2d::Identity();
    Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
    for (const Eigen::Vector3d& neighbour : neighbours) {
      const Eigen::Vector2d apart = neighbour.head<2>();
      const double difference = neighbour.z();
      const double off = (difference - slope.dot(apart)) / (kTolerance * (kRounds - round));
      const double weight = 1.0 / ((1.0 + off * off) * (1.0 + off * off));
      hessian += weight * apart * apart.transpose();
      gradient += weight * apart * difference;
    }
    slope = hessian.llt().solve(gradient);
  }
  return slope;
}

/// Finds the points in the right picture; those that are not there are left out.
void measure_disparities(std::vector<MapPoint>& points, const SmoothPair& pictures, double offset) {
  std::vector<RightSearch> searches;
  searches.reserve(points.size());
  for (const MapPoint& point : points) {
    const Eigen::Vector2d left(point.patch.centre.x, point.patch.centre.y);
    searches.push_back({{left, Eigen::Matrix2d::Zero()},
                        {&point.patch, left - Eigen::Vector2d(point.disparity - offset, 0.0), stereo_warp(point.slope)}});
  }
  const auto places = find_in_right(pictures, searches);
  std::vector<char> found(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!places[i]) continue;
    const Eigen::Vector2d& left = searches[i].left.position;
    MapPoint& point = points[i];
    point.disparity = left.x() - places[i]->position.x() + offset;
    point.variance = places[i]->covariance(2, 2);
    point.row_offset = places[i]->position.y() - left.y();
    point.row_variance = places[i]->covariance(3, 3);
    found[i] = point.disparity > kLeastDisparity ? 1 : 0;
  }
  std::size_t i = 0;
  std::erase_if(points, [&](const MapPoint&) { return found[i++] == 0; });
}

/// A pixel of a keyframe, with its disparity, as the current cameras see it: column and row left, then right.
Eigen::Vector4d transfer(const Eigen::Vector3d& pixel, const StereoCamera& camera,
                         const Eigen::Isometry3d& current_from_keyframe) {
  return project_stereo(camera, current_from_keyframe * camera.triangulate(pixel.x(), pixel.y(), pixel.z()));
}

/// Where and how a point should show in the current pictures.
struct Prediction {
  Eigen::Vector4d pixel;         ///< column and row left, then right, px
  Eigen::Vector4d by_disparity;  ///< derivative of pixel by the point's disparity
  Eigen::Matrix2d left_warp;     ///< offsets in the patch -> offsets in the left picture
  Eigen::Matrix2d right_warp;
};

/// Empty when the point is behind the camera or too near. The surface of a patch is a plane: its slope tells the warp.
std::optional<Prediction> predict(const MapPoint& point, const StereoCamera& camera,
                                  const Eigen::Isometry3d& current_from_keyframe) {
  const Eigen::Vector3d centre(point.patch.centre.x, point.patch.centre.y, point.disparity);
  if (centre.z() <= point.slope.cwiseAbs().maxCoeff()) return std::nullopt;  // its plane reaches infinity within the patch
  const Eigen::Vector3d in_keyframe = camera.triangulate(centre.x(), centre.y(), centre.z());
  const Eigen::Vector3d now = current_from_keyframe * in_keyframe;
  if (now.z() < camera.baseline) return std::nullopt;  // or nearer than any disparity is searched
  const auto differentiate = [&](const Eigen::Vector3d& step) -> Eigen::Vector4d {
    return 0.5 *
           (transfer(centre + step, camera, current_from_keyframe) - transfer(centre - step, camera, current_from_keyframe));
  };
  const Eigen::Vector4d by_u = differentiate({1.0, 0.0, point.slope.x()});
  const Eigen::Vector4d by_v = differentiate({0.0, 1.0, point.slope.y()});
  Prediction prediction;
  prediction.pixel = project_stereo(camera, now);
  prediction.by_disparity =
      project_stereo_jacobian(camera, now) * (current_from_keyframe.linear() * in_keyframe) / -point.disparity;
  prediction.left_warp << by_u.head<2>(), by_v.head<2>();
  prediction.right_warp << by_u.tail<2>(), by_v.tail<2>();
  return prediction;
}

/// A point of a keyframe, and where and how it should show.
struct Sought {
  std::size_t keyframe;
  std::size_t point;
  Prediction prediction;
};

std::vector<Sought> predict_all(const std::vector<Keyframe>& keyframes, const StereoCamera& camera,
                                const Eigen::Isometry3d& current_from_previous) {
  std::vector<Sought> sought;
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    const Eigen::Isometry3d current_from_keyframe = current_from_previous * keyframes[k].frame_from_keyframe;
    for (std::size_t i = 0; i < keyframes[k].points.size(); ++i) {
      if (const auto prediction = predict(keyframes[k].points[i], camera, current_from_keyframe))
        sought.push_back({k, i, *prediction});
    }
  }
  return sought;
}

/// What rectification left in the columns of all, and in the rows of this point when it was new: it is taken away.
Eigen::Vector2d rectification_of(const MapPoint& point, double offset) { return {offset, point.row_offset}; }

Sighting make_sighting(const Sought& sought, const Keyframe& keyframe, const StereoCamera& camera, const Eigen::Vector2d& left,
                       const RightPlace& right, double offset) {
  const MapPoint& point = keyframe.points[sought.point];
  Sighting sighting;
  sighting.keyframe = sought.keyframe;
  sighting.point = sought.point;
  sighting.observation.point =
      keyframe.frame_from_keyframe * camera.triangulate(point.patch.centre.x, point.patch.centre.y, point.disparity);
  sighting.observation.pixel << left, right.position - rectification_of(point, offset);
  sighting.pixel_covariance = right.covariance;
  sighting.pixel_covariance(3, 3) += point.row_variance;
  sighting.by_disparity = sought.prediction.by_disparity;
  sighting.observation.by_offset = sighting.by_disparity + Eigen::Vector4d::Unit(2);
  sighting.observation.sqrt_information =
      compute_sqrt_information(sighting.pixel_covariance, point.variance, sighting.by_disparity);
  return sighting;
}

/// One step of a Kalman filter on the disparity of the point.
void improve_disparity(MapPoint& point, const Sighting& sighting, const StereoCamera& camera, const MotionFit& fit) {
  const Eigen::Vector4d residual = sighting.observation.pixel -
                                   project_stereo(camera, fit.current_from_previous * sighting.observation.point) -
                                   fit.offset * sighting.observation.by_offset;
  const Eigen::Vector4d weighted = sighting.pixel_covariance.llt().solve(sighting.by_disparity);
  const double information = 1.0 / point.variance + weighted.dot(sighting.by_disparity);
  point.variance = 1.0 / information;
  point.disparity = std::max(point.disparity + point.variance * weighted.dot(residual), kLeastDisparity);
}

}  // namespace

Keyframe make_keyframe(const SmoothPair& pictures, const StereoFeatures& features, double offset,
                       const EgoMotionParams& params) {
  Keyframe keyframe;
  for (const StereoMatch& match :
       spread(match_stereo(features, params), features, pictures.left.size(), params.keyframe_points)) {
    const cv::Point2f left = features.left[match.left].position;
    const auto patch = make_patch(pictures.left, cv::Point(cvRound(left.x), cvRound(left.y)));
    if (!patch) continue;
    MapPoint point;
    point.patch = *patch;
    point.disparity = left.x - features.right[match.right].position.x + offset;
    keyframe.points.push_back(point);
  }
  measure_disparities(keyframe.points, pictures, offset);
  const std::vector<Eigen::Vector3d> places = list_places(keyframe.points);
  for (std::size_t i = 0; i < places.size(); ++i)
    keyframe.points[i].slope = fit_slope(places[i], places, params.slope_radius_px);
  measure_disparities(keyframe.points, pictures, offset);
  std::erase_if(keyframe.points, [&](const MapPoint& point) { return point.variance > kMaxVariance; });
  return keyframe;
}

std::vector<Sighting> find_sightings(const std::vector<Keyframe>& keyframes, const SmoothPair& current,
                                     const StereoCamera& camera, const Eigen::Isometry3d& current_from_previous,
                                     double offset) {
  std::vector<Sought> sought = predict_all(keyframes, camera, current_from_previous);
  std::vector<PatchSearch> left_searches;
  left_searches.reserve(sought.size());
  for (const auto& [keyframe, point, prediction] : sought) {
    left_searches.push_back({&keyframes[keyframe].points[point].patch, prediction.pixel.head<2>(), prediction.left_warp});
  }
  const auto left = align_patches(left_searches, current.left, kTemporalReach);
  std::size_t next = 0;
  std::erase_if(sought, [&](const Sought&) { return !left[next++]; });
  std::vector<RightSearch> right_searches;
  right_searches.reserve(sought.size());
  for (const auto& alignment : left) {
    if (!alignment) continue;
    const auto& [keyframe, i, prediction] = sought[right_searches.size()];
    const MapPoint& point = keyframes[keyframe].points[i];
    const Eigen::Vector2d expected = prediction.pixel.tail<2>() + rectification_of(point, offset);
    right_searches.push_back({*alignment, {&point.patch, expected, prediction.right_warp}});
  }
  const auto right = find_in_right(current, right_searches);
  std::vector<Sighting> sightings;
  sightings.reserve(sought.size());
  for (std::size_t i = 0; i < sought.size(); ++i) {
    if (!right[i]) continue;
    sightings.push_back(
        make_sighting(sought[i], keyframes[sought[i].keyframe], camera, right_searches[i].left.position, *right[i], offset));
  }
  return sightings;
}

std::vector<Keyframe> move_on(std::vector<Keyframe> keyframes, const std::vector<Sighting>& sightings,
                              const StereoCamera& camera, const MotionFit& fit, double limit) {
  for (Keyframe& keyframe : keyframes) {
    keyframe.inliers = 0;
    keyframe.frame_from_keyframe = fit.current_from_previous * keyframe.frame_from_keyframe;
    for (MapPoint& point : keyframe.points) point.disparity = std::max(point.disparity + fit.offset, kLeastDisparity);
  }
  for (const Sighting& sighting : sightings) {
    if (compute_error(sighting.observation, camera, fit.current_from_previous) >= limit) continue;
    Keyframe& keyframe = keyframes[sighting.keyframe];
    ++keyframe.inliers;
    improve_disparity(keyframe.points[sighting.point], sighting, camera, fit);
  }
  return keyframes;
}

}  // namespace brink
