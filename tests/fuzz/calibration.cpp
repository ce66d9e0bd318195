// Calibration files of all kinds, one or a pair ("=== left", "=== right"): a calibration that is valid, or a refusal.
#include "brink/calibration.hpp"

#include "input_files.hpp"

namespace {

brink::CalibrationFiles put_files(std::string_view text) {
  const auto files = brink::fuzz::split_files(text);
  if (files.size() < 2) return {brink::fuzz::put("calibration", text)};
  return {brink::fuzz::put("left", files[0].second), brink::fuzz::put("right", files[1].second)};
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace brink;
  CalibrationFiles files = put_files(fuzz::text_of(data, size));
  const auto check = [](const std::optional<StereoCalibration>& calibration) {
    if (!calibration) return;
    calibration->camera.validate();
    fuzz::require(!describe(*calibration).empty(), "a calibration that nothing can be said of");
  };
  for (const auto pictures :
       {std::optional<PictureState>(), std::optional(PictureState::raw), std::optional(PictureState::rectified)}) {
    files.pictures = pictures;
    for (const cv::Size picture : {cv::Size(), cv::Size(160, 120), cv::Size(672, 376)}) {
      check(fuzz::result_of([&] { return read_calibration(files, picture); }));
    }
  }
  check(fuzz::result_of([&] { return read_calibration(files, {}, CameraPair::grey); }));
  check(fuzz::result_of([&] { return read_depth_calibration(files, {160, 120}); }));
  return 0;
}
