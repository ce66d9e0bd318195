#include "input.hpp"

#include <cstdlib>
#include <filesystem>
#include <stdexcept>

#include <fmt/format.h>

#include "brink/pictures.hpp"
#include "common.hpp"

namespace brink::app {
namespace {

/// Says what the input was recognised as and what is odd about it.
Sequence announced(Sequence sequence) {
  for (const std::string& remark : sequence.remarks()) say(remark);
  return sequence;
}

[[noreturn]] void refuse(const std::string& input, const std::string& why) { throw std::invalid_argument(input + why); }

Sequence open_pair_of(const InputOptions& options) {
  const std::string& input = options.input;
  if (options.side_by_side) refuse(input, " is one picture: --side-by-side goes with a folder, a pattern or a video");
  if (options.times.is_given()) refuse(input, " is one picture: --fps and --times go with a sequence");
  if (options.right.empty() || options.calibration.path.empty()) {
    refuse(input, " is one picture: --right and --calib are needed with it");
  }
  if (is_pattern(options.right)) {
    refuse(input, fmt::format(" is one picture and --right {} a pattern: both must be of one kind", options.right));
  }
  return announced(open_pair(input, options.right, options.calibration));
}

Sequence open_pairs_of(const InputOptions& options) {
  const std::string& input = options.input;
  if (options.right.empty() || options.calibration.path.empty()) {
    refuse(input, " is a pattern of left pictures: --right and --calib are needed with it, or --side-by-side and --calib");
  }
  if (!is_pattern(options.right)) {
    refuse(input, fmt::format(" is a pattern and --right {} none: both must be of one kind", options.right));
  }
  return announced(open_pairs(input, options.right, options.calibration, options.times));
}

Sequence open_folder_of(const InputOptions& options) {
  if (!options.right.empty()) {
    refuse(options.input, " is a folder, which holds its right pictures itself: --right goes with one picture or a pattern");
  }
  return announced(open_sequence(options.input, options.times, options.calibration));
}

/// Disparities or depths with left pictures, or without.
Sequence open_depth_of(const InputOptions& options) {
  std::error_code error;
  const std::string& input = options.input;
  const bool alone = options.right.empty();
  if (options.side_by_side) throw std::invalid_argument("--as goes with one left picture or none, not with --side-by-side");
  ::setenv("OPENCV_IO_ENABLE_OPENEXR", "1", 0);  // the user says what the file is; what is set there stays
  if (std::filesystem::is_directory(input, error)) {
    if (!alone) refuse(input, " is a folder, which holds its disparities or depths itself: --right goes with one picture");
    return open_depth_sequence(input, *options.as, options.times, options.calibration);
  }
  if (options.calibration.path.empty()) refuse(input, " is no folder: --calib is needed with it");
  if (!alone && is_pattern(input) != is_pattern(options.right)) {
    refuse(input, fmt::format(" and --right {} must be of one kind: both pictures or both patterns", options.right));
  }
  const std::string left = alone ? "" : input;
  const std::string& depth = alone ? input : options.right;
  if (is_pattern(input)) return open_depth_patterns(left, depth, *options.as, options.calibration, options.times);
  if (options.times.is_given()) refuse(input, " is one picture: --fps and --times go with a sequence");
  return open_depth_files({{0, 0.0, left, depth}}, *options.as, options.calibration);
}

/// FFmpeg shall drop a frame whose end is missing, instead of making up the rest, and leave the talking to us. It takes this
/// from the environment only; what the user set there stays.
void make_videos_strict() {
  ::setenv("OPENCV_FFMPEG_CAPTURE_OPTIONS", "fflags;discardcorrupt", 0);
  ::setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
}

}  // namespace

void add_as_option(CLI::App& command, std::optional<DepthKind>& as, const std::string& description) {
  command
      .add_option_function<std::string>(
          "--as", [&as](const std::string& kind) { as = kind == "depth" ? DepthKind::depth : DepthKind::disparity; },
          description)
      ->type_name("KIND")
      ->check(CLI::IsMember({"disparity", "depth"}).description(""));
}

CLI::Option* add_calibration_options(CLI::App& command, CalibrationFiles& files) {
  CLI::Option* calib =
      command
          .add_option(
              "--calib", files.path,
              "Calibration of the pair, or of one half of side-by-side pictures, or of a folder in place of its calib.txt: "
              "KITTI, OpenCV, EuRoC, Kalibr, Middlebury, ROS or ZED, told apart by content")
          ->type_name("FILE");
  command
      .add_option(
          "--calib-right", files.right_path,
          "Calibration of the right camera, for kinds with a file per camera. Without it a partner of --calib is looked "
          "for by its name: left and right, cam0 and cam1")
      ->type_name("FILE");
  command
      .add_option_function<std::string>(
          "--pictures",
          [&files](const std::string& state) { files.pictures = state == "raw" ? PictureState::raw : PictureState::rectified; },
          "What the pictures are, for calibrations that describe both: raw or rectified")
      ->type_name("STATE")
      ->check(CLI::IsMember({"raw", "rectified"}).description(""));
  return calib;
}

void add_input_options(CLI::App& command, InputOptions& options) {
  command
      .add_option("INPUT", options.input,
                  "Folder of a sequence in the KITTI layout or of EuRoC/ASL; a video with both "
                  "eyes side by side; the left picture of one pair (PNG or JPEG, 8 bit); or a pattern of left pictures in "
                  "quotes: 'left/*.png' or 'left_%06d.png'")
      ->required();
  command.add_option("--right", options.right, "Right picture of the pair, or the pattern of right pictures in quotes")
      ->type_name("FILE|PATTERN");
  add_calibration_options(command, options.calibration);
  add_as_option(
      command, options.as,
      "disparity or depth: what takes the place of the right picture. --right is such an image, or INPUT itself where "
      "there is no picture; a folder has them in disparity/ or depth/. 16-bit PNG or TIFF (disparity times 256, depth "
      "in mm), or float TIFF, PFM or OpenEXR (px, m)");
  command.add_flag("--side-by-side", options.side_by_side,
                   "INPUT is a folder of pictures named by number, or a pattern, each with both eyes side by side. A video "
                   "needs no flag");
  command
      .add_option("--fps", options.times.fps,
                  "Frames per second of a sequence without times.txt, or of a video instead of what its file tells. Without it "
                  "a frame without a time has its number as time")
      ->type_name("F");
  command
      .add_option_function<std::string>(
          "--times",
          [&options](const std::string& source) {
            options.times.names = source == "names";
            if (!options.times.names) options.times.file = source;
          },
          "Times of a sequence that tells none: a file of seconds, one line a frame; or the word names: the numbers in the "
          "names of a pattern's pictures, ns, us, ms or s")
      ->type_name("FILE|names");
}

Sequence open_input(const InputOptions& options) {
  std::error_code error;
  const std::string& input = options.input;
  const bool pattern = is_pattern(input);
  if (!pattern && !std::filesystem::exists(input, error)) throw std::runtime_error(input + ": no such file or folder");
  if (options.as) return announced(open_depth_of(options));
  const bool folder = std::filesystem::is_directory(input, error);
  if (pattern && !options.side_by_side) return open_pairs_of(options);
  if (is_one_pair(options)) return open_pair_of(options);
  if (folder && !options.side_by_side) return open_folder_of(options);
  if (!folder && !pattern && is_depth_name(input)) {
    refuse(input, " holds disparities or depths: --as disparity or --as depth tells which");
  }
  if (!options.right.empty()) refuse(input, " has both eyes side by side: --right goes with one picture or a pattern");
  if (options.calibration.path.empty()) {
    refuse(input, folder || pattern ? " has both eyes side by side: --calib is needed with it"
                                    : " is taken for a side-by-side video: --calib is needed with it");
  }
  make_videos_strict();
  return announced(open_side_by_side(input, options.calibration, options.times));
}

bool is_one_pair(const InputOptions& options) {
  std::error_code error;
  const bool file = !is_pattern(options.input) && !std::filesystem::is_directory(options.input, error);
  return file && (is_picture_name(options.input) || !options.right.empty() || options.as.has_value());
}

}  // namespace brink::app
