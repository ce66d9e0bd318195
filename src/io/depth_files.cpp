#include "io/depth_files.hpp"

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "brink/calibration.hpp"
#include "brink/pictures.hpp"
#include "io/picture_patterns.hpp"
#include "io/sequence_files.hpp"

namespace brink {
namespace fs = std::filesystem;
namespace {

/// The folder of the left pictures, and the cameras of calib.txt that took them; empty path = there are none.
Eyes find_left(const fs::path& folder) {
  std::error_code error;
  if (fs::is_directory(folder / "image_2", error)) return {folder / "image_2", "", CameraPair::color};
  if (fs::is_directory(folder / "image_0", error)) return {folder / "image_0", "", CameraPair::grey};
  return {"", "", CameraPair::any};
}

/// What it means for people that there are disparities, and perhaps no pictures.
std::string remark(DepthKind kind, const StereoCalibration& calibration, bool has_pictures) {
  std::string text =
      fmt::format("{} images in place of right pictures; calibration: {}", to_string(kind), describe(calibration));
  if (has_pictures) return text;
  return text +
         "; no left pictures: drops without disparity (Type 2) are off, and without poses what is seen is followed along the "
         "ground only";
}

StereoCalibration read_depth_camera(const CalibrationFiles& calibration_files, const std::vector<FrameFiles>& files,
                                    DepthKind kind, CameraPair cameras) {
  StereoCalibration calibration = read_depth_calibration(calibration_files, first_picture_size(files), cameras);
  if (calibration.rectification) {
    throw std::runtime_error(
        fmt::format("{}: is the calibration of raw pictures, expected that of rectified ones, to which {} "
                    "images belong",
                    calibration_files.path, to_string(kind)));
  }
  if (calibration.single && kind == DepthKind::disparity) {
    throw std::runtime_error(calibration_files.path +
                             ": is the calibration of one camera, expected one with the baseline of the disparities");
  }
  return calibration;
}

Sequence make_sequence(const std::vector<FrameFiles>& files, DepthKind kind, const StereoCalibration& calibration,
                       std::vector<ImuSample> imu, std::vector<std::string> remarks) {
  std::vector<FrameStamp> stamps;
  stamps.reserve(files.size());
  for (const FrameFiles& frame : files) stamps.push_back({frame.index, frame.time});
  const bool has_pictures = std::ranges::any_of(files, [](const FrameFiles& frame) { return !frame.left.empty(); });
  remarks.push_back(remark(kind, calibration, has_pictures));
  return {calibration.camera, std::move(stamps),
          std::make_unique<DepthFiles>(files, kind, calibration.camera, calibration.size), std::move(imu), std::move(remarks)};
}

}  // namespace

std::string to_string(DepthKind kind) { return kind == DepthKind::disparity ? "disparity" : "depth"; }

DepthFiles::DepthFiles(std::vector<FrameFiles> files, DepthKind kind, const StereoCamera& camera, cv::Size size)
    : files_(std::move(files)),
      kind_(kind),
      camera_(camera),
      size_(size),
      has_pictures_(std::ranges::any_of(files_, [](const FrameFiles& frame) { return !frame.left.empty(); })) {}

PicturePair DepthFiles::read(int position) {
  const FrameFiles& files = files_.at(static_cast<std::size_t>(position));
  PicturePair pair;
  pair.name = files.right;
  if (has_pictures_) {
    require_picture(files.left, files.right);
    pair.left = read_picture(files.left);
    pair.name = fmt::format("{} and {}", files.left, files.right);
  }
  require_picture(files.right, files.left);
  pair.disparity =
      kind_ == DepthKind::disparity ? read_disparity(files.right) : disparity_from_depth(read_depth(files.right), camera_);
  if (!size_.empty() && pair.disparity.size() != size_) {
    throw std::runtime_error(fmt::format("{}: {}x{} px, expected those of the calibration and the other pictures, {}x{}",
                                         files.right, pair.disparity.cols, pair.disparity.rows, size_.width, size_.height));
  }
  return pair;
}

Sequence open_depth_sequence(const std::string& folder, DepthKind kind, const TimeSource& times,
                             const CalibrationFiles& calibration) {
  const fs::path path = folder;
  const fs::path depth = path / to_string(kind);
  std::error_code error;
  if (!fs::is_directory(depth, error)) {
    throw std::runtime_error(
        fmt::format("{}: no {} images, expected them in the folder {}", folder, to_string(kind), depth.filename().string()));
  }
  const Eyes eyes = find_left(path);
  NumberedFolder left{eyes.left, {}};
  if (!left.folder.empty()) left.files = list_pictures(left.folder);
  const NumberedFolder right{depth, list_pictures(depth, is_depth_name)};
  const std::vector<FrameFiles> files = pair_by_number(left, right, path, times);
  const StereoCalibration known = read_depth_camera(find_calibration(path, calibration), files, kind, eyes.cameras);
  std::vector<std::string> remarks;
  if (!left.folder.empty()) {
    const auto missing = unequal_counts(folder, numbers_of(left.files), numbers_of(right.files), to_string(kind));
    if (missing) remarks.push_back(*missing);
  }
  return make_sequence(files, kind, known, read_imu_of(path), std::move(remarks));
}

Sequence open_depth_files(const std::vector<FrameFiles>& files, DepthKind kind, const CalibrationFiles& calibration) {
  return make_sequence(files, kind, read_depth_camera(calibration, files, kind, CameraPair::any), {}, {});
}

Sequence open_depth_patterns(const std::string& left, const std::string& depth, DepthKind kind,
                             const CalibrationFiles& calibration, const TimeSource& times) {
  PatternFrames found = left.empty() ? match_patterns(depth, "", times) : match_patterns(left, depth, times);
  if (left.empty()) {
    for (FrameFiles& frame : found.frames) std::swap(frame.left, frame.right);
  }
  const StereoCalibration known = read_depth_camera(calibration, found.frames, kind, CameraPair::any);
  return make_sequence(found.frames, kind, known, {}, std::move(found.remarks));
}

}  // namespace brink
