// Pictures, disparity and depth images through brink's own checks and OpenCV's decoders: a whole one of the kind that was asked
// for, or a refusal.
#include "brink/pictures.hpp"

#include <cmath>
#include <cstdlib>

#include "brink/disparity.hpp"
#include "input_files.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace brink;
  static const int with_exr = setenv("OPENCV_IO_ENABLE_OPENEXR", "1", 1);
  fuzz::require(with_exr == 0, "no environment");
  const std::string_view bytes = fuzz::text_of(data, size);
  const std::string path = fuzz::put("picture.png", bytes);
  const auto picture = fuzz::result_of([&] { return read_picture(path); });
  if (picture) {
    fuzz::require(!picture->empty() && (picture->type() == CV_8UC1 || picture->type() == CV_8UC3), "picture of another type");
  }
  (void)fuzz::result_of([&] { return read_mask(path); });
  if (const auto disparity = fuzz::result_of([&] { return read_disparity(path); })) {
    for (const float value : *disparity) {
      fuzz::require(value >= 0.0F || value == kInvalidDisparity, "disparity that is neither one nor none");
    }
  }
  if (const auto depth = fuzz::result_of([&] { return read_depth(path); })) {
    for (const float value : *depth) fuzz::require(value >= 0.0F && std::isfinite(value), "depth that is neither one nor none");
  }
  return 0;
}
