#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "app/command.hpp"

namespace brink::test {
namespace {

using Names = std::set<std::string>;

std::string encoded(const std::string& extension, const cv::Mat& picture) {
  std::vector<uchar> bytes;
  cv::imencode(extension, picture, bytes);
  return {bytes.begin(), bytes.end()};
}

cv::Mat grey(int width, int height, int type = CV_8UC1) { return {height, width, type, cv::Scalar::all(120)}; }

/// A folder with one good picture and calibration and every bad one.
class BadInput : public ::testing::Test {
 protected:
  BadInput() {
    const cv::Mat good = make_texture({160, 120}, 1);
    const std::string png = encoded(".png", good);
    const std::string jpeg = encoded(".jpg", good);
    add("good.png", png);
    add("good.jpg", jpeg);
    add("cut.png", png.substr(0, png.size() / 2));
    add("cut.jpg", jpeg.substr(0, jpeg.size() / 2));
    add("text.png", "this is no picture\n");
    add("empty.png", "");
    add("deep.png", encoded(".png", grey(160, 120, CV_16UC1)));
    add("alpha.png", encoded(".png", grey(160, 120, CV_8UC4)));
    add("large.png", encoded(".png", grey(200, 120)));
    add("dot.png", encoded(".png", grey(1, 1)));
    add("tiny.png", encoded(".png", grey(12, 9)));
    const std::string left = "P0: 350 0 80 0 0 350 60 0 0 0 1 0\n";
    add("good.txt", left + "P1: 350 0 80 -52.5 0 350 60 0 0 0 1 0\n");
    add("swapped.txt", left + "P1: 350 0 80 52.5 0 350 60 0 0 0 1 0\n");
    add("nan.txt", left + "P1: nan 0 80 -52.5 0 350 60 0 0 0 1 0\n");
    add("half.txt", left);
    add("prose.txt", "the cameras are 15 cm apart\n");
    add("broken.yaml", "elas: {max_disparity: 3\n");
    add("unknown.yaml", "elas: {max_disparty: 3}\n");
    add("empty/image_0/notes.txt", "no pictures here\n");
    add("bad/calib.txt", left + "P1: 350 0 80 -52.5 0 350 60 0 0 0 1 0\n");
    add("bad/image_0/000000.png", png);
    add("bad/image_1/000000.png", "this is no picture\n");
    before_ = folder_.list();
  }

  void add(const std::string& name, const std::string& bytes) { (void)folder_.add(name, bytes); }

  // Every word with a @ in front becomes a path in the folder.
  [[nodiscard]] std::string in_folder(std::string arguments) const {
    for (std::size_t at = arguments.find('@'); at != std::string::npos; at = arguments.find('@')) {
      arguments.replace(at, 1, folder_ / "");
    }
    return arguments;
  }

  // One line about the fault, the last one, that holds `part`, the exit code, and nothing left behind. Bad frames are in the
  // output as well, when it can be written to.
  void expect_refusal(const std::string& arguments, int exit_code, const std::string& part) const {
    const CommandResult result = run_command(in_folder(arguments));
    const std::vector<std::string> faults = faults_of(result);
    EXPECT_EQ(result.exit_code, exit_code) << arguments;
    ASSERT_EQ(faults.size(), 1U) << arguments << "\n" << result.errors;
    EXPECT_EQ(faults[0], lines_of(result.errors).back());
    EXPECT_TRUE(faults[0].starts_with("brink: ")) << result.errors;
    EXPECT_NE(faults[0].find(part), std::string::npos) << "\"" << result.errors << "\" does not hold \"" << part << "\"";
    EXPECT_EQ(folder_.list(), before_) << arguments;
  }

  // The same for a pair of pictures, in both commands that take one.
  void expect_pair_refused(const std::string& left, const std::string& right, const std::string& part) const {
    const std::string outputs = " --calib @good.txt --overlay @overlay --out @out.jsonl";
    expect_refusal("detect " + left + " --right " + right + outputs, 1, part);
    expect_refusal("disparity " + left + " " + right + " --out @out.png", 1, part);
  }

  void expect_calibration_refused(const std::string& calibration, const std::string& part) const {
    expect_refusal("detect @good.png --right @good.png --out @out.jsonl --overlay @o --calib " + calibration, 1, part);
    expect_refusal("bench @good.png --right @good.png --calib " + calibration, 1, part);
  }

