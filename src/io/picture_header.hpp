#pragma once

#include <cstdint>
#include <string>

namespace brink {

/// Larger pictures are refused before they are decoded: a file of some kilobytes can hold gigabytes of black.
inline constexpr std::int64_t kMostPixels = 64'000'000;

/// What the header of a PNG or JPEG file tells, after the file was found to be whole from its first byte to its last.
struct PictureHeader {
  int width = 0;
  int height = 0;
  int bits = 0;      ///< per channel
  int channels = 0;  ///< as decoded: palettes count as colour, transparency as one more
  /// The file, without the notes in a PNG that a decoder would warn of.
  std::string bytes;
};

/// Looks at a picture file without decoding it, so that decoders meet no truncated one.
/// @throws std::runtime_error with the fault, without the file's name: also for more than kMostPixels.
PictureHeader examine_picture(const std::string& bytes);

}  // namespace brink
