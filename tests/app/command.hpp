#pragma once

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include "brink/files.hpp"
#include "brink/pictures.hpp"
#include "synthetic_pair.hpp"
#include "temporary_folder.hpp"

namespace brink::test {

struct CommandResult {
  int exit_code = -1;  ///< -1 when the command was ended by a signal
  std::string output;  ///< on standard output
  std::string errors;  ///< on standard error
};

/// Runs `brink arguments` as a user would, through the shell. @param before shell commands that prepare the ground, with "; ".
inline CommandResult run_command(const std::string& arguments, const std::string& before = "") {
  const TemporaryFolder folder;
  const std::string redirected = arguments.find('>') == std::string::npos ? " > " + folder / "output" : "";
  const std::string line = before + BRINK_COMMAND + " " + arguments + redirected + " 2> " + folder / "errors";
  const int status = std::system(line.c_str());  // NOLINT(bugprone-command-processor): that is what is tested
  CommandResult result;
  if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
  if (!redirected.empty()) result.output = read_file(folder / "output");
  result.errors = read_file(folder / "errors");
  return result;
}

/// The lines of a text, without their ends.
inline std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    lines.push_back(text.substr(start, end - start));
    start = end + 1;
  }
  return lines;
}

/// The lines on standard error without that which names the input and its calibration: what went wrong.
inline std::vector<std::string> faults_of(const CommandResult& result) {
  std::vector<std::string> lines = lines_of(result.errors);
  std::erase_if(lines, [](const std::string& line) { return line.find("; calibration: ") != std::string::npos; });
  return lines;
}

/// JSON Lines without the times, which differ from run to run.
inline std::vector<nlohmann::json> detections_of(const std::string& text) {
  std::vector<nlohmann::json> detections;
  for (const std::string& line : lines_of(text)) {
    detections.push_back(nlohmann::json::parse(line));
    detections.back().erase("times_ms");
  }
  return detections;
}

/// Puts left.png, right.png and calib.txt into a folder; returns the arguments that name them.
inline std::string add_pair(const TemporaryFolder& folder, const Pair& pair) {
  return folder.add("left.png", encode_png(pair.left)) + " --right " + folder.add("right.png", encode_png(pair.right)) +
         " --calib " + folder.add("calib.txt", half_size_calibration());
}

}  // namespace brink::test
