#pragma once

#include <cstdint>
#include <string>

#include <opencv2/core.hpp>

namespace brink {

/// Whether the extension is that of a PNG or JPEG picture, in capital letters or not.
bool is_picture_name(const std::string& path);

/// Reads a PNG or JPEG picture: 8 bit, grey (1 channel) or colour (3 channels, BGR). The pixels are those of the file: an
/// orientation noted in it is not applied, because calibrations know nothing of it.
/// @throws std::runtime_error "path: what it is, expected ..." when it is missing, empty, something else, truncated, damaged,
/// has
///         16 bits, or has transparency (4 channels).
cv::Mat read_picture(const std::string& path);

/// A picture of numbers, one for each pixel: 8 bit, 1 channel.
/// @throws std::runtime_error as read_picture does, and for more channels.
cv::Mat1b read_mask(const std::string& path);

/// The bytes of a PNG file.
std::string encode_png(const cv::Mat& picture);

/// How a disparity image is stored.
enum class DisparityFormat : std::uint8_t {
  png,  ///< uint16, disparity * 256 rounded, 0 = none (the KITTI stereo convention); a disparity of 0 px is stored as 1
  pfm,  ///< float32, none = infinity (the Middlebury convention)
};

/// Tells the format by the extension. @throws std::invalid_argument "path: ..., expected .png or .pfm".
DisparityFormat disparity_format(const std::string& path);

/// The bytes of a disparity file. @param disparity px, kInvalidDisparity = none.
/// @throws std::runtime_error when it is empty, or when a disparity does not fit a PNG (more than 255.99 px).
std::string encode_disparity(const cv::Mat1f& disparity, DisparityFormat format);

/// Reads what encode_disparity made, or others in these formats: the extension tells which.
/// @return px, kInvalidDisparity = none: 0 in a PNG; what is negative or not finite in a PFM.
/// @throws std::runtime_error "path: what it is, expected ..." when it is missing, truncated, damaged or something else.
/// @throws std::invalid_argument as disparity_format does.
cv::Mat1f read_disparity(const std::string& path);

}  // namespace brink
