#include "io/sequence_files.hpp"

#include <algorithm>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>

#include "brink/files.hpp"
#include "brink/pictures.hpp"
#include "io/text.hpp"

namespace brink {
namespace fs = std::filesystem;

NumberedFiles list_pictures(const fs::path& folder, bool (*is_wanted)(const std::string&)) {
  NumberedFiles pictures;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const fs::path& path = entry.path();
    const bool hidden = path.filename().string().starts_with('.');
    if (hidden || !is_wanted(path.string())) continue;
    const std::optional<int> number = parse_number<int>(path.stem().string());
    if (!number || *number < 0) {
      throw std::runtime_error(fmt::format(
          "{}: name is not a frame number, expected one like 000012.png (a pattern in quotes takes any)", path.string()));
    }
    const auto [known, is_new] = pictures.emplace(*number, path.string());
    if (!is_new) {
      throw std::runtime_error(fmt::format("{}: frame {} has another picture, {}", path.string(), *number, known->second));
    }
  }
  if (error) throw std::runtime_error(fmt::format("{}: cannot be read: {}", folder.string(), error.message()));
  return pictures;
}

std::vector<int> numbers_of(const NumberedFiles& pictures) {
  std::vector<int> numbers;
  numbers.reserve(pictures.size());
  for (const auto& picture : pictures) numbers.push_back(picture.first);
  return numbers;
}

std::vector<double> read_time_list(const std::string& path) {
  std::vector<double> times;
  std::istringstream lines(read_file(path));
  for (std::string line; std::getline(lines, line);) {
    if (trimmed(line).empty()) continue;
    const std::optional<double> time = parse_number(trimmed(line));
    const std::size_t number = times.size() + 1;
    if (!time) {
      throw std::runtime_error(fmt::format("{}: time {} = {}, expected seconds", path, number, trimmed(line)));
    }
    if (!times.empty() && *time <= times.back()) {
      throw std::runtime_error(
          fmt::format("{}: time {} = {}, expected more than the one before, {}", path, number, *time, times.back()));
    }
    times.push_back(*time);
  }
  return times;
}

std::vector<double> read_times(const fs::path& path, int last_number) {
  std::error_code error;
  if (!fs::exists(path, error)) return {};
  std::vector<double> times = read_time_list(path.string());
  if (times.size() <= static_cast<std::size_t>(last_number)) {
    throw std::runtime_error(
        fmt::format("{}: has {} times, expected one for each frame from 0 to {}", path.string(), times.size(), last_number));
  }
  return times;
}

std::string picture_or_expected(const NumberedFiles& pictures, const fs::path& folder, int number) {
  const auto found = pictures.find(number);
  return found != pictures.end() ? found->second : (folder / fmt::format("{:06}.png", number)).string();
}

void check_gaps(const fs::path& folder, const std::vector<int>& numbers) {
  constexpr int kMaxGap = 1000;
  for (std::size_t i = 1; i < numbers.size(); ++i) {
    if (numbers[i] - numbers[i - 1] > kMaxGap) {
      throw std::runtime_error(fmt::format("{}: frame numbers jump from {} to {}, expected consecutive ones", folder.string(),
                                           numbers[i - 1], numbers[i]));
    }
  }
}

std::string to_string(const TimeSource& source) {
  if (source.fps) return fmt::format("fps = {}", *source.fps);
  return "times = " + (source.names ? "names" : source.file);
}

void TimeSource::validate() const {
  constexpr double kMost = 1e5;
  if (fps && (!(*fps > 0.0) || *fps > kMost)) {
    throw std::invalid_argument(fmt::format("fps = {}, must be more than 0 and at most {}", *fps, kMost));
  }
  if ((fps ? 1 : 0) + (file.empty() ? 0 : 1) + (names ? 1 : 0) > 1) {
    throw std::invalid_argument("times = " + (file.empty() ? "names" : file) + ", must not be given together with " +
                                (fps ? fmt::format("fps = {}", *fps) : "names"));
  }
}

FrameClock::FrameClock(const fs::path& folder, int last_number, const TimeSource& source) : fps_(source.fps.value_or(1.0)) {
  source.validate();
  const fs::path own = folder / "times.txt";
  std::error_code error;
  if (source.names) {
    throw std::invalid_argument(fmt::format(
        "times = names, must not be given: the names in {} are frame numbers (a pattern takes any)", folder.string()));
  }
  if (source.is_given() && fs::exists(own, error)) {
    throw std::invalid_argument(fmt::format("{}, must not be given: {} tells the times", to_string(source), own.string()));
  }
  times_ = read_times(source.file.empty() ? own : fs::path(source.file), last_number);
  if (times_.empty() && !source.file.empty()) throw std::runtime_error(source.file + ": no such file");
}

double FrameClock::at(int number) const { return times_.empty() ? number / fps_ : times_[static_cast<std::size_t>(number)]; }

std::vector<FrameFiles> pair_by_number(const NumberedFolder& left, const NumberedFolder& right, const fs::path& sequence,
                                       const TimeSource& times) {
  const std::vector<int> left_numbers = numbers_of(left.files);
  const std::vector<int> right_numbers = numbers_of(right.files);
  std::vector<int> numbers;
  std::ranges::set_union(left_numbers, right_numbers, std::back_inserter(numbers));
  const fs::path& folder = left.folder.empty() ? right.folder : left.folder;
  if (numbers.empty())
    throw std::runtime_error(
        folder.string() + (left.folder.empty() ? ": holds no disparity or depth images" : ": holds no PNG or JPEG pictures"));
  check_gaps(folder, numbers);
  const FrameClock clock(sequence, numbers.back(), times);
  std::vector<FrameFiles> files;
  for (int number = numbers.front(); number <= numbers.back(); ++number) {
    files.push_back({number, clock.at(number), left.folder.empty() ? "" : picture_or_expected(left.files, left.folder, number),
                     picture_or_expected(right.files, right.folder, number)});
  }
  return files;
}

std::optional<std::string> unequal_counts(const std::string& folder, const std::vector<int>& left,
                                          const std::vector<int>& right, const std::string& right_name) {
  if (left.size() == right.size()) return std::nullopt;
  std::vector<int> alone;
  std::set_symmetric_difference(left.begin(), left.end(), right.begin(), right.end(), std::back_inserter(alone));
  const bool left_is_longer = left.size() > right.size();
  const std::vector<int>& shorter = left_is_longer ? right : left;
  const std::string counts = fmt::format("{}: {} left and {} {} pictures", folder, left.size(), right.size(), right_name);
  if (shorter.empty() || shorter.back() < alone.front()) {
    return fmt::format("{}: from frame {} on the {} ones are missing", counts, alone.front(),
                       left_is_longer ? right_name : "left");
  }
  return fmt::format("{}: frames without a partner: {}, the first is frame {}", counts, alone.size(), alone.front());
}

std::vector<ImuSample> read_imu_of(const fs::path& sequence) {
  std::error_code error;
  const fs::path imu = sequence / "imu.csv";
  return fs::exists(imu, error) ? read_imu(imu.string()) : std::vector<ImuSample>();
}

CalibrationFiles find_calibration(const fs::path& folder, CalibrationFiles given) {
  if (!given.path.empty()) return given;
  given.path = (folder / "calib.txt").string();  // expected when there is none
  for (const char* name : {"calib.txt", "calib.yaml", "calib.conf"}) {
    std::error_code error;
    if (!fs::exists(folder / name, error)) continue;
    given.path = (folder / name).string();
    break;
  }
  return given;
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
