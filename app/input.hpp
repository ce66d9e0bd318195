#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "brink/calibration.hpp"
#include "brink/sequence.hpp"

namespace brink::app {

/// The input of every command that looks at frames: a sequence, pairs of pictures or side-by-side pictures with their
/// calibration.
struct InputOptions {
  std::string input;
  std::string right;
  CalibrationFiles calibration;
  std::optional<DepthKind> as;  ///< what takes the place of right pictures
  bool side_by_side = false;
  TimeSource times;
};
/// --as disparity|depth.
void add_as_option(CLI::App& command, std::optional<DepthKind>& as, const std::string& description);
/// --calib, --calib-right and --pictures. @return --calib.
CLI::Option* add_calibration_options(CLI::App& command, CalibrationFiles& files);
void add_input_options(CLI::App& command, InputOptions& options);
/// Says what the input was recognised as, and what is odd about it.
/// @throws std::invalid_argument when the options do not go with the input, std::runtime_error when it cannot be read.
Sequence open_input(const InputOptions& options);
/// Whether the input is one left and one right picture, each by its name, or one disparity or depth image.
bool is_one_pair(const InputOptions& options);

}  // namespace brink::app
