#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "brink/candidates.hpp"
#include "expect_error.hpp"
#include "synthetic_scene.hpp"

namespace brink {
namespace {

/// Flat ground seen from 1.6 m, 30 degrees down, with openings that are looked for by the paper's rules.
struct Scene {
  explicit Scene(const std::vector<test::Opening>& openings) {
    plane = make_ground_plane(1.6, 30.0, 0.0, camera);
    pose = compute_ground_pose(plane, camera);
    disparity = test::make_disparity(camera, test::half_size(), plane, openings);
    elevation = compute_elevation(disparity, plane, camera);
    frame = make_frame(cv::Mat3b(test::half_size(), cv::Vec3b(100, 110, 120)), cv::Mat1b(test::half_size(), 110), camera);
  }
  /// A post in front of everything, nearer than the ground behind it.
  void put_post(const cv::Rect& box) {
    disparity(box).setTo(60.0F);
    elevation = compute_elevation(disparity, plane, camera);
  }
  [[nodiscard]] std::vector<Candidate> find_parts() const {
    GroundSurface surface;
    surface.plane = plane;
    surface.pose = pose;
    CandidateParams params = CandidateParams::paper();
    params.min_touching_px = 0;  // at the lower border a hole may touch no ground
    std::vector<Candidate> parts = select_below_ground(frame, disparity, elevation, surface, params);
    std::erase_if(parts, [](const Candidate& part) { return part.rejection.has_value(); });
    return parts;
  }
  [[nodiscard]] std::vector<Candidate> merge(std::vector<Candidate> parts, double gap_m = 0.3) const {
    CandidateParams params;
    params.merge_gap_m = gap_m;
    return merge_parts(std::move(parts), elevation, pose, camera, params);
  }

  StereoCamera camera = test::half_size_camera();
  GroundPlane plane;
  GroundPose pose;
  cv::Mat1f disparity;
  cv::Mat1f elevation;
  Frame frame;
};

constexpr test::Opening kHole{2.0, 3.0, -0.6, 0.6, 1.0};

/// A hole behind a post that is six pixels wide.
Scene behind_a_post() {
  Scene scene({kHole});
  scene.put_post({317, 0, 6, 360});
  return scene;
}

TEST(MergeParts, MakesOneOfAHoleBehindAPost) {
  const Scene scene = behind_a_post();
  const std::vector<Candidate> parts = scene.find_parts();
  ASSERT_EQ(parts.size(), 2U);
  const std::vector<Candidate> merged = scene.merge(parts);
  ASSERT_EQ(merged.size(), 1U);
  EXPECT_EQ(merged[0].area_px, parts[0].area_px + parts[1].area_px);
  EXPECT_EQ(merged[0].rim.size(), parts[0].rim.size() + parts[1].rim.size());
  EXPECT_DOUBLE_EQ(merged[0].distance_m, std::min(parts[0].distance_m, parts[1].distance_m));
  EXPECT_NEAR(merged[0].width_m, 1.2, 0.1) << "of both, not of one";
  EXPECT_EQ(merged[0].types, std::vector{CandidateType::below_ground});
  const std::vector<Eigen::Vector3d>& points = merged[0].contour_3d;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) mean += point / static_cast<double>(points.size());
  EXPECT_LT((merged[0].centroid - mean).norm(), 1e-9);
}

TEST(MergeParts, DrawsOneOutlineAroundAllParts) {
  const Scene scene = behind_a_post();
  const std::vector<Candidate> parts = scene.find_parts();
  const Candidate merged = scene.merge(parts)[0];
  cv::Mat1b filled(test::half_size(), uchar{0});
  cv::fillPoly(filled, std::vector{merged.contour}, cv::Scalar(255));
  for (const Candidate& part : parts) {
    for (const cv::Point& p : part.contour) EXPECT_NE(filled(p), 0) << p;
  }
  EXPECT_LT(cv::countNonZero(filled), merged.area_px + 100) << "a bridge, not the hull";
}

TEST(MergeParts, LeavesHolesApartBetweenWhichGroundIsSeen) {
  const Scene scene({{2.0, 3.0, -0.7, -0.1, 1.0}, {2.0, 3.0, 0.1, 0.7, 1.0}});
  EXPECT_EQ(scene.merge(scene.find_parts()).size(), 2U);
}

TEST(MergeParts, LeavesPartsApartThatAreFarFromEachOther) {
  Scene scene({kHole});
  scene.put_post({270, 0, 100, 360});  // 0.7 m of the hole
  const std::vector<Candidate> parts = scene.find_parts();
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(scene.merge(parts).size(), 2U);
  EXPECT_EQ(scene.merge(parts, 1.5).size(), 1U);
  EXPECT_EQ(behind_a_post().merge(behind_a_post().find_parts(), 0.0).size(), 2U) << "0 = never";
}

TEST(MergeParts, TellsTheTypesOfAllPartsAndTheLargerOnesFirst) {
  const Scene scene = behind_a_post();
  std::vector<Candidate> parts = scene.find_parts();
  parts[0].type = CandidateType::no_disparity;
  parts[0].depth_m.reset();
  parts[0].area_px = parts[1].area_px - 1;
  const Candidate merged = scene.merge(parts)[0];
  EXPECT_EQ(merged.type, CandidateType::below_ground);
  EXPECT_EQ(merged.types, (std::vector{CandidateType::below_ground, CandidateType::no_disparity}));
  EXPECT_EQ(merged.depth_m, parts[1].depth_m);
}

TEST(MergeParts, StaysWithinThePicture) {
  Scene scene({{0.5, 1.4, -0.6, 0.6, 1.0}});  // runs out of the lower border
  scene.put_post({317, 0, 6, 360});
  const std::vector<Candidate> parts = scene.find_parts();
  ASSERT_EQ(parts.size(), 2U);
  const cv::Rect picture({0, 0}, test::half_size());
  const Candidate merged = scene.merge(parts)[0];
  for (const cv::Point& p : merged.contour) EXPECT_TRUE(picture.contains(p)) << p;
}

TEST(MergeParts, HasNothingToMergeInNothing) {
  const Scene scene({});
  EXPECT_TRUE(scene.merge({}).empty());
  test::expect_line_with(test::error_of<std::invalid_argument>([&] { (void)scene.merge({}, -1.0); }),
                         "candidates.merge_gap_m = -1, must be 0 to 10");
}

}  // namespace
}  // namespace brink
