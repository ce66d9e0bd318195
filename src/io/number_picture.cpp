#include "io/number_picture.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include "io/picture_header.hpp"

namespace brink {
namespace {

constexpr std::string_view kPng("\x89PNG");
constexpr std::string_view kExr("\x76\x2f\x31\x01");
constexpr std::string_view kLittleTiff("II*\0", 4);
constexpr std::string_view kBigTiff("MM\0*", 4);

/// "Pf", columns, rows, scale (negative = little endian), then floats from the bottom row up.
cv::Mat1f decode_pfm(const std::string& bytes) {
  std::istringstream header(bytes);
  std::string kind;
  int columns = 0;
  int rows = 0;
  double scale = 0.0;
  if (!(header >> kind >> columns >> rows >> scale) || kind != "Pf" || columns < 1 || rows < 1 || scale == 0.0) {
    throw std::runtime_error("is no grey PFM picture, expected Pf, columns, rows, scale");
  }
  const bool ended = header.get() == std::istringstream::traits_type::eof();  // one white space ends the header
  const std::size_t start = ended ? bytes.size() : static_cast<std::size_t>(header.tellg());
  const std::size_t row_bytes = static_cast<std::size_t>(columns) * sizeof(float);
  if ((bytes.size() - start) / row_bytes < static_cast<std::size_t>(rows)) {
    throw std::runtime_error(fmt::format("is a truncated PFM picture of {}x{} px, expected a whole one", columns, rows));
  }
  cv::Mat1f numbers(rows, columns);
  const bool swapped = (scale < 0.0) != (std::endian::native == std::endian::little);
  for (int v = 0; v < rows; ++v) {
    const char* from = bytes.data() + start + static_cast<std::size_t>(rows - 1 - v) * row_bytes;
    for (int u = 0; u < columns; ++u, from += sizeof(float)) {
      std::array<char, sizeof(float)> number{};
      std::copy_n(from, number.size(), number.begin());
      if (swapped) std::ranges::reverse(number);
      numbers(v, u) = std::bit_cast<float>(number);
    }
  }
  return numbers;
}

/// A little-endian number of OpenEXR.
std::uint64_t exr_number(std::string_view bytes, std::size_t position, std::size_t count) {
  if (position > bytes.size() || count > bytes.size() - position) {
    throw std::runtime_error("is a truncated OpenEXR picture, expected a whole one");
  }
  std::uint64_t number = 0;
  for (std::size_t i = count; i-- > 0;) number = number << 8U | static_cast<unsigned char>(bytes[position + i]);
  return number;
}

std::size_t after_exr_text(std::string_view bytes, std::size_t position) {
  while (exr_number(bytes, position, 1) != 0) ++position;
  return position + 1;
}

/// Refuses a file that ends too early, of which OpenCV would talk itself. OpenEXR: magic number, version and flags, attributes
/// (name, type, length, value) up to an empty name, a table of where the blocks of lines begin, the blocks (line, length,
/// data).
void check_exr(std::string_view bytes) {
  constexpr std::uint64_t kOtherLayouts = 0x1A00;  // tiles, deep data, several parts
  constexpr std::size_t kBlockHeader = 8;
  if (std::getenv("OPENCV_IO_ENABLE_OPENEXR") == nullptr) {
    throw std::runtime_error(
        "is an OpenEXR picture, which OpenCV reads with OPENCV_IO_ENABLE_OPENEXR=1 in the environment only");
  }
  if ((exr_number(bytes, 4, 4) & kOtherLayouts) != 0) {
    throw std::runtime_error("is an OpenEXR picture in tiles or of several parts, expected one of lines");
  }
  std::size_t at = 8;
  while (exr_number(bytes, at, 1) != 0) {
    at = after_exr_text(bytes, after_exr_text(bytes, at));
    at += 4 + exr_number(bytes, at, 4);
  }
  // The table ends where the first block begins.
  std::uint64_t first_block = std::numeric_limits<std::uint64_t>::max();
  for (++at; at < first_block; at += sizeof(std::uint64_t)) {
    const std::uint64_t block = exr_number(bytes, at, sizeof(std::uint64_t));
    first_block = std::min(first_block, block);
    const std::uint64_t length = exr_number(bytes, std::min<std::uint64_t>(block, bytes.size()) + 4, 4);
    (void)exr_number(bytes, block + kBlockHeader, length);
  }
}

cv::Mat decode_by_opencv(const std::string& bytes) {
  const cv::Mat1b raw(1, static_cast<int>(bytes.size()),
                      const_cast<uchar*>(reinterpret_cast<const uchar*>(bytes.data())));  // only read
  cv::Mat picture;
  try {
    picture = cv::imdecode(raw, cv::IMREAD_UNCHANGED | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception& error) {
    throw std::runtime_error(fmt::format("cannot be decoded: {}", error.err));
  }
  if (picture.empty()) throw std::runtime_error("is damaged or truncated, cannot be decoded");
  return picture;
}

cv::Mat single_channel(const cv::Mat& picture) {
  if (picture.channels() == 1) return picture;
  std::vector<cv::Mat> channels;
  cv::split(picture, channels);
  // Bit by bit: NaN is not equal to itself.
  const auto equal = [&](const cv::Mat& other) {
    for (int v = 0; v < picture.rows; ++v) {
      if (!std::equal(other.ptr(v), other.ptr(v) + other.elemSize() * static_cast<std::size_t>(other.cols), channels[0].ptr(v)))
        return false;
    }
    return true;
  };
  if (picture.channels() == 3 && equal(channels[1]) && equal(channels[2])) return channels[0];
  throw std::runtime_error(fmt::format("has {} different channels, expected one number for each pixel", picture.channels()));
}

}  // namespace

bool is_float_picture(std::string_view bytes) {
  return bytes.starts_with(kLittleTiff) || bytes.starts_with(kBigTiff) || bytes.starts_with(kExr) ||
         bytes.starts_with("Pf\n") || bytes.starts_with("PF\n");
}

cv::Mat decode_number_picture(const std::string& bytes) {
  constexpr int kBits = 16;
  if (bytes.empty()) throw std::runtime_error("is empty, expected a PNG, TIFF, PFM or OpenEXR picture");
  if (bytes.starts_with("P")) return decode_pfm(bytes);
  cv::Mat picture;
  if (bytes.starts_with(kPng)) {
    const PictureHeader header = examine_picture(bytes);
    if (header.width < 1 || header.height < 1) throw std::runtime_error("is damaged: has no pixels");
    if (header.bits != kBits || header.channels != 1) {
      throw std::runtime_error(fmt::format("is a {}-bit picture of {} channels, expected 16-bit grey: a number for each pixel",
                                           header.bits, header.channels));
    }
    picture = decode_by_opencv(header.bytes);
  } else if (bytes.starts_with(kExr)) {
    check_exr(bytes);
    picture = decode_by_opencv(bytes);
  } else if (bytes.starts_with(kLittleTiff) || bytes.starts_with(kBigTiff)) {
    picture = decode_by_opencv(bytes);
  } else {
    throw std::runtime_error("is no PNG, TIFF, PFM or OpenEXR picture");
  }
  if (picture.depth() != CV_16U && picture.depth() != CV_32F) {
    throw std::runtime_error(fmt::format("holds numbers of kind {}, expected 16 bit without sign or 32-bit float",
                                         cv::depthToString(picture.depth())));
  }
  return single_channel(picture);
}

}  // namespace brink
