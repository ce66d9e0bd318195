#include "ego_motion/local_map.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "ego_motion/synthetic_room.hpp"

namespace brink {
namespace {

SmoothPair smooth(const Frame& frame) { return make_smooth_pair(frame); }

StereoFeatures find_stereo_features(const Frame& frame) {
  return {FeatureIndex(find_features(frame.left, {}), frame.left.size()),
          FeatureIndex(find_features(frame.right, {}), frame.right.size())};
}

/// The room's wall ahead is 8 m away, the floor 1.6 m below, ...: the disparity of a pixel from the room's middle.
double true_disparity(const cv::Point& pixel) {
  const StereoCamera camera = test::room_camera();
  const double x = (pixel.x - camera.cx) / camera.focal;
  const double y = (pixel.y - camera.cy) / camera.focal;
  const double depth = std::min({8.0, 3.0 / std::abs(x), y > 0.0 ? 1.6 / y : 1.5 / -y});
  return camera.focal * camera.baseline / depth;
}

const Frame& first() {
  static const Frame frame = test::render_room(Eigen::Isometry3d::Identity(), 0);
  return frame;
}

Keyframe keyframe_of_first() { return make_keyframe(smooth(first()), find_stereo_features(first()), 0.0, {}); }

double median(std::vector<double> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

TEST(MakeKeyframe, KnowsDisparitiesToTenthsOfAPixelAndTellsHowWell) {
  const Keyframe keyframe = keyframe_of_first();
  ASSERT_GT(keyframe.points.size(), 60U);
  std::vector<double> errors;
  std::vector<double> ratios;
  for (const MapPoint& point : keyframe.points) {
    errors.push_back(std::abs(point.disparity - true_disparity(point.patch.centre)));
    ratios.push_back(errors.back() / std::sqrt(point.variance));
  }
  EXPECT_LT(median(errors), 0.08);
  EXPECT_NEAR(median(ratios), 0.67, 0.45) << "the median of a Gaussian's absolute errors is 0.67 standard deviations";
}

TEST(MakeKeyframe, SeesThatTheFloorSlopes) {
  int floor_points = 0;
  for (const MapPoint& point : keyframe_of_first().points) {
    const cv::Point centre = point.patch.centre;
    if (centre.y < 150 || std::abs(centre.x - 160) > 60) continue;
    ++floor_points;
    // d = f b / z and z = 1.6 f / (v - cy): the slope is b / 1.6 px per row.
    EXPECT_NEAR(point.slope.y(), 0.15 / 1.6, 0.05);
    EXPECT_NEAR(point.slope.x(), 0.0, 0.05);
  }
  EXPECT_GT(floor_points, 3);
}

TEST(MakeKeyframe, HasNoPointsWithoutTexture) {
  const Frame blank =
      make_frame(cv::Mat1b(test::room_size(), uchar{90}), cv::Mat1b(test::room_size(), uchar{90}), test::room_camera());
  EXPECT_TRUE(make_keyframe(smooth(blank), find_stereo_features(blank), 0.0, {}).points.empty());
}

TEST(FindSightings, FindsPointsWhereTheTrueMotionPutsThem) {
  const Eigen::Isometry3d world_from_camera = test::make_pose(0.1, 0.05, 0.2, 2.0, 1.0);
  const Eigen::Isometry3d motion = world_from_camera.inverse();
  const std::vector<Keyframe> keyframes = {keyframe_of_first()};
  const auto sightings =
      find_sightings(keyframes, smooth(test::render_room(world_from_camera, 1)), test::room_camera(), motion, 0.0);
  ASSERT_GT(sightings.size(), keyframes[0].points.size() / 2);
  std::vector<double> errors;
  for (const Sighting& sighting : sightings) errors.push_back(compute_error(sighting.observation, test::room_camera(), motion));
  EXPECT_LT(median(errors), 3.0) << "1.8 standard deviations, if the noise were exactly as expected";
}

TEST(FindSightings, FindsNoneBehindTheCamera) {
  const std::vector<Keyframe> keyframes = {keyframe_of_first()};
  const Eigen::Isometry3d turned = test::make_pose(0.0, 0.0, 0.0, 180.0);
  EXPECT_TRUE(find_sightings(keyframes, smooth(first()), test::room_camera(), turned, 0.0).empty());
  EXPECT_TRUE(find_sightings({}, smooth(first()), test::room_camera(), Eigen::Isometry3d::Identity(), 0.0).empty());
}

TEST(MoveOn, ImprovesDisparitiesByWhatIsSeenLater) {
  std::vector<Keyframe> keyframes = {keyframe_of_first()};
  const auto error = [&] {
    double squares = 0.0;
    for (const MapPoint& point : keyframes[0].points)
      squares += std::pow(point.disparity - true_disparity(point.patch.centre), 2);
    return std::sqrt(squares / static_cast<double>(keyframes[0].points.size()));
  };
  const double before = error();
  for (int frame = 1; frame <= 4; ++frame) {
    MotionFit fit;
    fit.current_from_previous = test::make_pose(0.0, 0.0, 0.06).inverse();
    const auto picture = smooth(test::render_room(test::make_pose(0.0, 0.0, 0.06 * frame), frame));
    const auto sightings = find_sightings(keyframes, picture, test::room_camera(), fit.current_from_previous, 0.0);
    keyframes = move_on(std::move(keyframes), sightings, test::room_camera(), fit, 6.0);
    EXPECT_GT(keyframes[0].inliers, 40);
  }
  EXPECT_LT(error(), 0.9 * before);
  EXPECT_TRUE(keyframes[0].frame_from_keyframe.isApprox(test::make_pose(0.0, 0.0, 0.24).inverse(), 1e-9));
}

}  // namespace
}  // namespace brink
