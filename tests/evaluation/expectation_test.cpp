#include <string>

#include <gtest/gtest.h>

#include "brink/envelope.hpp"
#include "brink/evaluation.hpp"

namespace brink {
namespace {

const StereoCamera kCamera{350.0, 319.5, 179.5, 0.15};
const cv::Size kSize(640, 360);

/// A camera 1.6 m over the ground, looking down by 25 degrees and rolled by 5, and a hole of 1x1 m straight ahead.
FrameTruth make_truth(int frame, double distance_m, double depth_m) {
  const Viewpoint viewpoint = make_viewpoint(kCamera, kSize, {.height_m = 1.6, .pitch_deg = 25.0, .roll_deg = 5.0});
  const GroundPose& pose = viewpoint.ground.pose;
  const Drop drop = make_drop(distance_m, depth_m, {});
  VisibleInstance instance;
  instance.id = 1;
  instance.depth_m = depth_m;
  instance.distance_m = distance_m;
  for (const Eigen::Vector2d& p : drop.rim) {
    instance.opening.emplace_back(p.x() * pose.right + p.y() * pose.forward + pose.height_m * pose.down);
  }
  FrameTruth truth;
  truth.frame = frame;
  truth.time = frame / 15.0;
  truth.camera = kCamera;
  const cv::Mat1f ground = compute_drop_disparity(make_drop(distance_m, 1e-6, {}), viewpoint);
  truth.negative = cv::Mat1b(compute_drop_disparity(drop, viewpoint) < ground - 0.01F) & 1;
  instance.visible_px = cv::countNonZero(truth.negative);
  truth.instances = {instance};
  return truth;
}

Detection make_detection(int frame, std::optional<double> disparity_sd_px) {
  Detection detection;
  detection.frame = frame;
  detection.ground.state = GroundState::seen;
  detection.disparity_sd_px = disparity_sd_px;
  return detection;
}

/// Whether the hole is expected in each frame of a walk past it.
std::vector<std::optional<bool>> expect_hole(const std::vector<double>& distances_m, double depth_m, double disparity_sd_px) {
  SequenceEvaluator evaluator("walk");
  for (std::size_t i = 0; i < distances_m.size(); ++i) {
    const int frame = static_cast<int>(i);
    evaluator.add(make_truth(frame, distances_m[i], depth_m), make_detection(frame, disparity_sd_px));
  }
  std::vector<std::optional<bool>> expected;
  const SequenceScore score = evaluator.finish();
  for (const FrameScore& frame : score.frames) expected.push_back(frame.instances.at(0).expected);
  return expected;
}

TEST(Expectation, NeedsAsManyFramesInTheEnvelopeAsATrackDoes) {
  const std::vector<double> near(6, 2.0);
  EXPECT_EQ(expect_hole(near, 0.5, 0.1), (std::vector<std::optional<bool>>{false, false, false, false, true, true}));
}

// 0.5 m at 4 m, through an opening of 1 m: 1.6 * 1 / 4 = 0.4 m show. At dusk it must be 0.26 m. Five times the noise is too
// much.
TEST(Expectation, GoesByTheNoiseThatTheDetectionTells) {
  const std::vector<double> far(5, 4.0);
  EXPECT_EQ(expect_hole(far, 0.5, 0.1).back(), true);
  EXPECT_EQ(expect_hole(far, 0.5, 0.5).back(), false);
}

TEST(Expectation, EndsWithOneFrameOutOfTheEnvelope) {
  std::vector<double> distances(8, 2.0);
  distances[5] = 7.9;
  EXPECT_EQ(expect_hole(distances, 0.16, 0.2),
            (std::vector<std::optional<bool>>{false, false, false, false, true, false, false, false}));
}

TEST(Expectation, IsNotKnownWithoutNoiseCameraOrRim) {
  FrameTruth no_camera = make_truth(1, 2.0, 0.5);
  no_camera.camera.reset();
  FrameTruth no_rim = make_truth(2, 2.0, 0.5);
  no_rim.instances[0].opening.clear();
  SequenceEvaluator evaluator("walk");
  evaluator.add(make_truth(0, 2.0, 0.5), make_detection(0, std::nullopt));
  evaluator.add(no_camera, make_detection(1, 0.1));
  evaluator.add(no_rim, make_detection(2, 0.1));
  const SequenceScore score = evaluator.finish();
  for (const FrameScore& frame : score.frames) EXPECT_FALSE(frame.instances.at(0).expected.has_value()) << frame.frame;
}

}  // namespace
}  // namespace brink
