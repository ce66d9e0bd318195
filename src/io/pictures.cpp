#include "brink/pictures.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include "brink/disparity.hpp"
#include "brink/files.hpp"
#include "io/number_picture.hpp"
#include "io/picture_header.hpp"

namespace brink {
namespace {

std::string lower_case_extension(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return extension;
}

void check_size(const PictureHeader& header) {
  if (header.width < 1 || header.height < 1) {
    throw std::runtime_error(fmt::format("is damaged: {}x{} px", header.width, header.height));
  }
}

cv::Mat decode_bytes(const PictureHeader& header, int mode) {
  const cv::Mat1b bytes(1, static_cast<int>(header.bytes.size()),
                        const_cast<uchar*>(reinterpret_cast<const uchar*>(header.bytes.data())));  // only read
  cv::Mat picture;
  try {
    picture = cv::imdecode(bytes, mode | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception& error) {
    throw std::runtime_error(fmt::format("of {}x{} px cannot be decoded: {}", header.width, header.height, error.err));
  }
  if (picture.empty()) throw std::runtime_error("is damaged, cannot be decoded");
  return picture;
}

cv::Mat decode(const PictureHeader& header) {
  constexpr int kBits = 8;
  check_size(header);
  if (header.bits > kBits) {
    throw std::runtime_error(fmt::format(
        "is a {}-bit picture, expected 8-bit: disparities and depths must be told to be such (--as disparity|depth)",
        header.bits));
  }
  if (header.channels != 1 && header.channels != 3) {
    throw std::runtime_error(
        fmt::format("has {} channels, expected 1 (grey) or 3 (colour), without transparency", header.channels));
  }
  return decode_bytes(header, header.channels == 1 ? cv::IMREAD_GRAYSCALE : cv::IMREAD_COLOR);
}

/// Numbers of a picture as float: those of 16 bit times a scale, of float as they are; none = what is 0 in 16 bit, and what is
/// negative or not finite.
cv::Mat1f read_numbers(const std::string& path, double scale, float none) {
  const std::string bytes = read_file(path);
  cv::Mat stored;
  try {
    stored = decode_number_picture(bytes);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(fmt::format("{}: {}", path, error.what()));
  }
  cv::Mat1f numbers;
  if (stored.depth() == CV_16U) {
    stored.convertTo(numbers, CV_32F, scale);
    numbers.setTo(none, stored == 0);
    return numbers;
  }
  numbers = stored;
  for (float& number : numbers) {
    if (!std::isfinite(number) || number < 0.0F) number = none;
  }
  return numbers;
}

// Not by cv::imencode: that writes PFM to a temporary file, and returns what fitted when the disk is full.
std::string encode_pfm(const cv::Mat1f& disparity) {
  cv::Mat1f stored = disparity.clone();
  stored.setTo(std::numeric_limits<float>::infinity(), disparity < 0.0F);
  const char* byte_order = std::endian::native == std::endian::little ? "-1" : "1";
  std::string bytes = fmt::format("Pf\n{} {}\n{}\n", stored.cols, stored.rows, byte_order);
  for (int v = stored.rows - 1; v >= 0; --v) {  // from the bottom up
    bytes.append(stored.ptr<char>(v), static_cast<std::size_t>(stored.cols) * sizeof(float));
  }
  return bytes;
}

}  // namespace

bool is_picture_name(const std::string& path) {
  const std::string extension = lower_case_extension(path);
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg";
}

bool is_depth_name(const std::string& path) {
  constexpr std::array<std::string_view, 5> kExtensions = {".png", ".tif", ".tiff", ".pfm", ".exr"};
  return std::ranges::find(kExtensions, lower_case_extension(path)) != kExtensions.end();
}

cv::Mat read_picture(const std::string& path) {
  const std::string bytes = read_file(path);
  try {
    if (is_float_picture(bytes)) {
      throw std::runtime_error(
          "is a TIFF, PFM or OpenEXR picture, expected PNG or JPEG: disparities and depths must be told to be such (--as "
          "disparity|depth)");
    }
    return decode(examine_picture(bytes));
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(fmt::format("{}: {}", path, error.what()));
  }
}

cv::Mat1b read_mask(const std::string& path) {
  cv::Mat mask = read_picture(path);
  if (mask.channels() == 1) return mask;
  throw std::runtime_error(path + ": is a colour picture, expected grey: a number for each pixel");
}

std::string encode_png(const cv::Mat& picture) {
  std::vector<uchar> bytes;
  if (!cv::imencode(".png", picture, bytes)) throw std::runtime_error("picture cannot be stored as PNG");
  return {bytes.begin(), bytes.end()};
}

DisparityFormat disparity_format(const std::string& path) {
  const std::string extension = lower_case_extension(path);
  if (extension == ".png") return DisparityFormat::png;
  if (extension == ".pfm") return DisparityFormat::pfm;
  throw std::invalid_argument(fmt::format("{}: extension \"{}\", expected .png or .pfm", path, extension));
}

std::string encode_disparity(const cv::Mat1f& disparity, DisparityFormat format) {
  if (disparity.empty()) throw std::runtime_error("disparity image is empty");
  if (format == DisparityFormat::pfm) return encode_pfm(disparity);
  constexpr float kScale = 256.0F;
  constexpr float kLargest = std::numeric_limits<std::uint16_t>::max();
  cv::Mat1w stored(disparity.size());
  for (int v = 0; v < disparity.rows; ++v) {
    for (int u = 0; u < disparity.cols; ++u) {
      const float value = disparity(v, u);
      const float scaled = std::round(value * kScale);
      if (scaled > kLargest) {
        throw std::runtime_error(
            fmt::format("disparity at ({}, {}) = {} px, a PNG holds at most 255.99: use .pfm", u, v, value));
      }
      stored(v, u) = value < 0.0F ? std::uint16_t{0} : static_cast<std::uint16_t>(std::max(scaled, 1.0F));
    }
  }
  return encode_png(stored);
}

cv::Mat1f read_disparity(const std::string& path) {
  constexpr double kScale = 1.0 / 256.0;
  return read_numbers(path, kScale, kInvalidDisparity);
}

cv::Mat1f read_depth(const std::string& path) {
  constexpr double kScale = 0.001;  // millimetres
  return read_numbers(path, kScale, 0.0F);
}

}  // namespace brink
