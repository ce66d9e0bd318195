#include <algorithm>
#include <limits>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "brink/overlay.hpp"
#include "overlay/marks.hpp"

namespace brink {
namespace {

const cv::Vec3b kNone(0, 0, 0);
const cv::Size kTopSize(640, 720);  // 100 px a metre, the camera at (320, 570)

// The camera 1 m over the ground, looking 45 degrees down.
Frame frame_over_ground() {
  Frame frame;
  frame.left = cv::Mat1b(240, 320, uchar{100});
  frame.right = frame.left;
  frame.camera = {200.0, 160.0, 120.0, 0.15};
  return frame;
}

Detection flat_ground(const Frame& frame) {
  Detection detection;
  detection.ground.state = GroundState::seen;
  detection.ground.plane = make_ground_plane(1.0, 45.0, 0.0, frame.camera);
  detection.ground.pose = compute_ground_pose(*detection.ground.plane, frame.camera);
  detection.disparity = cv::Mat1f(frame.left.size(), 20.0F);
  detection.elevation = cv::Mat1f(frame.left.size(), 0.0F);
  return detection;
}

// A square opening of 20 cm on the ground, its middle `forward` m ahead and `right` m to the right.
NegativeObstacle opening_at(const Frame& frame, const Detection& detection, double right, double forward) {
  const GroundPose& pose = detection.ground.pose;
  const auto point = [&](double across, double along) -> Eigen::Vector3d {
    return pose.height_m * pose.down + (right + across) * pose.right + (forward + along) * pose.forward;
  };
  NegativeObstacle obstacle;
  for (const auto& [across, along] : {std::pair{-0.1, -0.1}, {0.1, -0.1}, {0.1, 0.1}, {-0.1, 0.1}}) {
    const Eigen::Vector3d pixel = frame.camera.project(point(across, along));
    obstacle.candidate.contour.emplace_back(cvRound(pixel.x()), cvRound(pixel.y()));
  }
  obstacle.candidate.rim_nearest = point(0.0, -0.1);
  obstacle.candidate.distance_m = pose.distance(obstacle.candidate.rim_nearest);
  return obstacle;
}

bool is_red(const cv::Vec3b& pixel) { return pixel[2] > pixel[0] + 60 && pixel[2] > pixel[1] + 60; }
bool is_blue(const cv::Vec3b& pixel) { return pixel[0] > pixel[2] + 60; }
bool is_yellow(const cv::Vec3b& pixel) { return pixel[2] > 180 && pixel[1] > 150 && pixel[0] < 80; }

template <typename Test>
int count(const cv::Mat3b& picture, const cv::Rect& part, Test test) {
  const cv::Mat3b cut = picture(part).clone();
  return static_cast<int>(std::count_if(cut.begin(), cut.end(), test));
}

bool differ(const cv::Mat3b& one, const cv::Mat3b& other) { return cv::norm(one, other, cv::NORM_INF) > 0.0; }

TEST(DrawElevation, PaintsGroundGreenBelowRedAboveBlueAndNoneBlack) {
  cv::Mat1f elevation(240, 320, std::numeric_limits<float>::quiet_NaN());
  elevation(cv::Rect(0, 60, 100, 40)) = 0.05F;
  elevation(cv::Rect(0, 100, 100, 40)) = -0.2F;
  elevation(cv::Rect(0, 140, 100, 40)) = -7.0F;
  elevation(cv::Rect(0, 180, 100, 40)) = 0.3F;
  const cv::Mat3b picture = draw_elevation(elevation);
  EXPECT_EQ(picture(30, 50), kNone);
  EXPECT_GT(picture(80, 50)[1], picture(80, 50)[2] + 60);
  EXPECT_TRUE(is_red(picture(120, 50)));
  EXPECT_GT(picture(160, 50)[2], picture(160, 50)[1]);
  EXPECT_LT(picture(160, 50)[2], picture(120, 50)[2]);  // darker the deeper
  EXPECT_TRUE(is_blue(picture(200, 50)));
  EXPECT_NE(picture(120, 308), kNone);  // the scale
}

TEST(DrawElevation, DrawsAnythingThereIs) {
  EXPECT_TRUE(draw_elevation(cv::Mat1f()).empty());
  EXPECT_EQ(draw_elevation(cv::Mat1f(1, 1, 0.0F)).size(), cv::Size(1, 1));
  cv::Mat1f infinite(9, 13, std::numeric_limits<float>::infinity());
  EXPECT_EQ(draw_elevation(infinite).size(), cv::Size(13, 9));
}

TEST(DrawObstacles, DrawsTracksThinAndBlueAndNotFilled) {
  const Frame frame = frame_over_ground();
  Detection detection = flat_ground(frame);
  detection.tracks = {opening_at(frame, detection, 0.0, 1.0)};
  const cv::Mat3b picture = draw_obstacles(frame, detection);
  EXPECT_EQ(picture(120, 160), cv::Vec3b(100, 100, 100));
  EXPECT_GT(count(picture, {120, 80, 80, 80}, is_blue), 20);
  EXPECT_EQ(count(picture, {120, 80, 80, 80}, is_red), 0);
}

TEST(Labels, TellIdAndAgeOfWhatWasFollowedOnly) {
  NegativeObstacle obstacle;
  obstacle.id = 3;
  obstacle.candidate.distance_m = 2.34;
  EXPECT_EQ(label_of(obstacle), "2.3 m");
  obstacle.track_length = 9;
  EXPECT_EQ(label_of(obstacle), "2.3 m  #3 age 9");
}

TEST(Labels, AreKeptApart) {
  Labels labels;
  EXPECT_EQ(labels.place({10, 10}, {50, 20}), cv::Point(10, 10));
  EXPECT_EQ(labels.place({100, 10}, {50, 20}), cv::Point(100, 10));
  EXPECT_EQ(labels.place({20, 15}, {50, 20}), cv::Point(20, 30));
  EXPECT_EQ(labels.place({20, 15}, {50, 20}), cv::Point(20, 50));
}

TEST(DrawTopView, ShowsObstaclesAndTracksWhereTheyAre) {
  const Frame frame = frame_over_ground();
  Detection detection = flat_ground(frame);
  detection.obstacles = {opening_at(frame, detection, 0.0, 1.0)};
  detection.tracks = {opening_at(frame, detection, -0.5, 1.5)};
  const cv::Mat3b picture = draw_top_view(frame, detection, {}, kTopSize);
  EXPECT_TRUE(is_red(picture(470, 320)));
  EXPECT_EQ(picture(420, 270), kGroundSeen);  // inside of the track
  EXPECT_GT(count(picture, {255, 405, 30, 30}, is_blue), 20);
  EXPECT_EQ(count(picture, {255, 405, 30, 30}, is_red), 0);
  EXPECT_EQ(picture(480, 320), cv::Vec3b(255, 255, 255));  // the rim's nearest point, 0.9 m ahead
}

TEST(DrawTopView, ShowsGroundWhatLiesBelowItAndNothingElse) {
  const Frame frame = frame_over_ground();
  Detection detection = flat_ground(frame);
  const auto pixel_of = [&](double right, double forward) {
    const NegativeObstacle middle = opening_at(frame, detection, right, forward + 0.1);
    const Eigen::Vector3d pixel = frame.camera.project(middle.candidate.rim_nearest);
    return cv::Point(cvRound(pixel.x()), cvRound(pixel.y()));
  };
  const auto paint = [&](const cv::Point& at, float elevation) {
    detection.elevation(cv::Rect(at - cv::Point(4, 4), cv::Size(9, 9))) = elevation;
  };
  paint(pixel_of(0.0, 1.0), -0.5F);
  paint(pixel_of(0.4, 1.0), 0.5F);
  paint(pixel_of(-0.4, 1.0), std::numeric_limits<float>::quiet_NaN());
  const cv::Mat3b picture = draw_top_view(frame, detection, {}, kTopSize);
  EXPECT_EQ(picture(450, 300), kGroundSeen);
  EXPECT_EQ(picture(466, 320), kBelowSeen);
  EXPECT_EQ(picture(466, 360), kNothingSeen);
  EXPECT_EQ(picture(466, 280), kNothingSeen);
  EXPECT_EQ(picture(640, 320), kNothingSeen);  // behind the camera
}

TEST(DrawTopView, DrawsThePathBehindTheCamera) {
  const Frame frame = frame_over_ground();
  const Detection detection = flat_ground(frame);
  const GroundPose& pose = detection.ground.pose;
  const std::vector<Eigen::Vector3d> path{-1.0 * pose.forward + 0.5 * pose.right, -0.5 * pose.forward + 0.5 * pose.right};
  const cv::Mat3b picture = draw_top_view(frame, detection, path, kTopSize);
  EXPECT_TRUE(is_yellow(picture(645, 370)));  // 0.75 m back, 0.5 m to the right
  EXPECT_FALSE(is_yellow(draw_top_view(frame, detection, {}, kTopSize)(645, 370)));
}

TEST(DrawTopView, ShowsRingsOnlyWithoutAGround) {
  Detection detection;
  detection.obstacles = {NegativeObstacle{}};
  const cv::Mat3b picture = draw_top_view(frame_over_ground(), detection, {{0.0, 0.0, -1.0}}, kTopSize);
  EXPECT_EQ(picture.size(), kTopSize);
  EXPECT_NE(picture(470, 320), kNothingSeen);  // the ring at 1 m
  EXPECT_EQ(count(picture, {{0, 0}, kTopSize}, is_yellow), 0);
  EXPECT_EQ(count(picture, {{0, 0}, kTopSize}, is_red), 0);
}

TEST(DrawTopView, HasTheSizeThatIsAskedFor) {
  const Frame frame = frame_over_ground();
  for (const cv::Size& size : {cv::Size(1, 1), cv::Size(33, 21), cv::Size(800, 200)}) {
    EXPECT_EQ(draw_top_view(frame, flat_ground(frame), {}, size).size(), size);
  }
}

TEST(PathTrail, HoldsEarlierPlacesSeenFromNow) {
  PathTrail trail;
  EXPECT_TRUE(trail.path().empty());
  Eigen::Isometry3d step = Eigen::Isometry3d::Identity();
  step.translation() = Eigen::Vector3d(0.0, 0.0, -1.0);  // a metre forward: what was here is behind now
  trail.add(step);
  trail.add(step);
  ASSERT_EQ(trail.path().size(), 2U);
  EXPECT_TRUE(trail.path()[0].isApprox(Eigen::Vector3d(0.0, 0.0, -2.0)));
  EXPECT_TRUE(trail.path()[1].isApprox(Eigen::Vector3d(0.0, 0.0, -1.0)));
}

TEST(PathTrail, StartsAnewWhereTheMotionIsNotKnown) {
  PathTrail trail;
  trail.add(Eigen::Isometry3d::Identity());
  trail.add(std::nullopt);
  EXPECT_TRUE(trail.path().empty());
  trail.add(Eigen::Isometry3d::Identity());
  EXPECT_EQ(trail.path().size(), 1U);
}

TEST(PathTrail, ForgetsTheOldestPlaces) {
  PathTrail trail;
  for (int i = 0; i < 1005; ++i) trail.add(Eigen::Isometry3d::Identity());
  EXPECT_EQ(trail.path().size(), 1000U);
}

TEST(DrawVideoFrame, HasOneSizeWhateverThePicture) {
  for (const cv::Size& size : {cv::Size(32, 32), cv::Size(333, 127), cv::Size(100, 1000), cv::Size(1280, 720)}) {
    Frame frame = frame_over_ground();
    frame.left = cv::Mat1b(size, uchar{100});
    const Detection detection = flat_ground(frame);
    const cv::Mat3b picture = draw_video_frame(frame, detection, {}, "ego-motion ok");
    EXPECT_EQ(picture.size(), cv::Size(kVideoWidth, kVideoHeight));
    EXPECT_EQ(picture(270, 480), cv::Vec3b(100, 100, 100)) << size;  // the middle of the left picture
  }
}

TEST(DrawVideoFrame, DrawsFailedFrames) {
  const Detection failed = make_failed_detection(3, 0.2, FrameStatus::no_picture, "left.png: no such file");
  const cv::Mat3b black = draw_video_frame(Frame{}, failed, {}, "no ego-motion");
  EXPECT_EQ(black.size(), cv::Size(kVideoWidth, kVideoHeight));
  const cv::Rect left(0, 0, 960, 540);
  EXPECT_GT(cv::countNonZero(cv::Mat3b(black(left)).reshape(1)), 100);  // the reason
  const cv::Mat3b with_picture = draw_video_frame(frame_over_ground(), failed, {}, "no ego-motion");
  EXPECT_EQ(with_picture(270, 480), cv::Vec3b(100, 100, 100));
  EXPECT_EQ(count(with_picture, left, is_red), 0);
}

TEST(DrawVideoFrame, WritesTheStateOfTheEgoMotion) {
  const Frame frame = frame_over_ground();
  const Detection detection = flat_ground(frame);
  const cv::Mat3b ok = draw_video_frame(frame, detection, {}, "ego-motion ok");
  EXPECT_FALSE(differ(ok, draw_video_frame(frame, detection, {}, "ego-motion ok")));
  EXPECT_TRUE(differ(ok, draw_video_frame(frame, detection, {}, "ego-motion: too few matches")));
}

TEST(DrawVideoFrame, KeepsLongTextInItsPanel) {
  const std::string reason(300, 'x');
  const Detection failed = make_failed_detection(3, 0.2, FrameStatus::no_picture, reason);
  const cv::Mat3b longer = draw_video_frame(Frame{}, failed, {}, reason);
  const cv::Mat3b shorter = draw_video_frame(Frame{}, make_failed_detection(3, 0.2, FrameStatus::no_picture, "x"), {}, "x");
  const cv::Rect right(960, 0, 640, 720);
  EXPECT_FALSE(differ(longer(right).clone(), shorter(right).clone()));
  EXPECT_TRUE(differ(longer, shorter));
}

TEST(DrawVideoFrame, NamesTheNearestObstacleAndNeverCallsAFailureSilence) {
  const Frame frame = frame_over_ground();
  const cv::Rect headline(0, 540, 960, 70);
  Detection detection = flat_ground(frame);
  const auto drawn = [&](const Detection& told) { return cv::Mat3b(draw_video_frame(frame, told, {}, "")(headline)).clone(); };
  const cv::Mat3b nothing = drawn(detection);
  EXPECT_EQ(count(nothing, {0, 0, 960, 70}, is_red), 0);
  EXPECT_EQ(count(nothing, {0, 0, 960, 70}, is_yellow), 0);
  detection.obstacles = {opening_at(frame, detection, 0.0, 1.0)};
  EXPECT_GT(count(drawn(detection), {0, 0, 960, 70}, is_red), 100);
  EXPECT_GT(count(drawn(Detection{}), {0, 0, 960, 70}, is_yellow), 100);
  const Detection failed = make_failed_detection(3, 0.2, FrameStatus::bad_frame, "x");
  EXPECT_GT(count(drawn(failed), {0, 0, 960, 70}, is_yellow), 100);
}

}  // namespace
}  // namespace brink
