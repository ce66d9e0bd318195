#pragma once

#include <array>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "brink/camera.hpp"
#include "brink/detector.hpp"
#include "brink/evaluation.hpp"
#include "brink/trajectory.hpp"
#include "brink/truth.hpp"

namespace brink {

/// A row of the paper's table II, as printed.
struct PaperRow {
  const char* name;
  int frames;
  Counts counts;  ///< fn = instances - tp
};
/// The paper's three recordings. Their own arithmetic gives table III, but for the row of S1 (docs/evaluation.md).
inline constexpr std::array<PaperRow, 3> kPaperRows{{{"paper S1, stairs", 213, {230, 23, 56}},
                                                     {"paper S2, platform", 300, {160, 10, 20}},
                                                     {"paper S3, manholes", 277, {446, 55, 39}}}};

// Tables for people, in Markdown. Rates are shares, their 95 % intervals stand in brackets; "-" = nothing to count.

/// Tables II and III for each sequence and pooled, beside the paper's; then recall by range and by depth beside the envelope,
/// a row for each domain where there are several, events, the last metres, false alarms, localisation, ground and calibration,
/// pooled.
/// @throws std::invalid_argument as summarise does.
std::string to_text(const std::vector<SequenceScore>& sequences, const EvaluationParams& params = {});
std::string to_text(const std::vector<Comparison>& comparisons);
std::string to_text(const TrajectoryErrors& errors);
std::string to_text(const DisparityErrors& errors);

// The same for programs, JSON.
std::string to_json(const EvaluationSummary& summary);
std::string to_json(const std::vector<DomainSummary>& domains);  ///< an object: the summary of each domain by its name
std::string to_json(const std::vector<Comparison>& comparisons);
std::string to_json(const TrajectoryErrors& errors);
std::string to_json(const DisparityErrors& errors);

/// Collects detections as a COCO data set: one image a frame, one annotation an obstacle (segmentation: its contour; bbox;
/// area; score: its probability, 1 when it tells none), one category "negative_obstacle". Remembered obstacles without a
/// contour are left out.
class CocoWriter {
 public:
  CocoWriter();
  ~CocoWriter();
  CocoWriter(const CocoWriter&) = delete;
  CocoWriter& operator=(const CocoWriter&) = delete;
  /// @param file_name of the frame's left picture, as it is to stand in the file. @param size of that picture, px.
  void add(const std::string& file_name, const cv::Size& size, const Detection& detection);
  [[nodiscard]] std::string text() const;

 private:
  struct Document;
  std::unique_ptr<Document> document_;
};

/// Why an instance was missed, as far as the detections tell: "no_picture", "ground not_visible", "rejected: black", "tracked,
/// not reported", "overlap too small", "no region" ...
std::string explain_miss(const FrameTruth& truth, const Detection& detection, int id, const StereoCamera& camera);

/// What a false detection lies on: its type and whether most of its inside stands above the ground, is ground or lies below it.
/// @param disparity the true one, px, kInvalidDisparity = none; empty = nothing is known, and the type alone is told.
/// @param ground the estimated plane, which "above" and "below" refer to.
std::string explain_false_alarm(const cv::Mat1f& disparity, const NegativeObstacle& obstacle, const GroundPlane& ground,
                                const StereoCamera& camera);

/// One frame with its truth and its detections: instances that count yellow, "don't care" grey, hits green, false detections
/// red, tracks that are not reported thin blue.
/// @param title written at the top. @param picture the left one, BGR; empty = black.
cv::Mat3b draw_evaluation(const cv::Mat3b& picture, const FrameTruth& truth, const Detection& detection,
                          const FrameScore& score, const std::string& title);

}  // namespace brink
