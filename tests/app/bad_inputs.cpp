// Runs brink on bad inputs and prints what it says, as a table in Markdown (scripts/bad-inputs). Every case must end with the
// exit code that is expected, within its time, with one line on standard error beyond what the input was recognised as, and
// leave no file behind. Exit code 1 when one does not.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include "app/bad_input_files.hpp"
#include "app/command.hpp"

namespace brink::test {
namespace {

constexpr int kOk = 0;
constexpr int kData = 1;
constexpr int kUsage = 2;

constexpr const char* kAsUser = "USER";  // as somebody who may not do everything, as root may

/// One row. The command runs in the folder of make_files, by the shell.
struct Case {
  const char* what;
  std::string command;      ///< what follows "brink "
  int exit_code = kData;    ///< that is expected
  int lines = 1;            ///< that are expected, beyond what the input was recognised as
  const char* before = "";  ///< shell commands that prepare the ground, with "; "
};

// clang-format off
const std::string kPair = "detect good.png --right good.png --calib good.txt --out out.jsonl";

std::string pair(const std::string& left, const std::string& right) {
  return "detect " + left + " --right " + right + " --calib good.txt --out out.jsonl --overlay drawn";
}
std::string calibrated(const std::string& calibration) {
  return "detect good.png --right good.png --out out.jsonl --calib " + calibration;
}
std::string with(const std::string& option) { return kPair + " " + option; }
std::string patterns(const std::string& rest) { return "detect 'l/*.png' --out out.jsonl --calib good.txt " + rest; }
std::string side_by_side(const std::string& rest) { return "detect " + rest + " --calib good.txt --out out.jsonl"; }
std::string sequence(const std::string& folder) { return "detect " + folder + " --out out.jsonl"; }

const std::vector<std::pair<const char*, std::vector<Case>>> kCases = {
  {"Command line", {
    {"nothing at all", "", kUsage},
    {"a command that is none", "detekt", kUsage},
    {"no input", "detect", kUsage},
    {"an option that is none", "detect good.png --quickly", kUsage},
    {"one picture alone", "detect good.png --out out.jsonl", kUsage},
    {"a pattern that the shell has taken apart", "detect l/*.png --right r/*.png --calib good.txt", kUsage},
    {"a folder with a right picture", sequence("badpair") + " --right good.png", kUsage},
    {"a matcher that is none", with("--matcher magic"), kUsage},
    {"no threads", with("--threads 0"), kUsage},
    {"frames per second of one pair", with("--fps 15"), kUsage},
    {"0 frames per second", sequence("badpair") + " --fps 0", kUsage},
    {"a disparity file of an unknown kind", "disparity good.png good.png --out out.bmp", kUsage},
    {"no repetitions", "bench badpair --repeat 0", kUsage},
    {"a camera on the ground", "envelope --calib good.txt --camera-height 0", kUsage},
    {"a camera that looks straight down", "envelope --calib good.txt --pitch 90", kUsage},
    {"an envelope without a calibration", "envelope --camera-height 1.6", kUsage},
  }},
  {"Pictures", {
    {"missing", pair("good.png", "none.png")},
    {"a folder", pair("good.png", "l")},
    {"empty", pair("empty.png", "good.png")},
    {"text named .png", pair("good.png", "text.png")},
    {"a video named .png", pair("good.png", "video.png")},
    {"a GIF named .jpg", pair("good.png", "picture.jpg")},
    {"a TIFF", pair("picture.tiff", "picture.tiff")},
    {"truncated PNG", pair("cut.png", "good.png")},
    {"truncated JPEG", pair("good.jpg", "cut.jpg")},
    {"PNG with a flipped bit", pair("flipped.png", "good.png")},
    {"PNG of 100000x100000 px that holds none of them", pair("bomb.png", "bomb.png")},
    {"PNG of 10000x10000 black px, 97 kB", pair("huge.png", "huge.png")},
    {"JPEG whose header says 65500x65500 px", pair("bomb.jpg", "good.png")},
    {"16 bits", pair("deep.png", "deep.png")},
    {"with transparency", pair("alpha.png", "alpha.png")},
    {"of two sizes", pair("good.png", "large.png")},
    {"1x1 px", pair("dot.png", "dot.png")},
    {"12x9 px", pair("tiny.png", "tiny.png")},
    {"not readable", "detect secret.png --right good.png --calib good.txt", kData, 1, kAsUser},
    {"black", pair("black.png", "black.png"), kOk},
    {"left and right exchanged", "detect right.png --right left.png --calib good.txt --out out.jsonl", kOk},
  }},
  {"Calibration", {
    {"missing", calibrated("none.txt")},
    {"a folder", calibrated("l")},
    {"empty", calibrated("empty.png")},
    {"prose", calibrated("prose.txt")},
    {"a picture", calibrated("good.png")},
    {"left and right exchanged", calibrated("swapped.txt")},
    {"baseline in millimetres", calibrated("millimetres.txt")},
    {"baseline 0", calibrated("zero.txt")},
    {"a number that is none", calibrated("nan.txt")},
    {"half of it", calibrated("half.txt")},
    {"eleven numbers", calibrated("short.txt")},
    {"cameras above one another", calibrated("vertical.txt")},
    {"two focal lengths", calibrated("focal.txt")},
    {"OpenCV YAML cut off", calibrated("cut.yaml")},
    {"OpenCV YAML without matrices", calibrated("bare.yaml")},
    {"of pictures of another size, side by side", "detect 's/*.png' --side-by-side --calib size.yaml --out out.jsonl"},
    {"for pictures of 20000x20000 px", calibrated("gigabytes.yaml")},
    {"for other sizes only", calibrated("zed.conf")},
    {"of a lens that is not known", calibrated("omni.yaml")},
    {"of one camera, without the other", calibrated("sensor.yaml")},
    {"of raw and of rectified pictures, without a word which", calibrated("ros.yaml") + " --calib-right ros_right.yaml", kUsage},
    {"of rectified pictures for raw ones", calibrated("good.txt") + " --pictures raw", kUsage},
    {"with a right file that it has no use for", calibrated("good.txt") + " --calib-right good.txt", kUsage},
  }},
  {"Sequences", {
    {"missing", sequence("none")},
    {"an empty folder", sequence("nothing")},
    {"no pictures in it", sequence("notes")},
    {"no calibration in it", sequence("uncalibrated")},
    {"names that are no numbers", sequence("words")},
    {"frame numbers that jump", sequence("jump")},
    {"times that do not increase", sequence("still")},
    {"fewer times than frames", sequence("late")},
    {"times twice", sequence("still") + " --fps 15", kUsage},
    {"no frame that can be used", sequence("badpair") + " --overlay drawn", kData, 2},
    {"a broken imu.csv", sequence("imu")},
    {"EuRoC without its second camera", sequence("euroc")},
    {"poses of another sequence", sequence("badpair") + " --poses poses.txt"},
    {"poses that are none", sequence("badpair") + " --poses prose.txt"},
  }},
  {"Patterns", {
    {"that match nothing", "detect 'none/*.png' --right 'r/*.png' --calib good.txt --out out.jsonl"},
    {"for the left eye only", patterns(""), kUsage},
    {"with one right picture", patterns("--right good.png"), kUsage},
    {"that cannot be paired", patterns("--right 'words/image_0/*.png'")},
    {"with two places for a number", "detect 'l/%d_%d.png' --right 'r/*.png' --calib good.txt", kUsage},
    {"with names that tell no times", "detect 'words/image_?/*.png' --side-by-side --times names --calib good.txt"},
    {"with too few times", patterns("--right 'r/*.png' --times late/times.txt")},
    {"with no such file of times", patterns("--right 'r/*.png' --times none.txt")},
    {"with times from two sources", patterns("--right 'r/*.png' --times names --fps 15"), kUsage},
  }},
  {"Disparity and depth images", {
    {"16 bit in place of the right picture, not said as what", pair("good.png", "deep.png")},
    {"as what it cannot be", kPair + " --as height", kUsage},
    {"a picture of 8 bit as disparities", with("--as disparity")},
    {"another size than the left picture", "detect good.png --right wide16.png --as depth --calib good.txt --out out.jsonl"},
    {"missing", "detect good.png --right none.pfm --as depth --calib good.txt --out out.jsonl"},
    {"truncated PFM", "detect good.png --right cut.pfm --as disparity --calib good.txt --out out.jsonl"},
    {"PFM of 160000x120000 px", "detect size.pfm --as disparity --calib good.txt --out out.jsonl"},
    {"PFM of three colours", "detect color.pfm --as disparity --calib good.txt --out out.jsonl"},
    {"text named .exr", "detect text.exr --as depth --calib good.txt --out out.jsonl"},
    {"without a calibration", "detect deep.png --as depth --out out.jsonl", kUsage},
    {"a folder without such images", sequence("badpair") + " --as depth"},
  }},
  {"Side by side", {
    {"without a calibration", "detect s --side-by-side", kUsage},
    {"with a right picture", side_by_side("s --side-by-side --right good.png"), kUsage},
    {"one picture", side_by_side("s/0.png --side-by-side"), kUsage},
    {"an odd width", side_by_side("'odd/*.png' --side-by-side"), kData, 2},
    {"a text instead of a video", side_by_side("prose.txt")},
    {"an empty video", side_by_side("empty.mp4")},
    {"half a video", side_by_side("cut.mp4")},
    {"a device", side_by_side("/dev/null")},
  }},
  {"Parameters", {
    {"mistyped", with("--set candidates.min_dept_m=1"), kUsage},
    {"without a value", with("--set candidates.min_depth_m"), kUsage},
    {"of another type", with("--set candidates.min_depth_m=deep"), kUsage},
    {"out of range", with("--set candidates.min_depth_m=-1"), kUsage},
    {"a fraction of a pixel", with("--set elas.max_disparity=0.5"), kUsage},
    {"a missing file", with("--params none.yaml")},
    {"a broken file", with("--params broken.yaml")},
    {"a file with a mistyped name", with("--params unknown.yaml")},
    {"a file of something else", with("--params good.png")},
  }},
  {"Results to evaluate", {
    {"missing", "evaluate none.jsonl --truth truth"},
    {"empty", "evaluate empty.png --truth truth"},
    {"of something else", "evaluate prose.txt --truth truth"},
    {"cut off", "evaluate cut.jsonl --truth truth"},
    {"of another sequence", "evaluate two.jsonl --truth truth"},
    {"without truth", "evaluate one.jsonl --truth nothing"},
    {"scores that are none", "compare prose.txt prose.txt"},
  }},
  {"Output", {
    {"into no folder", kPair.substr(0, kPair.find(" --out")) + " --out none/out.jsonl"},
    {"onto a folder", kPair.substr(0, kPair.find(" --out")) + " --out l"},
    {"a full disk", kPair.substr(0, kPair.find(" --out")) + " --out /dev/full"},
    {"a full disk, by the shell", kPair.substr(0, kPair.find(" --out")) + " > /dev/full"},
    {"a file that outgrows its limit", "disparity good.png good.png --out out.pfm", kData, 1, "ulimit -f 16; "},
    {"a folder that may not be written", kPair.substr(0, kPair.find(" --out")) + " --out locked/out.jsonl", kData, 1, kAsUser},
    {"pictures into a file", with("--overlay good.png")},
    {"a video into no folder", with("--overlay none/walk.mp4")},
    {"a video of a kind that is not written", with("--overlay walk.mov"), kUsage},
    {"a table onto a full disk", "params > /dev/full"},
    {"a walk into no place", "simulate stairs --frames 1 --width 64 --height 48 --out /proc/walk"},
    {"a walk onto another folder", "simulate stairs --frames 1 --width 64 --height 48 --out l"},
  }},
};
// clang-format on

/// What became of a case.
struct Outcome {
  int exit_code = -1;
  std::vector<std::string> lines;   ///< on standard error, without what the input was recognised as
  std::vector<std::string> broken;  ///< rules
};

bool is_announcement(const std::string& line) {
  return line.find("calibration: ") != std::string::npos || line.find("EuRoC/ASL, rectified") != std::string::npos ||
         line.starts_with("brink: one pair: candidates are reported");
}

Outcome run(const Case& bad, const TemporaryFolder& folder) {
  constexpr int kSeconds = 20;
  const std::set<std::string> before = folder.list();
  const TemporaryFolder elsewhere;
  const bool as_user = std::string(bad.before) == kAsUser;
  std::string line = fmt::format("cd {}; {}", folder / "", as_user ? "" : bad.before);
  if (as_user && ::geteuid() == 0) line += "setpriv --reuid=65534 --regid=65534 --clear-groups ";
  line += fmt::format("timeout {} {} {} 2> {}", kSeconds, BRINK_COMMAND, bad.command, elsewhere / "errors");
  if (bad.command.find('>') == std::string::npos) line += " > " + elsewhere / "output";
  const int status = std::system(line.c_str());  // NOLINT(bugprone-command-processor): that is what is shown
  Outcome outcome;
  if (WIFEXITED(status)) outcome.exit_code = WEXITSTATUS(status);
  for (const std::string& said : lines_of(read_file(elsewhere / "errors"))) {
    if (!is_announcement(said)) outcome.lines.push_back(said);
  }
  if (outcome.exit_code != bad.exit_code) {
    outcome.broken.push_back(fmt::format("exit code {}, expected {}", outcome.exit_code, bad.exit_code));
  }
  if (std::ssize(outcome.lines) != bad.lines) {
    outcome.broken.push_back(fmt::format("{} lines, expected {}", outcome.lines.size(), bad.lines));
  }
  for (const std::string& said : outcome.lines) {
    if (!said.starts_with("brink: ")) outcome.broken.push_back("a line that does not say who is speaking");
  }
  std::vector<std::string> left_behind;
  std::ranges::set_difference(folder.list(), before, std::back_inserter(left_behind));
  for (const std::string& name : left_behind) {
    if (bad.exit_code != kOk) outcome.broken.push_back("left behind: " + name);
    std::filesystem::remove_all(folder / name);
  }
  return outcome;
}

/// A cell of a Markdown table.
std::string cell(const std::string& text) {
  std::string escaped;
  for (const char letter : text) escaped += letter == '|' ? std::string("\\|") : std::string(1, letter);
  return escaped;
}

int print_table() {
  const TemporaryFolder folder;
  add_pictures(folder);
  add_calibrations(folder);
  add_sequences(folder);
  add_videos(folder);
  std::filesystem::permissions(folder / "", std::filesystem::perms(0755));
  std::filesystem::permissions(folder / "secret.png", std::filesystem::perms::none);
  std::filesystem::create_directory(folder / "locked");
  std::filesystem::permissions(folder / "locked", std::filesystem::perms(0555));
  int broken = 0;
  int count = 0;
  for (const auto& [group, cases] : kCases) {
    fmt::print("\n## {}\n\n| input | brink says | exit code |\n|---|---|---|\n", group);
    for (const Case& bad : cases) {
      const Outcome outcome = run(bad, folder);
      fmt::print("| {}<br>`brink {}` | {} | {} |\n", bad.what, cell(bad.command),
                 cell(fmt::format("{}", fmt::join(outcome.lines, "<br>"))), outcome.exit_code);
      for (const std::string& rule : outcome.broken) fmt::print(stderr, "bad-inputs: {}: {}: {}\n", group, bad.what, rule);
      broken += outcome.broken.empty() ? 0 : 1;
      ++count;
    }
  }
  fmt::print("\n{} inputs, {} that break a rule.\n", count, broken);
  return broken == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace
}  // namespace brink::test

int main() { return brink::test::print_table(); }
