#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "brink/evaluation_report.hpp"
#include "overlay/writing.hpp"

namespace brink {
namespace {

const cv::Scalar kTruth(0, 255, 255);
const cv::Scalar kDontCare(170, 170, 170);
const cv::Scalar kHit(0, 220, 0);
const cv::Scalar kFalse(40, 40, 255);
const cv::Scalar kTrack(255, 160, 60);

using Contours = std::vector<std::vector<cv::Point>>;

void outline_mask(cv::Mat3b& picture, const cv::Mat1b& mask, const cv::Scalar& color, int line) {
  Contours contours;
  cv::findContours(mask, contours, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
  cv::drawContours(picture, contours, -1, color, line);
}

cv::Mat1b mask_of(const FrameTruth& truth, int id) {
  cv::Mat1b mask;
  cv::compare(truth.negative, id, mask, cv::CMP_EQ);
  return mask;
}

void draw_truth(cv::Mat3b& picture, const FrameTruth& truth, const FrameScore& score) {
  const Pen pen(picture);
  outline_mask(picture, mask_of(truth, kNotLabelled), kDontCare, 1);
  for (const InstanceScore& instance : score.instances) {
    const cv::Mat1b mask = mask_of(truth, instance.id);
    const cv::Scalar& color = instance.settled ? kTruth : kDontCare;
    outline_mask(picture, mask, color, 2 * pen.line);
    const cv::Rect box = cv::boundingRect(mask);
    const std::string distance = instance.distance_m ? fmt::format(", {:.2f} m", *instance.distance_m) : "";
    write(picture, fmt::format("truth {}{}", instance.id, distance), {box.x, box.br().y}, 0.8 * pen.text, pen.line, color);
  }
}

void draw_obstacle(cv::Mat3b& picture, const NegativeObstacle& obstacle, const cv::Scalar& color, int line, bool named) {
  const std::vector<cv::Point>& contour = obstacle.candidate.contour;
  if (contour.empty()) return;
  cv::polylines(picture, Contours{contour}, true, color, line, cv::LINE_AA);
  if (!named) return;
  const Pen pen(picture);
  const cv::Rect box = cv::boundingRect(contour);
  const char* type = obstacle.candidate.type == CandidateType::below_ground ? "1" : "2";
  write(picture, fmt::format("{} type {}, {:.2f} m", obstacle.id, type, obstacle.candidate.distance_m),
        box.tl() - cv::Point(0, 12 * pen.line), 0.8 * pen.text, pen.line, color);
}

bool is_false(const FrameScore& score, int id) {
  return std::any_of(score.detections.begin(), score.detections.end(),
                     [id](const DetectionScore& one) { return one.id == id && one.settled_false; });
}

}  // namespace

cv::Mat3b draw_evaluation(const cv::Mat3b& left, const FrameTruth& truth, const Detection& detection, const FrameScore& score,
                          const std::string& title) {
  cv::Mat3b picture = left.empty() ? cv::Mat3b(truth.negative.size(), cv::Vec3b(0, 0, 0)) : left.clone();
  const Pen pen(picture);
  draw_truth(picture, truth, score);
  for (const NegativeObstacle& track : detection.tracks) draw_obstacle(picture, track, kTrack, pen.line, false);
  for (const NegativeObstacle& obstacle : detection.obstacles) {
    draw_obstacle(picture, obstacle, is_false(score, obstacle.id) ? kFalse : kHit, pen.line, true);
  }
  write(picture, title, {0, 0}, 0.8 * pen.text, pen.line, {255, 255, 255});
  std::string ground = "ground " + to_string(detection.ground.state);
  if (detection.status != FrameStatus::ok) ground = to_string(detection.status);
  write(picture, ground, {0, picture.rows}, 0.8 * pen.text, pen.line, {255, 255, 255});
  return picture;
}

}  // namespace brink
