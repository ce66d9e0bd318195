// Real potholes (R. Fan et al., TIP 2019 and arXiv 2012.10802), stills: found, false and missed regions, and pixel recall,
// precision and F over all frames, beside the published rows.

#include <cstdlib>
#include <limits>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "brink/detections.hpp"
#include "brink/detector.hpp"
#include "brink/pictures.hpp"
#include "brink/sequence.hpp"
#include "temporary_folder.hpp"
#include "test_data.hpp"

namespace brink {
namespace {

constexpr double kMinDepth = 0.010;  // m; one value for all pictures. The holes are 25 and 39 mm deep.

struct Score {
  int found = 0;
  int missed = 0;
  int false_regions = 0;
  int true_px = 0;
  int false_px = 0;
  int missed_px = 0;
  [[nodiscard]] double recall() const { return true_px / static_cast<double>(true_px + missed_px); }
  [[nodiscard]] double precision() const { return true_px / static_cast<double>(true_px + false_px); }
  [[nodiscard]] double f() const { return 2.0 * recall() * precision() / (recall() + precision()); }
};

void add_frame(Score& score, const Detection& detection, const cv::Mat1b& truth) {
  const cv::Mat1b hole(truth == 1);
  const cv::Mat1b labelled(truth != 255);
  cv::Mat1b reported(truth.size(), uchar{0});
  bool found = false;
  for (const NegativeObstacle& obstacle : detection.obstacles) {
    cv::Mat1b region(truth.size(), uchar{0});
    cv::drawContours(region, std::vector<std::vector<cv::Point>>{obstacle.candidate.contour}, -1, cv::Scalar(255), cv::FILLED);
    const int common = cv::countNonZero(region & hole);
    const bool hit = 2 * common >= cv::countNonZero(region) || 4 * common >= cv::countNonZero(region | hole);
    found = found || hit;
    score.false_regions += common == 0 ? 1 : 0;
    reported |= region;
  }
  (found ? score.found : score.missed) += 1;
  score.true_px += cv::countNonZero(reported & hole);
  score.false_px += cv::countNonZero(reported & ~hole & labelled);
  score.missed_px += cv::countNonZero(~reported & hole);
}

Score evaluate(const std::string& folder, const DetectorParams& params) {
  const Sequence sequence = open_sequence(folder);
  Detector detector(params);
  Score score;
  for (int i = 0; i < sequence.size(); ++i) {
    const FrameReading reading = sequence.read(i);
    EXPECT_EQ(reading.status, FrameStatus::ok) << reading.reason;
    const cv::Mat1b truth = cv::imread(fmt::format("{}/negative/{:06}.png", folder, reading.frame.index), cv::IMREAD_GRAYSCALE);
    add_frame(score, detector.process(reading.frame), truth);
  }
  return score;
}

Score evaluate_and_print(const std::string& folder, Matcher matcher, const DetectorParams& method, const char* name) {
  DetectorParams params = method;
  params.stills = true;
  params.disparity.matcher = matcher;
  params.candidates.min_depth_m = kMinDepth;
  const Score score = evaluate(folder, params);
  fmt::print("{:<22} {:2}/{}/{}  recall {:.3f}  precision {:.3f}  F {:.3f}\n", name, score.found, score.false_regions,
             score.missed, score.recall(), score.precision(), score.f());
  return score;
}

Score print_table(const std::string& folder) {
  fmt::print("found/false regions/missed, pixels; min_depth_m = {}\n", kMinDepth);
  evaluate_and_print(folder, Matcher::sgbm, DetectorParams::paper(), "sgbm, paper's rules");
  evaluate_and_print(folder, Matcher::elas, DetectorParams::paper(), "paper");
  evaluate_and_print(folder, Matcher::sgbm, DetectorParams::brink(), "sgbm, brink's rules");
  return evaluate_and_print(folder, Matcher::elas, DetectorParams::brink(), "brink");
}

TEST(Potholes, AllOfSetAAreFoundWithNoFalseRegion) {
  BRINK_REQUIRE_DATA(folder, "pothole_a");
  const Score score = print_table(folder);
  fmt::print("published: TIP 2019 .499 .987 .663, arXiv 2012.10802 .701 .964 .811\n");
  EXPECT_EQ(score.found, 8);
  EXPECT_EQ(score.false_regions, 0);
  EXPECT_GT(score.f(), 0.80);
}

TEST(Potholes, AllOfSetBAreFoundWithNoFalseRegion) {
  BRINK_REQUIRE_DATA(folder, "pothole_b");
  const Score score = print_table(folder);
  fmt::print("published: TIP 2019 .582 .983 .731, arXiv 2012.10802 .702 .996 .823\n");
  EXPECT_EQ(score.found, 3);
  EXPECT_EQ(score.false_regions, 0);
  EXPECT_GT(score.f(), 0.85);
}

/// The disparities that brink computes, written to a file of this kind and read back.
cv::Mat1f through_file(const cv::Mat1f& disparity, const std::string& extension) {
  const test::TemporaryFolder folder;
  const std::string path = folder / ("d" + extension);
  if (extension == ".png" || extension == ".pfm") {
    return read_disparity(folder.add("d" + extension, encode_disparity(disparity, disparity_format(path))));
  }
  cv::Mat1f stored = disparity.clone();
  stored.setTo(std::numeric_limits<float>::quiet_NaN(), disparity == kInvalidDisparity);
  cv::imwrite(path, stored);
  return read_disparity(path);
}

/// Without times, and without what only the right picture tells.
void leave_out_what_differs(Detection& detection) {
  detection.times = {};
  for (NegativeObstacle& obstacle : detection.obstacles) {
    obstacle.candidate.measures = {};
    obstacle.probability.reset();
  }
}

TEST(Potholes, AreTheSameFromDisparityFilesOfEachKind) {
  BRINK_REQUIRE_DATA(folder, "pothole_b");
  ::setenv("OPENCV_IO_ENABLE_OPENEXR", "1", 1);
  DetectorParams params;
  params.stills = true;
  params.candidates.min_depth_m = kMinDepth;
  const Sequence sequence = open_sequence(folder);
  for (int i = 0; i < sequence.size(); ++i) {
    const Frame frame = sequence.read(i).frame;
    Detection pair = Detector(params).process(frame);
    ASSERT_FALSE(pair.obstacles.empty());
    leave_out_what_differs(pair);
    for (const std::string extension : {".pfm", ".tiff", ".exr", ".png"}) {
      SCOPED_TRACE(fmt::format("{} {}", i, extension));
      const cv::Mat1f disparity = through_file(pair.disparity, extension);
      Detection given = Detector(params).process(
          make_frame_with_disparity(frame.left_color, disparity, frame.camera, frame.index, frame.time));
      leave_out_what_differs(given);
      if (extension != ".png") {
        EXPECT_EQ(to_json_line(given), to_json_line(pair));
        continue;
      }
      ASSERT_EQ(given.obstacles.size(), pair.obstacles.size());  // rounded to 1/256 px
      for (std::size_t k = 0; k < pair.obstacles.size(); ++k) {
        EXPECT_NEAR(given.obstacles[k].candidate.distance_m, pair.obstacles[k].candidate.distance_m, 0.005);
        EXPECT_NEAR(*given.obstacles[k].candidate.depth_m, *pair.obstacles[k].candidate.depth_m, 0.001);
      }
    }
  }
}

}  // namespace
}  // namespace brink
