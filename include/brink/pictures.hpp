#pragma once

#include <cstdint>
#include <string>

#include <opencv2/core.hpp>

namespace brink {

/// Whether the extension is that of a PNG or JPEG picture, in capital letters or not.
bool is_picture_name(const std::string& path);

/// Likewise of a picture that may hold disparities or depths: PNG, TIFF, PFM or OpenEXR.
bool is_depth_name(const std::string& path);

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

/// Reads a disparity image: PNG or TIFF of 16 bit (disparity times 256, 0 = none), or TIFF, PFM or OpenEXR of 32-bit float (px;
/// negative or not finite = none). The kind of file is told by what it holds; of three equal channels the first is taken.
/// OpenCV reads OpenEXR only where the environment has OPENCV_IO_ENABLE_OPENEXR=1.
/// @return px, kInvalidDisparity = none.
/// @throws std::runtime_error "path: what it is, expected ..." when it is missing, truncated, damaged or something else.
cv::Mat1f read_disparity(const std::string& path);

/// Reads a depth image, in the same kinds of files: of 16 bit millimetres, of float metres, along the optical axis.
/// @return m, 0 = none. @throws std::runtime_error as read_disparity does.
cv::Mat1f read_depth(const std::string& path);

}  // namespace brink
