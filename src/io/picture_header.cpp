#include "io/picture_header.hpp"

#include <cstdint>
#include <stdexcept>
#include <string_view>

#include <boost/crc.hpp>
#include <fmt/format.h>

namespace brink {
namespace {

constexpr std::string_view kPngSignature("\x89PNG\r\n\x1a\n");
constexpr std::string_view kJpegSignature("\xff\xd8\xff");

[[noreturn]] void fail_truncated(const char* kind) {
  throw std::runtime_error(std::string("is a truncated ") + kind + " picture, expected a whole one");
}

// Big-endian number of a few bytes; the caller has made sure that they are there.
std::uint32_t number_at(std::string_view bytes, std::size_t position, std::size_t count) {
  std::uint32_t number = 0;
  for (const char byte : bytes.substr(position, count)) number = number << 8 | static_cast<unsigned char>(byte);
  return number;
}

int png_channels(std::uint32_t color_type, bool transparent) {
  constexpr std::uint32_t kColorBit = 2;
  constexpr std::uint32_t kAlphaBit = 4;
  const bool color = (color_type & kColorBit) != 0;
  return (color ? 3 : 1) + ((color_type & kAlphaBit) != 0 || transparent ? 1 : 0);
}

// PNG: chunks of length (4 bytes), name (4), data, check sum (4), from IHDR to IEND.
PictureHeader examine_png(std::string_view bytes) {
  constexpr std::size_t kFrameSize = 12;
  PictureHeader header;
  header.bytes = kPngSignature;
  std::uint32_t color_type = 0;
  bool transparent = false;
  bool ended = false;
  for (std::size_t at = kPngSignature.size(); !ended;) {
    if (bytes.size() - at < kFrameSize) fail_truncated("PNG");
    const std::size_t length = number_at(bytes, at, 4);
    if (length > bytes.size() - at - kFrameSize) fail_truncated("PNG");
    const std::string_view chunk = bytes.substr(at, length + kFrameSize);
    const std::string_view name = chunk.substr(4, 4);
    boost::crc_32_type sum;
    sum.process_bytes(name.data(), length + name.size());
    if (sum.checksum() != number_at(chunk, length + 8, 4))
      throw std::runtime_error("is a damaged PNG picture: wrong check sum");
    if (name == "IHDR" && at != kPngSignature.size()) {
      throw std::runtime_error("is a damaged PNG picture: its header is not the first part");
    }
    if (name == "IHDR" && length >= 13) {
      header.width = static_cast<int>(number_at(chunk, 8, 4));
      header.height = static_cast<int>(number_at(chunk, 12, 4));
      header.bits = static_cast<int>(number_at(chunk, 16, 1));
      color_type = number_at(chunk, 17, 1);
    }
    transparent = transparent || name == "tRNS";
    ended = name == "IEND";
    const bool needed = name[0] >= 'A' && name[0] <= 'Z';  // lower case = ancillary
    if (needed) header.bytes += chunk;
    at += chunk.size();
  }
  header.channels = png_channels(color_type, transparent);
  return header;
}

bool is_frame_header(std::uint32_t marker) {  // SOF0 to SOF15, without DHT, JPG and DAC among them
  return marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
}

// In the coded data after SOS, 0xFF is followed by 0 or a restart marker; anything else ends it.
std::size_t end_of_scan(std::string_view bytes, std::size_t at) {
  for (; at + 1 < bytes.size(); ++at) {
    const auto next = static_cast<unsigned char>(bytes[at + 1]);
    if (bytes[at] == '\xff' && next != 0 && !(next >= 0xD0 && next <= 0xD7)) return at;
  }
  fail_truncated("JPEG");
}

// JPEG: segments of 0xFF, marker, length (2 bytes, itself included), data, from SOI to EOI.
PictureHeader examine_jpeg(const std::string& bytes) {
  constexpr std::uint32_t kEnd = 0xD9;
  constexpr std::uint32_t kScan = 0xDA;
  PictureHeader header;
  header.bytes = bytes;
  for (std::size_t at = 2;;) {
    if (at + 2 > bytes.size()) fail_truncated("JPEG");
    if (bytes[at] != '\xff') throw std::runtime_error("is a damaged JPEG picture: no marker where one must be");
    const std::uint32_t marker = number_at(bytes, at + 1, 1);
    if (marker == kEnd) return header;
    if (marker == 0xFF) {  // fill byte
      ++at;
      continue;
    }
    if (at + 4 > bytes.size()) fail_truncated("JPEG");
    const std::size_t length = number_at(bytes, at + 2, 2);
    if (length < 2 || at + 2 + length > bytes.size()) fail_truncated("JPEG");
    if (is_frame_header(marker) && length >= 8) {
      if (header.channels != 0) throw std::runtime_error("is a damaged JPEG picture: two headers");
      header.bits = static_cast<int>(number_at(bytes, at + 4, 1));
      header.height = static_cast<int>(number_at(bytes, at + 5, 2));
      header.width = static_cast<int>(number_at(bytes, at + 7, 2));
      header.channels = static_cast<int>(number_at(bytes, at + 9, 1));
    }
    at += 2 + length;
    if (marker == kScan) at = end_of_scan(bytes, at);
  }
}

}  // namespace

PictureHeader examine_picture(const std::string& bytes) {
  if (bytes.empty()) throw std::runtime_error("is empty, expected a PNG or JPEG picture");
  PictureHeader header;
  if (bytes.starts_with(kPngSignature)) {
    header = examine_png(bytes);
  } else if (bytes.starts_with(kJpegSignature)) {
    header = examine_jpeg(bytes);
  } else {
    throw std::runtime_error("is not a PNG or JPEG picture");
  }
  if (std::int64_t{header.width} * header.height > kMostPixels) {
    throw std::runtime_error(fmt::format("is a picture of {}x{} px, expected at most {} megapixels", header.width,
                                         header.height, kMostPixels / 1'000'000));
  }
  return header;
}

}  // namespace brink
