#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "brink/calibration.hpp"

namespace brink {

/// Paths by frame number.
using NumberedFiles = std::map<int, std::string>;

/// The PNG and JPEG pictures of a folder by the number that each is named by; hidden and other files are left out.
/// @throws std::runtime_error "path: ..." when a picture's name is no number, two have the same, or the folder cannot be read.
NumberedFiles list_pictures(const std::filesystem::path& folder);

/// times.txt: seconds, one line per frame number from 0. @return empty when there is no such file.
/// @throws std::runtime_error "path: ..." when a line is no number, times decrease, or there is none for last_number.
std::vector<double> read_times(const std::filesystem::path& path, int last_number);

/// The folders of both eyes' pictures, with the cameras of calib.txt that took them.
struct Eyes {
  std::filesystem::path left;
  std::filesystem::path right;
  CameraPair cameras = CameraPair::color;
};
/// Colour wins where there are both. @return empty when the sequence holds neither image_2 and image_3 nor image_0 and image_1.
std::optional<Eyes> find_eyes(const std::filesystem::path& sequence);

}  // namespace brink
