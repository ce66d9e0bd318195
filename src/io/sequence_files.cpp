#include "io/sequence_files.hpp"

#include <algorithm>
#include <cctype>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>

#include "brink/files.hpp"
#include "io/text.hpp"

namespace brink {
namespace fs = std::filesystem;
namespace {

bool is_picture_name(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  const bool hidden = path.filename().string().starts_with('.');
  return !hidden && (extension == ".png" || extension == ".jpg" || extension == ".jpeg");
}

}  // namespace

NumberedFiles list_pictures(const fs::path& folder) {
  NumberedFiles pictures;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const fs::path& path = entry.path();
    if (!is_picture_name(path)) continue;
    const std::optional<int> number = parse_number<int>(path.stem().string());
    if (!number || *number < 0) {
      throw std::runtime_error(fmt::format("{}: name is not a frame number, expected one like 000012.png", path.string()));
    }
    const auto [known, is_new] = pictures.emplace(*number, path.string());
    if (!is_new) {
      throw std::runtime_error(fmt::format("{}: frame {} has another picture, {}", path.string(), *number, known->second));
    }
  }
  if (error) throw std::runtime_error(fmt::format("{}: cannot be read: {}", folder.string(), error.message()));
  return pictures;
}

std::vector<double> read_times(const fs::path& path, int last_number) {
  std::error_code error;
  if (!fs::exists(path, error)) return {};
  std::vector<double> times;
  std::istringstream lines(read_file(path.string()));
  for (std::string line; std::getline(lines, line);) {
    if (trimmed(line).empty()) continue;
    const std::optional<double> time = parse_number(trimmed(line));
    const std::size_t number = times.size() + 1;
    if (!time)
      throw std::runtime_error(fmt::format("{}: time {} = {}, expected seconds", path.string(), number, trimmed(line)));
    if (!times.empty() && *time < times.back()) {
      throw std::runtime_error(
          fmt::format("{}: time {} = {}, expected at least the one before, {}", path.string(), number, *time, times.back()));
    }
    times.push_back(*time);
  }
  if (times.size() <= static_cast<std::size_t>(last_number)) {
    throw std::runtime_error(
        fmt::format("{}: has {} times, expected one for each frame from 0 to {}", path.string(), times.size(), last_number));
  }
  return times;
}

std::optional<Eyes> find_eyes(const fs::path& folder) {
  for (const Eyes& eyes : {Eyes{folder / "image_2", folder / "image_3", CameraPair::color},
                           Eyes{folder / "image_0", folder / "image_1", CameraPair::grey}}) {
    std::error_code error;
    if (fs::is_directory(eyes.left, error) && fs::is_directory(eyes.right, error)) return eyes;
  }
  return std::nullopt;
}

}  // namespace brink