  TemporaryFolder folder_;
  Names before_;
};

TEST_F(BadInput, MissingPicture) {
  expect_refusal("detect @none.png --right @good.png --calib @good.txt --out @out.jsonl", 1, "none.png: no such file");
  expect_refusal("detect @good.png --right @none.png --calib @good.txt --out @out.jsonl", 1, "none.png: no such file");
  expect_refusal("disparity @none.png @good.png --out @out.png", 1, "none.png: no such file");
}

TEST_F(BadInput, PictureThatIsNone) {
  expect_pair_refused("@good.png", "@text.png", "text.png: is not a PNG or JPEG picture");
  expect_pair_refused("@empty.png", "@good.png", "empty.png: is empty, expected a PNG or JPEG picture");
  expect_refusal("disparity @good.png @empty --out @out.png", 1, "empty: is a folder, expected a file");
}

TEST_F(BadInput, TruncatedPicture) {
  expect_pair_refused("@cut.png", "@good.png", "cut.png: is a truncated PNG picture, expected a whole one");
  expect_pair_refused("@good.jpg", "@cut.jpg", "cut.jpg: is a truncated JPEG picture, expected a whole one");
}

TEST_F(BadInput, PicturesOfDifferentSizes) {
  expect_pair_refused("@good.png", "@large.png", "pictures differ in size: left 160x120, right 200x120 px");
}

TEST_F(BadInput, PictureOf16BitsOrFourChannels) {
  expect_pair_refused("@deep.png", "@deep.png", "deep.png: is a 16-bit picture, expected 8-bit");
  expect_pair_refused("@alpha.png", "@alpha.png", "alpha.png: has 4 channels, expected 1 (grey) or 3 (colour)");
}

TEST_F(BadInput, TinyPicture) {
  expect_pair_refused("@dot.png", "@dot.png", "left picture is 1x1 px, must be at least 32x32");
  expect_pair_refused("@tiny.png", "@tiny.png", "left picture is 12x9 px, must be at least 32x32");
}

TEST_F(BadInput, Calibration) {
  expect_calibration_refused("@none.txt", "none.txt: no such file");
  expect_calibration_refused("@swapped.txt", "swapped.txt: KITTI, P0 and P1: baseline = -0.15 m, expected more than 0");
  expect_calibration_refused("@nan.txt", "nan.txt: P1, number 1 = nan, expected a finite number");
  expect_calibration_refused("@half.txt", "half.txt: P1 is missing");
  expect_calibration_refused("@prose.txt", "prose.txt: is not a calibration that this version knows");
}

TEST_F(BadInput, Sequence) {
  expect_refusal("detect @none --out @out.jsonl", 1, "none: no such file or folder");
  expect_refusal("detect @empty --out @out.jsonl", 1, "no pictures, expected folders image_2 and image_3");
}

TEST_F(BadInput, SequenceWithoutOneGoodFrame) {
  const CommandResult result = run_command(in_folder("detect @bad --out @out.jsonl --overlay @pictures"));
  EXPECT_EQ(result.exit_code, 1);
  const auto lines = faults_of(result);
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_NE(lines[0].find("image_1/000000.png: is not a PNG or JPEG picture"), std::string::npos);
  EXPECT_EQ(lines[1], "brink: none of 1 frames can be used");
  EXPECT_EQ(folder_.list(), before_);
}

TEST_F(BadInput, CommandLine) {
  expect_refusal("", 2, "no command given");
  expect_refusal("detekt", 2, "detekt");
  expect_refusal("detect", 2, "INPUT is required");
  expect_refusal("detect @good.png --quickly", 2, "--quickly");
  expect_refusal("detect @good.png --out @out.jsonl", 2, "--right and --calib are needed");
  expect_refusal("detect @bad --right @good.png", 2, "--right goes with one picture");
  expect_refusal("detect @good.png --right @good.png --calib @good.txt --matcher magic", 2, "--matcher");
  expect_refusal("detect @good.png --right @good.png --calib @good.txt --threads 0", 2, "--threads");
  expect_refusal("detect @good.png --right @good.png --calib @good.txt --threads two", 2, "--threads");
  expect_refusal("disparity @good.png @good.png", 2, "--out is required");
  expect_refusal("disparity @good.png @good.png --out @out.tiff", 2, "expected .png or .pfm");
  expect_refusal("bench @bad --repeat 0", 2, "--repeat");
}

TEST_F(BadInput, Parameters) {
  const std::string detect = "detect @good.png --right @good.png --calib @good.txt --out @out.jsonl ";
  expect_refusal(detect + "--set candidates.min_dept_m=1", 2, "did you mean candidates.min_depth_m?");
  expect_refusal(detect + "--set candidates.min_depth_m", 2, "must be key=value");
  expect_refusal(detect + "--set candidates.min_depth_m=deep", 2, "candidates.min_depth_m = deep, must be a number");
  expect_refusal(detect + "--set candidates.min_depth_m=-1", 2, "candidates.min_depth_m = -1, must be");
  expect_refusal(detect + "--set elas.max_disparity=0.5", 2, "elas.max_disparity = 0.5, must be a whole number");
  expect_refusal(detect + "--params @none.yaml", 1, "none.yaml: no such file");
  expect_refusal(detect + "--params @broken.yaml", 1, "broken.yaml: is not YAML: line ");
  expect_refusal(detect + "--params @unknown.yaml", 1, "unknown.yaml: unknown parameter elas.max_disparty");
}

TEST_F(BadInput, OutputThatCannotBeWritten) {
  const std::string detect = "detect @good.png --right @good.png --calib @good.txt ";
  const std::string disparity = "disparity @good.png @good.png ";
  expect_refusal(detect + "--out @none/out.jsonl", 1, "none/out.jsonl: cannot be written: No such file or directory");
  expect_refusal(detect + "--out @bad", 1, "bad: cannot be written: Is a directory");
  expect_refusal(detect + "--overlay @good.png", 1, "good.png: cannot be written: Not a directory");
  expect_refusal(detect + "--overlay @none/walk.mp4", 1, "none/walk.mp4: cannot be written: No such file or directory");
  expect_refusal(detect + "--overlay @walk.mov", 2, "walk.mov: a video must be named .mp4, .avi or .mkv");
  expect_refusal(detect + "--out @none/out.jsonl --overlay @walk.mp4", 1, "none/out.jsonl: cannot be written");
  expect_refusal(detect + "--out @none/out.jsonl --overlay @pictures", 1, "none/out.jsonl: cannot be written");
  expect_refusal(disparity + "--out @none/out.png", 1, "none/out.png: cannot be written: No such file or directory");
}

TEST_F(BadInput, FullDisk) {
  expect_refusal("detect @good.png --right @good.png --calib @good.txt --out /dev/full", 1,
                 "/dev/full: cannot be written: No space left");
  expect_refusal("detect @good.png --right @good.png --calib @good.txt > /dev/full", 1,
                 "standard output: cannot be written: No space left");
  expect_refusal("params > /dev/full", 1, "standard output: cannot be written: No space left");
  expect_refusal("bench @good.png --right @good.png --calib @good.txt --repeat 1 > /dev/full", 1,
                 "standard output: cannot be written");
}

TEST_F(BadInput, FileThatOutgrowsItsLimit) {
  const CommandResult result = run_command(in_folder("disparity @good.png @good.png --out @out.pfm"), "ulimit -f 16; ");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.errors, in_folder("brink: @out.pfm: cannot be written: File too large\n"));
  EXPECT_EQ(folder_.list(), before_);
}

// Black, white and identical pairs are pictures like any other: the answer is that no ground can be seen.
TEST_F(BadInput, PicturesWithoutGroundAreNoError) {
  add("black.png", encoded(".png", cv::Mat1b(120, 160, uchar{0})));
  add("white.png", encoded(".png", cv::Mat1b(120, 160, uchar{255})));
  for (const std::string name : {"black.png", "white.png", "good.png"}) {
    const CommandResult result = run_command(in_folder(fmt::format("detect @{0} --right @{0} --calib @good.txt", name)));
    EXPECT_EQ(result.exit_code, 0) << name << result.errors;
    const nlohmann::json detection = detections_of(result.output).at(0);
    EXPECT_EQ(detection["status"], "ok") << name;
    EXPECT_EQ(detection["ground"]["state"], "not_visible") << name;
    EXPECT_FALSE(detection["ground"]["reason"].get<std::string>().empty()) << name;
    EXPECT_TRUE(detection["obstacles"].empty()) << name;
    EXPECT_NE(result.errors.find("not visible in 1 ("), std::string::npos) << result.errors;
  }
}

}  // namespace
}  // namespace brink::test
