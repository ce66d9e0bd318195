// Scores: what is accepted can be written, compared with itself and summed up.
#include "brink/evaluation.hpp"
#include "brink/evaluation_report.hpp"
#include "input_files.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace brink;
  const std::string path = fuzz::put("scores.json", fuzz::text_of(data, size));
  auto scores = fuzz::result_of([&] { return read_scores(path); });
  if (!scores) return 0;
  scores->params.resamplings = 2;  // a thousand take their time and tell nothing more
  const auto text = fuzz::result_of([&] { return to_text(scores->sequences, scores->params); });
  const auto json = fuzz::result_of([&] { return to_json(scores->sequences, scores->params); });
  if (json) (void)fuzz::result_of([&] { return read_scores(fuzz::put("again.json", *json)); });
  (void)fuzz::result_of([&] { return to_text(compare(scores->sequences, scores->sequences, scores->params)); });
  return 0;
}
