// Truth of a sequence: instances, poses (KITTI and TUM), times and calibration beside one mask.
#include "brink/truth.hpp"

#include <filesystem>

#include "brink/pictures.hpp"
#include "brink/trajectory.hpp"
#include "input_files.hpp"

namespace {

/// 16x12 px, with the obstacles 1 and 2.
const std::string& mask() {
  static const std::string bytes = [] {
    cv::Mat1b negative(12, 16, std::uint8_t{0});
    negative(cv::Rect(3, 4, 5, 4)) = 1;
    negative(cv::Rect(10, 6, 3, 5)) = 2;
    return brink::encode_png(negative);
  }();
  return bytes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace brink;
  const test::TemporaryFolder folder;
  (void)folder.add("negative/000000.png", mask());
  for (const auto& [name, content] : fuzz::split_files(fuzz::text_of(data, size))) {
    for (const char* known : {"instances.yaml", "poses.txt", "times.txt", "calib.txt"}) {
      if (name == known) (void)folder.add(name, std::string(content));
    }
  }
  (void)fuzz::result_of([&] { return SequenceTruth(folder / "").read(0); });
  const auto trajectory = fuzz::result_of([&] { return read_trajectory(folder / "poses.txt"); });
  if (trajectory) {
    (void)fuzz::result_of([&] { return to_kitti(*trajectory) + to_tum(*trajectory); });
    (void)fuzz::result_of([&] { return compute_trajectory_errors(*trajectory, *trajectory, 1.0); });
  }
  return 0;
}
