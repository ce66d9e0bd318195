#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "brink/camera.hpp"
#include "brink/imu.hpp"

namespace brink {

/// A negative obstacle of a sequence as instances.yaml tells it (docs/formats.md).
struct InstanceTruth {
  int id = 0;
  std::string type;
  double depth_m = 0.0;
  std::vector<Eigen::Vector3d> opening;  ///< rim polygon; world = left camera of frame 0; empty = not known
};

/// What to do when there is something at the place of a new sequence.
enum class Existing : std::uint8_t {
  refuse,   ///< an error, also for the rest of an interrupted run
  replace,  ///< start anew; the old sequence stays until the new one is whole
  resume    ///< go on with the rest of an interrupted run of the same recipe; start anew without one
};

/// Writes a sequence with truth in the layout of docs/formats.md. It grows in FOLDER.part and becomes FOLDER by commit(), so it
/// is there whole or not at all; so is every file in it. FOLDER.part stays when there was no commit(), to be resumed.
class SequenceWriter {
 public:
  /// @param recipe text of simulation.yaml: all that the sequence depends on. Only equal recipes are resumed.
  /// @throws std::runtime_error "path: ..." when something is there and must not be replaced: with `replace`, what is not a
  ///         sequence with a recipe; with `resume`, what was made by another recipe. Also when nothing can be written.
  SequenceWriter(const std::string& folder, const std::string& recipe, Existing existing);
  SequenceWriter(const SequenceWriter&) = delete;
  SequenceWriter& operator=(const SequenceWriter&) = delete;
  ~SequenceWriter() = default;

  /// With `resume`: the whole sequence was there already, so there is nothing to write.
  [[nodiscard]] bool is_complete() const { return complete_; }
  /// All files of the frame are there.
  [[nodiscard]] bool has_frame(int frame) const;

  // Each of these throws std::runtime_error "file: cannot be written: ...".

  /// @param jpeg_quality 1 to 100, or 0 for PNG.
  void write_pictures(int frame, const cv::Mat3b& left, const cv::Mat3b& right, int jpeg_quality) const;
  /// After this the frame counts as written.
  /// @param disparity px; 0 = none; disparities that do not fit the file (256 px or more) become none.
  /// @param negative id of the negative obstacle whose inside is seen, 0 = none.
  void write_truth(int frame, const cv::Mat1f& disparity, const cv::Mat1b& negative) const;

  void write_calibration(const StereoCamera& camera) const;
  void write_times(const std::vector<double>& times) const;
  /// @param world_from_camera of the left camera, frame by frame.
  void write_poses(const std::vector<Eigen::Isometry3d>& world_from_camera) const;
  void write_imu(const std::vector<ImuSample>& samples) const;
  void write_instances(const std::vector<InstanceTruth>& instances) const;

  /// Gives the folder its name.
  void commit();

 private:
  [[nodiscard]] std::string path_of(const std::string& name) const { return part_ + "/" + name; }

  std::string folder_;
  std::string part_;
  bool complete_ = false;
};

}  // namespace brink
