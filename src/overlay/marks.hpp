#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "brink/detector.hpp"

// Colours and labels that all overlays have in common.
namespace brink {

inline const cv::Scalar kGreen(0, 200, 0);
inline const cv::Scalar kRed(0, 0, 255);
inline const cv::Scalar kBlue(255, 150, 40);  // light enough for dark pictures
inline const cv::Scalar kYellow(0, 220, 255);
inline const cv::Scalar kCyan(255, 255, 0);
inline const cv::Scalar kMagenta(255, 0, 255);
inline const cv::Scalar kGrey(160, 160, 160);
inline const cv::Scalar kLightGrey(225, 225, 225);
inline const cv::Scalar kWhite(255, 255, 255);
inline const cv::Scalar kBlack(0, 0, 0);
// Surfaces of the top view.
inline const cv::Vec3b kNothingSeen(28, 28, 28);
inline const cv::Vec3b kGroundSeen(40, 95, 40);
inline const cv::Vec3b kBelowSeen(35, 35, 120);

/// "2.3 m", with "#3 age 9" when it was followed over frames.
std::string label_of(const NegativeObstacle& obstacle);

/// Keeps labels apart.
class Labels {
 public:
  /// The top left corner of a label, moved down until it covers none of those before it.
  cv::Point place(cv::Point corner, const cv::Size& size);

 private:
  std::vector<cv::Rect> taken_;
};

/// "ground seen 1.64 m, 24.9 deg", with the reason when it is not; for a failed frame its status and reason.
std::string describe_ground(const Detection& detection);

/// A line of text that is made smaller where it would not fit between the corner and the right border.
void write_fitting(cv::Mat3b& picture, const std::string& text, cv::Point corner, double scale, int line,
                   const cv::Scalar& color);

/// A strip of colours at the right with the values at both ends, unless the picture is too small for it.
/// @param colors one column, the lowest value first.
void draw_color_scale(cv::Mat3b& picture, const cv::Mat3b& colors, const std::string& lowest, const std::string& highest);

}  // namespace brink
