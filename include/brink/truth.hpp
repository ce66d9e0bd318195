#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "brink/camera.hpp"
#include "brink/candidates.hpp"
#include "brink/sequence_writer.hpp"

namespace brink {

/// A negative obstacle as one frame shows it.
struct VisibleInstance {
  int id = 0;
  int visible_px = 0;             ///< pixels of its inside that are seen
  std::optional<double> depth_m;  ///< empty when the sequence has no instances.yaml
  /// Of the nearest point of its rim that is seen, in the plane of the rim, from the foot of the camera's perpendicular; of the
  /// nearest point at all when the rim itself is out of the picture. Empty when the sequence lacks poses or rims.
  std::optional<double> distance_m;
  std::optional<double> bearing_deg;     ///< of that point, from the optical axis laid onto that plane, positive right
  std::vector<Eigen::Vector3d> opening;  ///< rim polygon in the left camera's frame, m; empty when distance_m is
  /// What its type in instances.yaml is.
  ObstacleKind kind = ObstacleKind::unknown;
};

/// Where the rim of a negative obstacle lies, whether this frame shows any of it or not. All of it in the plane of the rim.
struct RimPlace {
  int id = 0;
  double depth_m = 0.0;
  double distance_m = 0.0;   ///< of the nearest point of the rim, from the foot of the camera's perpendicular
  double bearing_deg = 0.0;  ///< of that point, from the optical axis laid onto the plane, positive right
  double height_m = 0.0;     ///< of the camera over the plane; negative below it (for a camera held upside down: above it)
  bool is_inside = false;    ///< the foot of the camera's perpendicular lies in the opening
};

/// What is true of one frame.
struct FrameTruth {
  int frame = 0;
  double time = 0.0;                                   ///< s
  cv::Mat1b negative;                                  ///< id of the negative obstacle seen, 0 = none, 255 = not labelled
  std::vector<VisibleInstance> instances;              ///< those with at least one pixel in `negative`, ascending id
  std::vector<RimPlace> rims;                          ///< of all instances whose rim and the camera's pose are known
  std::optional<Eigen::Isometry3d> world_from_camera;  ///< world = left camera of frame 0
  std::optional<StereoCamera> camera;                  ///< empty when the sequence has no calibration
};

/// The pixel value that means "not labelled".
inline constexpr int kNotLabelled = 255;

/// The truth of a sequence in the layout of docs/formats.md: negative/, and where there are any instances.yaml, poses.txt,
/// calib.txt, times.txt and disparity/. Holds names and small tables: masks are read one frame at a time.
class SequenceTruth {
 public:
  /// @throws std::runtime_error "path: ..." when there is no negative/ with masks, and when a file that is there is not what
  ///         docs/formats.md says or contradicts another one (an id twice, fewer poses than frames, NaN).
  explicit SequenceTruth(const std::string& folder);

  [[nodiscard]] const std::string& folder() const { return folder_; }
  [[nodiscard]] int size() const { return static_cast<int>(frames_.size()); }  ///< frames with a mask
  [[nodiscard]] const std::vector<int>& frames() const { return frames_; }     ///< their numbers, ascending
  [[nodiscard]] const std::vector<InstanceTruth>& instances() const { return instances_; }

  /// @param position 0 .. size() - 1. @throws std::out_of_range otherwise, std::runtime_error "file: ..." when a picture
  ///        cannot be read, is not one of 8 bit, holds an id that instances.yaml lacks, or differs in size from the others.
  [[nodiscard]] FrameTruth read(int position) const;
  /// True disparities, px, kInvalidDisparity = none; empty when the sequence has no disparity/. Errors as for read.
  [[nodiscard]] cv::Mat1f read_disparity(int position) const;

 private:
  std::string folder_;
  std::vector<int> frames_;
  std::vector<std::string> masks_;        // paths, by position
  std::vector<std::string> disparities_;  // paths, by position; empty without disparity/
  std::vector<double> times_;             // by frame number; empty = the number itself
  std::vector<Eigen::Isometry3d> poses_;  // by frame number; empty = unknown
  std::vector<InstanceTruth> instances_;  // empty when there is no instances.yaml
  bool has_instances_ = false;            // instances.yaml is there, perhaps without any
  std::optional<StereoCamera> camera_;    // empty without calib.txt
  cv::Size size_;                         // of all masks
};

/// The nearest point of a rim that a camera sees: rim points in the picture with nothing in front of them. All of it in the
/// plane of the rim (evaluation.md: distances are those of the nearest visible point of the rim, in the ground plane).
struct RimSighting {
  double distance_m = 0.0;
  double bearing_deg = 0.0;
  bool visible = false;  ///< false: no point of the rim is in view, and the nearest one at all is told
};
/// @param opening polygon in the left camera's frame, m, at least 3 points. @param disparity truth, px, <= 0 =
///        none; empty = nothing is known to stand in front.
/// @throws std::invalid_argument when the polygon has no plane or the disparity is not of that size.
RimSighting find_nearest_rim(const std::vector<Eigen::Vector3d>& opening, const StereoCamera& camera, const cv::Size& size,
                             const cv::Mat1f& disparity);

/// Where a rim lies around a camera, seen or not. `id` and `depth_m` are left at 0.
/// @param opening as for find_nearest_rim. @throws std::invalid_argument when the polygon has no plane.
RimPlace locate_rim(const std::vector<Eigen::Vector3d>& opening);

}  // namespace brink
