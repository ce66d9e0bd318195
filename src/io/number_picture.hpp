#pragma once

#include <string>
#include <string_view>

#include <opencv2/core.hpp>

namespace brink {

/// Whether these are the bytes of a TIFF, PFM or OpenEXR file.
bool is_float_picture(std::string_view bytes);

/// A picture that holds a number for each pixel: PNG or TIFF of 16 bit, TIFF, PFM or OpenEXR of 32-bit float. The file is
/// recognised by what it holds. Of three equal channels the first is taken.
/// @return CV_16UC1 or CV_32FC1, the top row first.
/// @throws std::runtime_error with the fault, without the file's name.
cv::Mat decode_number_picture(const std::string& bytes);

}  // namespace brink
