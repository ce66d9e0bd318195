// Pictures through brink's own checks and OpenCV's decoders: a whole one of the kind that was asked for, or a refusal.
#include "brink/pictures.hpp"

#include "brink/disparity.hpp"
#include "input_files.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace brink;
  const std::string_view bytes = fuzz::text_of(data, size);
  const std::string path = fuzz::put("picture.png", bytes);
  const auto picture = fuzz::result_of([&] { return read_picture(path); });
  if (picture) {
    fuzz::require(!picture->empty() && (picture->type() == CV_8UC1 || picture->type() == CV_8UC3), "picture of another type");
  }
  (void)fuzz::result_of([&] { return read_mask(path); });
  for (const std::string& name : {path, fuzz::put("picture.pfm", bytes)}) {
    const auto disparity = fuzz::result_of([&] { return read_disparity(name); });
    if (!disparity) continue;
    for (const float value : *disparity) {
      fuzz::require(value >= 0.0F || value == kInvalidDisparity, "disparity that is neither one nor none");
    }
  }
  return 0;
}
