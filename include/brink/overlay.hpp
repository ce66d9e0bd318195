#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "brink/candidates.hpp"
#include "brink/detector.hpp"
#include "brink/envelope.hpp"
#include "brink/frame.hpp"

namespace brink {

/// Pictures of one frame, after the paper's figures 2 to 5. All take the frame and what Detector::process told of it, have the
/// size of frame.left (of a frame without one: are drawn on its disparities, in grey), and show the plain picture where there
/// is nothing to draw (status not ok, ground not visible).

/// The left picture with ground pixels tinted green and pixels below the ground by min_depth_m or more tinted red; the state of
/// the ground is written at the top.
cv::Mat3b draw_ground(const Frame& frame, const Detection& detection, const CandidateParams& params = {});

/// Disparities in colour, from blue (far) to red (near), black = none, with a scale of pixels at the right unless
/// the picture is too small for it. Empty for an empty image. @param disparity px, kInvalidDisparity = none.
cv::Mat3b draw_disparity(const cv::Mat1f& disparity);

/// The left picture with contours: candidates of Type 1 cyan, of Type 2 magenta, rejected regions thin grey with the rule that
/// they failed.
cv::Mat3b draw_candidates(const Frame& frame, const Detection& detection);

/// The left picture with the obstacles that are reported, filled and outlined, and with the tracks that are not, thin blue;
/// beside each the distance of its rim, and its id and age (track_length) when it was followed over frames; the state of the
/// ground is written at the top.
cv::Mat3b draw_obstacles(const Frame& frame, const Detection& detection);

/// Elevations in colour: ground green, below it red, darker the deeper, above it blue, black = none, with a scale from -1 to
/// 1 m at the right unless the picture is too small for it. Empty for an empty image. @param elevation m, NaN = none.
cv::Mat3b draw_elevation(const cv::Mat1f& elevation);

/// The places the camera has been at, seen from where it is now.
class PathTrail {
 public:
  /// One frame on. @param current_from_previous motion of the left camera; empty = not known: the path starts anew.
  void add(const std::optional<Eigen::Isometry3d>& current_from_previous);
  /// Earlier positions in the current left camera frame, m, newest last, not the current one. The latest 1000 at most.
  [[nodiscard]] const std::vector<Eigen::Vector3d>& path() const { return path_; }

 private:
  std::vector<Eigen::Vector3d> path_;
};

/// The scene from above, laid onto the ground plane: ground that is seen dark green, what is seen below it dark red, obstacles
/// red and tracks thin blue with their labels, a dot on the nearest point of each rim, range rings at 1 to 5 m, the part of the
/// ground that the camera has in view, and the path. The camera stands near the bottom and looks up. Without a ground there are
/// only the rings.
/// @param path positions in the current left camera frame, m, newest last (PathTrail). @param size of the picture, px, > 0.
cv::Mat3b draw_top_view(const Frame& frame, const Detection& detection, const std::vector<Eigen::Vector3d>& path,
                        const cv::Size& size, const CandidateParams& params = {});

/// A line of draw_envelope.
struct EnvelopeCurve {
  std::string name;
  std::vector<EnvelopePoint> points;  ///< ascending distances
};
/// The envelope as a diagram: distance to the right, depth downwards on a logarithmic scale of 2 cm to 3 m, so that what a
/// camera sees lies below its line. Two curves at most have colours of their own.
cv::Mat3b draw_envelope(const std::vector<EnvelopeCurve>& curves, const std::string& title);

/// Size of draw_video_frame's pictures, px.
inline constexpr int kVideoWidth = 1600;
inline constexpr int kVideoHeight = 720;

/// One frame of the annotated video, of the same size whatever the state. Left: draw_obstacles, below it the nearest obstacle
/// in words, the frame and the legend. Right: disparity, elevation, the top view. A frame that failed shows its reason and what
/// there is of it.
/// @param ego_motion its state in words. The others as for draw_top_view.
cv::Mat3b draw_video_frame(const Frame& frame, const Detection& detection, const std::vector<Eigen::Vector3d>& path,
                           const std::string& ego_motion, const CandidateParams& params = {});

}  // namespace brink
