#include "brink/detector.hpp"

#include <limits>
#include <stdexcept>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>
#include <tbb/global_control.h>

#include "brink/detections.hpp"
#include "synthetic_scene.hpp"

namespace brink {
namespace {

std::string json_without_times(Detection detection) {
  detection.times = {};
  return to_json_line(detection);
}

DetectorParams stills(DetectorParams params = {}) {
  params.stills = true;
  return params;
}

TEST(Detector, FindsTheGroundOfARolledCameraInPictures) {
  const StereoCamera camera = test::half_size_camera();
  Detector detector(stills());
  for (const double roll : {0.0, 10.0, -10.0}) {
    SCOPED_TRACE(roll);
    const Frame frame = test::make_ground_frame(camera, test::half_size(), make_ground_plane(1.6, 30.0, roll, camera));
    const Detection detection = detector.process(frame);
    EXPECT_EQ(detection.status, FrameStatus::ok);
    ASSERT_EQ(detection.ground.state, GroundState::seen) << detection.ground.reason;
    EXPECT_NEAR(detection.ground.pose.height_m, 1.6, 0.016);
    EXPECT_NEAR(detection.ground.pose.pitch_deg, 30.0, 0.3);
    EXPECT_NEAR(detection.ground.pose.roll_deg, roll, 0.3);
    EXPECT_TRUE(detection.candidates.empty());
    fmt::print("roll {}: height {:.4f} m of 1.6, pitch {:.3f} of 30, roll {:.3f} deg\n", roll, detection.ground.pose.height_m,
               detection.ground.pose.pitch_deg, detection.ground.pose.roll_deg);
  }
}

TEST(Detector, PicturesWithoutGroundSaySo) {
  const StereoCamera camera = test::half_size_camera();
  Detector detector(stills());
  for (const int grey : {0, 128, 255}) {
    const cv::Mat1b picture(test::half_size(), static_cast<uchar>(grey));
    const Detection detection = detector.process(make_frame(picture, picture, camera));
    EXPECT_EQ(detection.status, FrameStatus::ok);
    EXPECT_EQ(detection.ground.state, GroundState::not_visible);
    EXPECT_FALSE(detection.ground.reason.empty());
    EXPECT_TRUE(detection.obstacles.empty());
    EXPECT_EQ(detection.disparity.size(), test::half_size());
    EXPECT_TRUE(detection.elevation.empty());
  }
}

/// A picture with a black hole in it: 0.5 m x 0.9 m, rim 2.2 m away.
Frame make_hole_frame() {
  const StereoCamera camera = test::half_size_camera();
  const GroundPlane plane = make_ground_plane(1.6, 30.0, 0.0, camera);
  Frame frame = test::make_ground_frame(camera, test::half_size(), plane);
  const GroundPose pose = compute_ground_pose(plane, camera);
  const auto in_hole = [&](const Eigen::Vector3d& point) {
    return test::Opening{2.2, 2.7, -0.3, 0.6, 1.0}.contains(pose.forward.dot(point), pose.right.dot(point));
  };
  for (int v = 0; v < frame.left.rows; ++v) {
    for (int u = 0; u < frame.left.cols; ++u) {
      const auto point = pose.intersect(u, v, camera);
      if (!point) continue;
      if (in_hole(*point)) frame.left(v, u) = 4;
      if (in_hole(*point + Eigen::Vector3d(camera.baseline, 0.0, 0.0))) frame.right(v, u) = 4;
    }
  }
  return frame;
}

TEST(Detector, ABlackHoleIsReportedInStillsOnly) {
  DetectorParams params;
  const Frame frame = make_hole_frame();
  const Detection walking = Detector(params).process(frame);
  EXPECT_TRUE(walking.obstacles.empty());
  EXPECT_EQ(walking.tracks.size(), 1U);

  params.stills = true;
  const Detection still = Detector(params).process(frame);
  ASSERT_EQ(still.obstacles.size(), 1U);
  EXPECT_TRUE(still.tracks.empty());
  EXPECT_EQ(still.obstacles[0].track_length, 1);
  const Candidate& hole = still.obstacles[0].candidate;
  EXPECT_EQ(hole.type, CandidateType::no_disparity);
  EXPECT_NEAR(hole.distance_m, 2.2, 0.1);
  EXPECT_NEAR(hole.width_m, 0.9, 0.2);
}

TEST(Detector, ObstaclesFartherThanTheReportRangeStayTracks) {
  DetectorParams params;
  params.stills = true;
  params.report_range_m = 2.0;
  const Detection detection = Detector(params).process(make_hole_frame());
  EXPECT_TRUE(detection.obstacles.empty());
  EXPECT_EQ(detection.tracks.size(), 1U);
}

TEST(Detector, IsTheSameForAnyNumberOfThreadsAndFromRunToRun) {
  const Frame frame = make_hole_frame();
  for (const DetectorParams& params : {stills(DetectorParams::brink()), stills(DetectorParams::paper())}) {
    Detector detector(params);
    const Detection first = detector.process(frame);
    EXPECT_EQ(json_without_times(first), json_without_times(detector.process(frame))) << "second run";
    for (const std::size_t threads : {1U, 2U, 4U}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      const Detection again = Detector(params).process(frame);
      EXPECT_EQ(json_without_times(first), json_without_times(again)) << threads << " threads";
      EXPECT_EQ(cv::norm(first.disparity, again.disparity, cv::NORM_INF), 0.0) << threads << " threads";
    }
  }
}

/// Frame number `index` of a walk at 15 frames per second, the camera's pose being known.
Frame at_pose(const Frame& frame, int index, const Eigen::Isometry3d& world_from_camera) {
  Frame copy = frame;
  copy.index = index;
  copy.time = index / 15.0;
  copy.world_from_camera = world_from_camera;
  return copy;
}

const Eigen::Isometry3d kRest = Eigen::Isometry3d::Identity();

/// Expects a hole that does not move to be reported from so many sightings on.
void expect_validated_at(int sightings, const DetectorParams& params) {
  const Frame frame = make_hole_frame();
  Detector detector(params);
  for (int i = 0; i < sightings + 2; ++i) {
    const bool validated = i + 1 >= sightings;
    const Detection detection = detector.process(at_pose(frame, i, kRest));
    EXPECT_EQ(detection.ego_motion_state, i == 0 ? EgoMotionState::failed : EgoMotionState::given);
    ASSERT_EQ(detection.obstacles.size(), validated ? 1U : 0U) << i;
    ASSERT_EQ(detection.tracks.size(), validated ? 0U : 1U) << i;
    const NegativeObstacle& hole = validated ? detection.obstacles[0] : detection.tracks[0];
    EXPECT_EQ(hole.id, 1);
    EXPECT_EQ(hole.track_length, i + 1);
  }
}

TEST(Detector, ValidatesAHoleAtItsFifthSightingByThePapersRules) { expect_validated_at(5, DetectorParams::paper()); }

TEST(Detector, ValidatesABlackHoleAtItsFifthSightingToo) { expect_validated_at(5, DetectorParams::brink()); }

// The pictures stay the same while the poses say that the camera walks on: that cannot be the same hole.
TEST(Detector, DoesNotFollowWhatContradictsTheMotion) {
  const Frame frame = make_hole_frame();
  Detector detector;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Isometry3d walked(Eigen::Translation3d(0.0, 0.0, 0.6 * i));
    EXPECT_TRUE(detector.process(at_pose(frame, i, walked)).obstacles.empty()) << i;
  }
}

TEST(Detector, StartsAnewAfterAFrameThatFailedByThePapersRules) {
  const Frame frame = make_hole_frame();
  Detector detector(DetectorParams::paper());
  for (int i = 0; i < 5; ++i) (void)detector.process(at_pose(frame, i, kRest));
  const Detection failed = detector.process_failed(5, 5 / 15.0, FrameStatus::bad_frame, "x.png: is damaged");
  EXPECT_TRUE(failed.obstacles.empty());
  EXPECT_EQ(failed.ground.state, GroundState::not_visible);
  const Detection next = detector.process(at_pose(frame, 6, kRest));
  ASSERT_EQ(next.tracks.size(), 1U);
  EXPECT_EQ(next.tracks[0].track_length, 1);
}

TEST(Detector, GoesOnAfterAFrameThatFailed) {
  const Frame frame = make_hole_frame();
  Detector detector;
  for (int i = 0; i < 5; ++i) (void)detector.process(at_pose(frame, i, kRest));
  EXPECT_TRUE(detector.process_failed(5, 5 / 15.0, FrameStatus::bad_frame, "x.png: is damaged").obstacles.empty());
  const Detection next = detector.process(at_pose(frame, 6, kRest));
  ASSERT_EQ(next.obstacles.size(), 1U);
  EXPECT_EQ(next.obstacles[0].id, 1);
  EXPECT_EQ(next.obstacles[0].track_length, 6);
}

TEST(Detector, RefusesFramesOutOfOrder) {
  const Frame frame = make_hole_frame();
  Detector detector;
  (void)detector.process(at_pose(frame, 1, kRest));
  EXPECT_THROW((void)detector.process(at_pose(frame, 0, kRest)), std::invalid_argument);
}

/// Flat ground with a hole 0.5 m deep, as a depth sensor sees it that is carried in this way.
cv::Mat1f hole_disparity(double height_m = 1.6, double pitch_deg = 30.0, double rim_m = 2.2) {
  const StereoCamera camera = test::half_size_camera();
  const GroundPlane plane = make_ground_plane(height_m, pitch_deg, 0.0, camera);
  return test::make_disparity(camera, test::half_size(), plane, {{rim_m, rim_m + 0.7, -0.3, 0.6, 0.5}});
}

TEST(Detector, GoesOnReportingALittleBeyondTheReportRange) {
  DetectorParams params;
  params.report_range_m = 2.1;
  const cv::Mat1b bright(test::half_size(), uchar{120});
  for (const double slack_m : {0.0, 0.5}) {
    params.report_slack_m = slack_m;
    Detector detector(params);
    int index = 0;
    const auto is_reported = [&](double rim_m) {
      const Frame frame = make_frame_with_disparity(bright, hole_disparity(1.6, 30.0, rim_m), test::half_size_camera());
      return !detector.process(at_pose(frame, index++, kRest)).obstacles.empty();
    };
    for (int i = 0; i < 5; ++i) EXPECT_FALSE(is_reported(2.3)) << "never reported yet";
    for (int i = 0; i < 2; ++i) EXPECT_TRUE(is_reported(2.0));
    for (int i = 0; i < 2; ++i) EXPECT_EQ(is_reported(2.3), slack_m > 0.0);
    EXPECT_FALSE(is_reported(2.7)) << "beyond the slack";
    EXPECT_FALSE(is_reported(2.3)) << "no longer reported";
  }
}

TEST(Detector, TakesAGivenDisparityInPlaceOfMatching) {
  const cv::Mat1f disparity = hole_disparity();
  const cv::Mat1b bright(test::half_size(), uchar{120});
  const Detection detection =
      Detector(stills()).process(make_frame_with_disparity(bright, disparity, test::half_size_camera()));
  EXPECT_EQ(cv::norm(detection.disparity, disparity, cv::NORM_INF), 0.0);
  EXPECT_EQ(detection.no_disparity_off, "");
  ASSERT_EQ(detection.obstacles.size(), 1U);
  const Candidate& hole = detection.obstacles[0].candidate;
  EXPECT_EQ(hole.type, CandidateType::below_ground);
  EXPECT_NEAR(hole.distance_m, 2.2, 0.05);
  EXPECT_NEAR(hole.depth_m.value(), 0.5, 0.05);
}

TEST(Detector, FindsABlackHoleWithoutDisparityOnlyWhereThereIsAPicture) {
  const Frame frame = make_hole_frame();
  const cv::Mat1b black(frame.left == 4);
  cv::Mat1f disparity = test::make_disparity(frame.camera, test::half_size(), make_ground_plane(1.6, 30.0, 0.0, frame.camera));
  disparity.setTo(kInvalidDisparity, black);
  const Detection seen = Detector(stills()).process(make_frame_with_disparity(frame.left, disparity, frame.camera));
  EXPECT_EQ(seen.no_disparity_off, "");
  ASSERT_EQ(seen.obstacles.size(), 1U);
  EXPECT_EQ(seen.obstacles[0].candidate.type, CandidateType::no_disparity);

  const Detection blind = Detector(stills()).process(make_frame_with_disparity({}, disparity, frame.camera));
  EXPECT_EQ(blind.no_disparity_off, "no left picture");
  EXPECT_TRUE(blind.obstacles.empty());
  EXPECT_TRUE(blind.rejected.empty()) << "what is not looked for is not rejected either";
}

/// Frame number `index` of a depth sensor without pictures.
Frame depth_frame(const cv::Mat1f& disparity, int index) {
  return make_frame_with_disparity({}, disparity, test::half_size_camera(), index, index / 15.0);
}

TEST(Detector, FollowsAlongTheGroundWithoutPictures) {
  Detector detector;
  for (int i = 0; i < 6; ++i) {
    // The head rises and nods: without aligned grounds the hole would jump by 0.6 m a frame.
    const double nod = i % 2 == 0 ? 0.0 : 1.0;
    const Detection detection = detector.process(depth_frame(hole_disparity(1.5 + 0.1 * nod, 25.0 + 10.0 * nod), i));
    EXPECT_EQ(detection.ego_motion_state, i == 0 ? EgoMotionState::failed : EgoMotionState::ground) << i;
    const auto& followed = i < 2 ? detection.tracks : detection.obstacles;
    ASSERT_EQ(followed.size(), 1U) << i;
    EXPECT_EQ(followed[0].id, 1);
    EXPECT_EQ(followed[0].track_length, i + 1);
  }
}

/// Frames 0 to 2 show a hole, so many from 3 on no ground, the next one the hole again.
Detection look_away(Detector& detector, int blind_frames) {
  for (int i = 0; i < 3; ++i) (void)detector.process(depth_frame(hole_disparity(), i));
  const cv::Mat1f nothing(test::half_size(), kInvalidDisparity);
  for (int i = 0; i < blind_frames; ++i) (void)detector.process(depth_frame(nothing, 3 + i));
  return detector.process(depth_frame(hole_disparity(), 3 + blind_frames));
}

TEST(Detector, GoesOnForAMomentWhereGroundsCannotBeAligned) {
  Detector detector;
  const Detection after = look_away(detector, 1);
  EXPECT_EQ(after.ego_motion_state, EgoMotionState::failed);
  ASSERT_EQ(after.obstacles.size(), 1U);
  EXPECT_EQ(after.obstacles[0].track_length, 4);
  EXPECT_FALSE(after.obstacles[0].time_to_edge_s) << "the walk is not known";
  Detector other;
  const Detection late = look_away(other, 20);  // longer than tracking.max_coast_s
  ASSERT_EQ(late.tracks.size(), 1U);
  EXPECT_EQ(late.tracks[0].track_length, 1);
}

TEST(Detector, EndsTracksWhereGroundsCannotBeAlignedByThePapersRules) {
  Detector detector(DetectorParams::paper());
  for (int i = 0; i < 3; ++i) (void)detector.process(depth_frame(hole_disparity(), i));
  const Detection blind = detector.process(depth_frame(cv::Mat1f(test::half_size(), kInvalidDisparity), 3));
  EXPECT_EQ(blind.status, FrameStatus::ok);
  EXPECT_EQ(blind.ground.state, GroundState::not_visible);
  EXPECT_FALSE(blind.ground.reason.empty());
  EXPECT_EQ(blind.ego_motion_state, EgoMotionState::failed);
  EXPECT_EQ(blind.ego_motion.reason, "no left picture, and not a ground in both this frame and the last one");
  const Detection after = detector.process(depth_frame(hole_disparity(), 4));
  EXPECT_EQ(after.ego_motion_state, EgoMotionState::failed);
  ASSERT_EQ(after.tracks.size(), 1U);
  EXPECT_EQ(after.tracks[0].track_length, 1);
}

// What was validated too far away to be told, and is not seen since, is no news.
TEST(Detector, RemembersOnlyWhatItTold) {
  const auto walk_blindly = [](double report_range_m) {
    DetectorParams params;
    params.report_range_m = report_range_m;
    params.report_slack_m = 0.0;
    Detector detector(params);
    Detection detection;
    const StereoCamera camera = test::half_size_camera();
    const cv::Mat1f level = test::make_disparity(camera, test::half_size(), make_ground_plane(1.6, 30.0, 0.0, camera));
    for (int i = 0; i < 8; ++i) {
      const double walked_m = 0.1 * i;
      const Eigen::Vector3d ahead(0.0, -0.5, std::sqrt(0.75));
      cv::Mat1f disparity = hole_disparity(1.6, 30.0, 3.0 - walked_m);
      if (i >= 5) disparity.setTo(kInvalidDisparity, disparity != level);
      detection =
          detector.process(at_pose(depth_frame(disparity, i), i, Eigen::Isometry3d(Eigen::Translation3d(walked_m * ahead))));
    }
    return detection;
  };
  const Detection told = walk_blindly(5.0);
  ASSERT_EQ(told.obstacles.size(), 1U);
  EXPECT_GT(told.obstacles[0].unseen_s, 0.0);
  const Detection never_told = walk_blindly(2.45);  // seen last at 2.6 m, now remembered at 2.3 m
  EXPECT_TRUE(never_told.obstacles.empty());
  EXPECT_EQ(never_told.tracks.size(), 1U);
}

TEST(Detector, TellsTheTimeToAnEdgeThatIsWalkedTo) {
  for (const double path_width_m : {0.6, 0.0}) {
    DetectorParams params;
    params.path_width_m = path_width_m;
    Detector detector(params);
    Detection detection;
    for (int i = 0; i < 12; ++i) {
      const double walked_m = 0.08 * i;  // 1.2 m/s, the camera looking 30 degrees down
      const Eigen::Vector3d ahead(0.0, -0.5, std::sqrt(0.75));
      const Frame frame = depth_frame(hole_disparity(1.6, 30.0, 3.0 - walked_m), i);
      detection = detector.process(at_pose(frame, i, Eigen::Isometry3d(Eigen::Translation3d(walked_m * ahead))));
    }
    ASSERT_EQ(detection.obstacles.size(), 1U);
    ASSERT_EQ(detection.obstacles[0].time_to_edge_s.has_value(), path_width_m > 0.0);
    const double expected_s = (3.0 - 11 * 0.08) / 1.2;
    EXPECT_NEAR(detection.obstacles[0].time_to_edge_s.value_or(expected_s), expected_s, 0.05);
  }
}

TEST(Detector, GivenPosesComeBeforeAlignedGrounds) {
  Detector detector;
  (void)detector.process(at_pose(depth_frame(hole_disparity(), 0), 0, kRest));
  EXPECT_EQ(detector.process(at_pose(depth_frame(hole_disparity(), 1), 1, kRest)).ego_motion_state, EgoMotionState::given);
}

TEST(Detector, NeverAlignsGroundsInPlaceOfAMeasurementThatFailed) {
  Detector detector;
  const cv::Mat1b blank(test::half_size(), uchar{120});  // nothing to follow
  for (int i = 0; i < 2; ++i) {
    const Frame frame = make_frame_with_disparity(blank, hole_disparity(), test::half_size_camera(), i, i / 15.0);
    EXPECT_EQ(detector.process(frame).ego_motion_state, EgoMotionState::failed);
  }
}

TEST(Detector, RefusesFramesThatMakeFrameWouldRefuse) {
  Detector detector(stills());
  EXPECT_THROW((void)detector.process({}), std::invalid_argument);
  Frame frame = depth_frame(hole_disparity(), 0);
  frame.disparity(5, 5) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW((void)detector.process(frame), std::invalid_argument);
}

TEST(Detector, PaperMethodUsesWholeDisparitiesAndNoRulesOfOurs) {
  const DetectorParams params = DetectorParams::paper();
  EXPECT_FALSE(params.disparity.elas.subpixel);
  EXPECT_EQ(params.disparity.elas.match_margin, 0.0);
  EXPECT_EQ(params.candidates.rim_depth_ratio, 1.0);
  EXPECT_EQ(params.candidates.min_slope_deg, 0.0);
  EXPECT_EQ(params.candidates.border_px, 0);
}

TEST(Detector, WrongParametersAreNamed) {
  DetectorParams params;
  params.report_range_m = 0.0;
  try {
    const Detector detector(params);
    FAIL() << "report_range_m = 0 was taken";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "detector.report_range_m = 0, must be above 0 to 1000");
  }
}

TEST(Detector, AFailedFrameKeepsItsReason) {
  const Detection detection = make_failed_detection(7, 0.5, FrameStatus::no_picture, "image_3/000007.png: missing");
  EXPECT_EQ(detection.frame, 7);
  EXPECT_EQ(detection.time, 0.5);
  EXPECT_EQ(detection.status, FrameStatus::no_picture);
  EXPECT_EQ(detection.reason, "image_3/000007.png: missing");
  EXPECT_EQ(detection.ground.state, GroundState::not_visible);
}

}  // namespace
}  // namespace brink
