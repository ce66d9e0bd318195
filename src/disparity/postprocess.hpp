#pragma once

#include <opencv2/core.hpp>

namespace brink {

// Each changes a disparity image (px, kInvalidDisparity = none) in place or returns a new one (algorithms.md A.7).

/// Removes small segments: 4-connected valid pixels, neighbours at most similarity_px apart, fewer than min_size_px pixels.
void remove_speckles(cv::Mat1f& disparity, float similarity_px, int min_size_px);

/// Fills runs of at most max_width_px invalid pixels between two valid ones, first along rows, then along columns. Both ends
/// lie on one surface if they differ by less than 3 px: then linearly. Otherwise the run is filled with the smaller one, the
/// background, if across_steps, and left alone if not.
void fill_gaps(cv::Mat1f& disparity, int max_width_px, bool across_steps);

/// Repeats the first and last valid disparity of each row, then of each column, up to max_width_px outwards.
void extend_to_borders(cv::Mat1f& disparity, int max_width_px);

/// Mean of the 7 valid pixels around each valid one that are nearly alike, first along rows, then along columns: weight
/// max(0, 4 - |difference|). Steps of 4 px or more stay sharp; the window is centred, so that slopes are not shifted.
cv::Mat1f filter_adaptive_mean(const cv::Mat1f& disparity);

/// Median of the up to 7 valid pixels around each valid one, first along rows, then along columns; of an even number the lower.
void filter_median(cv::Mat1f& disparity);

}  // namespace brink
