#include "brink/sequence.hpp"

#include <algorithm>
#include <cctype>
#include <exception>
#include <filesystem>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "brink/calibration.hpp"
#include "brink/files.hpp"
#include "brink/pictures.hpp"
#include "io/text.hpp"

namespace brink {
namespace fs = std::filesystem;
namespace {

constexpr int kMaxGap = 1000;  // more missing numbers in a row are no gap but another numbering

bool is_picture_name(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  const bool hidden = path.filename().string().starts_with('.');
  return !hidden && (extension == ".png" || extension == ".jpg" || extension == ".jpeg");
}

// The pictures of one eye by their number.
std::map<int, std::string> list_pictures(const fs::path& folder) {
  std::map<int, std::string> pictures;
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

void check_gaps(const fs::path& folder, const std::vector<int>& numbers) {
  for (std::size_t i = 1; i < numbers.size(); ++i) {
    if (numbers[i] - numbers[i - 1] > kMaxGap) {
      throw std::runtime_error(fmt::format("{}: frame numbers jump from {} to {}, expected consecutive ones", folder.string(),
                                           numbers[i - 1], numbers[i]));
    }
  }
}

// Numbers of both eyes, ascending, each once.
std::vector<int> numbers_of(const std::map<int, std::string>& left, const std::map<int, std::string>& right) {
  std::vector<int> numbers;
  numbers.reserve(left.size() + right.size());
  for (const auto& picture : left) numbers.push_back(picture.first);
  for (const auto& picture : right) numbers.push_back(picture.first);
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  return numbers;
}

// Seconds, one line per frame number from 0; empty without the file.
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

struct Eyes {
  fs::path left;
  fs::path right;
  CameraPair cameras = CameraPair::color;
};

Eyes find_eyes(const fs::path& folder) {
  for (const Eyes& eyes : {Eyes{folder / "image_2", folder / "image_3", CameraPair::color},
                           Eyes{folder / "image_0", folder / "image_1", CameraPair::grey}}) {
    std::error_code error;
    if (fs::is_directory(eyes.left, error) && fs::is_directory(eyes.right, error)) return eyes;
  }
  throw std::runtime_error(fmt::format(
      "{}: no pictures, expected folders image_2 and image_3 (colour) or image_0 and image_1 (grey)", folder.string()));
}

// A missing picture gets the name that it would have.
std::string picture_or_expected(const std::map<int, std::string>& pictures, const fs::path& folder, int number) {
  const auto found = pictures.find(number);
  return found != pictures.end() ? found->second : (folder / fmt::format("{:06}.png", number)).string();
}

}  // namespace

Sequence::Sequence(const StereoCamera& camera, std::vector<FrameFiles> files, std::vector<ImuSample> imu)
    : camera_(camera), files_(std::move(files)), imu_(std::move(imu)) {
  camera_.validate();
}

FrameReading Sequence::read(int position) const {
  const FrameFiles& files = files_.at(static_cast<std::size_t>(position));
  FrameReading reading;
  reading.frame.index = files.index;
  reading.frame.time = files.time;
  try {
    const cv::Mat left = read_picture(files.left);
    const cv::Mat right = read_picture(files.right);
    reading.frame = make_frame(left, right, camera_, files.index, files.time);
    reading.frame.gravity = estimate_gravity(imu_, files.time);
    if (position > 0) {
      reading.frame.current_from_previous_rotation =
          integrate_gyroscope(imu_, files_[static_cast<std::size_t>(position) - 1].time, files.time);
    }
  } catch (const std::invalid_argument& error) {
    reading.status = FrameStatus::bad_frame;
    reading.reason = fmt::format("{} and {}: {}", files.left, files.right, error.what());
  } catch (const std::runtime_error& error) {
    std::error_code ignored;
    const bool there = fs::exists(files.left, ignored) && fs::exists(files.right, ignored);
    reading.status = there ? FrameStatus::bad_frame : FrameStatus::no_picture;
    reading.reason = error.what();
  }
  return reading;
}

Sequence open_sequence(const std::string& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) throw std::runtime_error(folder + ": no such folder");
  const Eyes eyes = find_eyes(folder);
  const StereoCalibration calibration = read_calibration((fs::path(folder) / "calib.txt").string(), eyes.cameras);
  const auto left = list_pictures(eyes.left);
  const auto right = list_pictures(eyes.right);
  const std::vector<int> numbers = numbers_of(left, right);
  if (numbers.empty()) throw std::runtime_error(eyes.left.string() + ": holds no PNG or JPEG pictures");
  check_gaps(eyes.left, numbers);
  const std::vector<double> times = read_times(fs::path(folder) / "times.txt", numbers.back());
  std::vector<FrameFiles> files;
  for (int number = numbers.front(); number <= numbers.back(); ++number) {
    const double time = times.empty() ? number : times[static_cast<std::size_t>(number)];
    files.push_back(
        {number, time, picture_or_expected(left, eyes.left, number), picture_or_expected(right, eyes.right, number)});
  }
  const fs::path imu = fs::path(folder) / "imu.csv";
  return {calibration.camera, std::move(files), fs::exists(imu, error) ? read_imu(imu.string()) : std::vector<ImuSample>{}};
}

Sequence open_pair(const std::string& left, const std::string& right, const std::string& calibration) {
  return {read_calibration(calibration).camera, {{0, 0.0, left, right}}};
}

}  // namespace brink
