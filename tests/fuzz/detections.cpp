// Detections, JSON Lines: what can be read can be written, and is read again as the same.
#include "brink/detections.hpp"

#include "input_files.hpp"

namespace {

std::string written(const std::vector<brink::Detection>& detections) {
  std::string text;
  for (const brink::Detection& detection : detections) text += to_json_line(detection);
  return text;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace brink;
  const std::string path = fuzz::put("detections.jsonl", fuzz::text_of(data, size));
  const auto detections = fuzz::result_of([&] { return read_detections(path); });
  if (!detections) return 0;
  const std::string once = written(*detections);
  const std::string twice = written(read_detections(fuzz::put("again.jsonl", once)));
  fuzz::require(once == twice, "detections change when they are read again");
  return 0;
}
