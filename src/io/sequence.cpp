#include "brink/sequence.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "brink/calibration.hpp"
#include "brink/pictures.hpp"
#include "io/sequence_files.hpp"

namespace brink {
namespace fs = std::filesystem;
namespace {

constexpr int kMaxGap = 1000;  // more missing numbers in a row are no gap but another numbering

void check_gaps(const fs::path& folder, const std::vector<int>& numbers) {
  for (std::size_t i = 1; i < numbers.size(); ++i) {
    if (numbers[i] - numbers[i - 1] > kMaxGap) {
      throw std::runtime_error(fmt::format("{}: frame numbers jump from {} to {}, expected consecutive ones", folder.string(),
                                           numbers[i - 1], numbers[i]));
    }
  }
}

// Numbers of both eyes, ascending, each once.
std::vector<int> numbers_of(const NumberedFiles& left, const NumberedFiles& right) {
  std::vector<int> numbers;
  numbers.reserve(left.size() + right.size());
  for (const auto& picture : left) numbers.push_back(picture.first);
  for (const auto& picture : right) numbers.push_back(picture.first);
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  return numbers;
}

// A missing picture gets the name that it would have.
std::string picture_or_expected(const NumberedFiles& pictures, const fs::path& folder, int number) {
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
  const std::optional<Eyes> found = find_eyes(folder);
  if (!found) {
    throw std::runtime_error(folder +
                             ": no pictures, expected folders image_2 and image_3 (colour) or image_0 and image_1 (grey)");
  }
  const Eyes& eyes = *found;
  const StereoCalibration calibration = read_calibration((fs::path(folder) / "calib.txt").string(), eyes.cameras);
  const NumberedFiles left = list_pictures(eyes.left);
  const NumberedFiles right = list_pictures(eyes.right);
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
