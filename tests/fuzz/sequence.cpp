// Indices of sequences: names of pictures, times, IMU readings, EuRoC's lists and cameras. What opens can be read frame by
// frame, in order of time.
#include "brink/sequence.hpp"

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "input_files.hpp"

namespace {
namespace fs = std::filesystem;

constexpr int kMostNames = 20;

/// Empty pictures, one for each line: they are named by the sequence, what is in them is no matter here.
void add_pictures(const fs::path& folder, std::string_view names) {
  fs::create_directories(folder);
  std::istringstream lines{std::string(names)};
  int count = 0;
  for (std::string name; std::getline(lines, name) && count < kMostNames; ++count) {
    const bool usable = name.size() < 60 && name.find('/') == std::string::npos && name.find('\0') == std::string::npos;
    if (usable && !name.empty() && name != "." && name != "..") std::ofstream(folder / name) << "x";
  }
}

/// Builds the folder that an input describes. @return whether it is EuRoC's layout.
bool make_folder(const fs::path& root, std::string_view text) {
  bool euroc = false;
  for (const auto& [name, content] : brink::fuzz::split_files(text)) {
    if (name == "left" || name == "right") add_pictures(root / (name == "left" ? "image_0" : "image_1"), content);
    for (const char* known :
         {"calib.txt", "times.txt", "imu.csv", "mav0/cam0/data.csv", "mav0/cam1/data.csv", "mav0/cam0/sensor.yaml",
          "mav0/cam1/sensor.yaml", "mav0/imu0/data.csv", "mav0/imu0/sensor.yaml"}) {
      if (name != known) continue;
      euroc = euroc || name.starts_with("mav0");
      fs::create_directories((root / name).parent_path());
      std::ofstream(root / name, std::ios::binary) << content;
    }
  }
  return euroc;
}

void check(const brink::Sequence& sequence) {
  using brink::fuzz::require;
  for (int i = 0; i < std::min(sequence.size(), 3); ++i) {
    require(sequence.read(i).status != brink::FrameStatus::ok, "a frame without pictures");
  }
  const std::vector<brink::FrameStamp>& stamps = sequence.stamps();
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    require(stamps[i].time > stamps[i - 1].time && stamps[i].index > stamps[i - 1].index, "frames that are not in order");
  }
  (void)estimate_gravity(sequence.imu(), stamps.back().time);
  (void)integrate_gyroscope(sequence.imu(), stamps.front().time, stamps.back().time);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace brink;
  const test::TemporaryFolder folder;
  const bool euroc = make_folder(folder / "", fuzz::text_of(data, size));
  const auto fps = euroc || size % 2 == 0 ? std::nullopt : std::optional(15.0);
  if (const auto sequence = fuzz::result_of([&] { return open_sequence(folder / "", {.fps = fps}); })) check(*sequence);
  if (euroc) return 0;
  for (const bool names : {false, true}) {
    const auto pairs = fuzz::result_of(
        [&] { return open_pairs(folder / "image_0/*", folder / "image_1/*", {folder / "calib.txt"}, {.names = names}); });
    if (pairs) check(*pairs);
  }
  return 0;
}
