#include "brink/sequence.hpp"

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "brink/calibration.hpp"
#include "io/euroc.hpp"
#include "io/picture_patterns.hpp"
#include "io/picture_source.hpp"
#include "io/rectification.hpp"
#include "io/sequence_files.hpp"

namespace brink {
namespace fs = std::filesystem;
namespace {

std::vector<FrameStamp> stamps_of(const std::vector<FrameFiles>& files) {
  std::vector<FrameStamp> stamps;
  stamps.reserve(files.size());
  for (const FrameFiles& frame : files) stamps.push_back({frame.index, frame.time});
  return stamps;
}

// Into the axes of the rectified left camera.
void turn(std::vector<ImuSample>& samples, const Eigen::Matrix3d& rectified_from_left) {
  for (ImuSample& sample : samples) {
    sample.angular_rate = rectified_from_left * sample.angular_rate;
    sample.specific_force = rectified_from_left * sample.specific_force;
  }
}

Sequence open_kitti(const fs::path& folder, const TimeSource& times, const CalibrationFiles& given) {
  const std::optional<Eyes> eyes = find_eyes(folder);
  if (!eyes) {
    throw std::runtime_error(folder.string() +
                             ": no pictures, expected folders image_2 and image_3 (colour), image_0 and image_1 (grey), or "
                             "mav0 (EuRoC/ASL)");
  }
  const NumberedFolder left{eyes->left, list_pictures(eyes->left)};
  const NumberedFolder right{eyes->right, list_pictures(eyes->right)};
  const std::vector<FrameFiles> files = pair_by_number(left, right, folder, times);
  const StereoCalibration calibration =
      read_calibration(find_calibration(folder, given), first_picture_size(files), eyes->cameras);
  std::vector<std::string> remarks{
      fmt::format("{}: KITTI layout, {} frames; calibration: {}", folder.string(), files.size(), describe(calibration))};
  const auto remark = unequal_counts(folder.string(), numbers_of(left.files), numbers_of(right.files));
  if (remark) remarks.push_back(*remark);
  std::vector<ImuSample> samples = read_imu_of(folder);
  if (calibration.rectification) turn(samples, calibration.rectification->rectified_from_left);
  return {calibration.camera, stamps_of(files),
          std::make_unique<CalibratedSource>(std::make_unique<PictureFiles>(files), calibration), std::move(samples),
          std::move(remarks)};
}

}  // namespace

Sequence::Sequence(const StereoCamera& camera, const std::vector<FrameFiles>& files, std::vector<ImuSample> imu)
    : Sequence(camera, stamps_of(files), std::make_unique<PictureFiles>(files), std::move(imu)) {}

Sequence::Sequence(const StereoCamera& camera, std::vector<FrameStamp> stamps, std::unique_ptr<PictureSource> source,
                   std::vector<ImuSample> imu, std::vector<std::string> remarks)
    : camera_(camera),
      stamps_(std::move(stamps)),
      source_(std::move(source)),
      imu_(std::move(imu)),
      remarks_(std::move(remarks)) {
  camera_.validate();
}

Sequence::Sequence(Sequence&&) noexcept = default;
Sequence& Sequence::operator=(Sequence&&) noexcept = default;
Sequence::~Sequence() = default;

FrameReading Sequence::read(int position) const {
  const FrameStamp& stamp = stamps_.at(static_cast<std::size_t>(position));
  FrameReading reading;
  reading.frame.index = stamp.index;
  reading.frame.time = stamp.time;
  std::string name;
  try {
    const PicturePair pair = source_->read(position);
    name = pair.name;
    reading.frame = pair.disparity.empty()
                        ? make_frame(pair.left, pair.right, camera_, stamp.index, stamp.time)
                        : make_frame_with_disparity(pair.left, pair.disparity, camera_, stamp.index, stamp.time);
    reading.frame.gravity = estimate_gravity(imu_, stamp.time);
    if (position > 0) {
      const double last_time = stamps_[static_cast<std::size_t>(position) - 1].time;
      reading.frame.current_from_previous_rotation = integrate_gyroscope(imu_, last_time, stamp.time);
    }
  } catch (const NoPicture& error) {
    reading.status = FrameStatus::no_picture;
    reading.reason = error.what();
  } catch (const std::invalid_argument& error) {
    reading.status = FrameStatus::bad_frame;
    reading.reason = fmt::format("{}: {}", name, error.what());
  } catch (const std::runtime_error& error) {
    reading.status = FrameStatus::bad_frame;
    reading.reason = error.what();
  }
  return reading;
}

Sequence open_sequence(const std::string& folder, const TimeSource& times, const CalibrationFiles& calibration) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) throw std::runtime_error(folder + ": no such folder");
  if (is_euroc(folder)) {
    if (times.is_given()) {
      throw std::invalid_argument(fmt::format("{}, must not be given: {} tells the times", to_string(times), folder));
    }
    if (!calibration.path.empty()) {
      throw std::invalid_argument(
          fmt::format("calib = {}, must not be given: {} has a sensor.yaml for each camera", calibration.path, folder));
    }
    return open_euroc(folder, calibration.pictures);
  }
  return open_kitti(folder, times, calibration);
}

Sequence open_pair(const std::string& left, const std::string& right, const CalibrationFiles& calibration) {
  const std::vector<FrameFiles> files{{0, 0.0, left, right}};
  const StereoCalibration known = read_calibration(calibration, first_picture_size(files));
  return {known.camera,
          stamps_of(files),
          std::make_unique<CalibratedSource>(std::make_unique<PictureFiles>(files), known),
          {},
          {fmt::format("{}: one pair; calibration: {}", left, describe(known))}};
}

Sequence open_pairs(const std::string& left, const std::string& right, const CalibrationFiles& calibration,
                    const TimeSource& times) {
  PatternFrames found = match_patterns(left, right, times);
  const StereoCalibration known = read_calibration(calibration, first_picture_size(found.frames));
  found.remarks.front() += "; calibration: " + describe(known);
  return {known.camera,
          stamps_of(found.frames),
          std::make_unique<CalibratedSource>(std::make_unique<PictureFiles>(found.frames), known),
          {},
          std::move(found.remarks)};
}

}  // namespace brink
