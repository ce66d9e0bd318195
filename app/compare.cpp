#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "brink/evaluation_report.hpp"
#include "common.hpp"

namespace brink::app {
namespace {

struct CompareOptions {
  std::string a;
  std::string b;
  bool json = false;
};

int compare_scores(const CompareOptions& options) {
  const StoredScores a = read_scores(options.a);
  const StoredScores b = read_scores(options.b);
  std::vector<Comparison> comparisons;
  try {
    comparisons = compare(a.sequences, b.sequences, a.params);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(fmt::format("{} and {}: {}", options.a, options.b, error.what()));
  }
  print(options.json ? to_json(comparisons) : to_text(comparisons));
  const bool worse = std::any_of(comparisons.begin(), comparisons.end(), [](const Comparison& one) { return one.is_worse(); });
  if (worse) say(fmt::format("{} is worse than {} beyond chance", options.b, options.a));
  return worse ? kExitData : kExitOk;
}

}  // namespace

Run add_compare(CLI::App& command) {
  const auto options = std::make_shared<CompareOptions>();
  command.add_option("A", options->a, "Scores of the first run, as brink evaluate --json writes them")->required();
  command.add_option("B", options->b, "Scores of the second run, over the same sequences")->required();
  command.add_flag("--json", options->json, "Print JSON instead of text");
  command.footer(
      "Every difference has its 95 % interval from paired resampling: the same blocks of frames, the same events. Exit code 1\n"
      "when B is worse in any figure, the whole interval lying on the wrong side.\n"
      "Example:\n"
      "  brink compare benchmarks/baseline.json new.json");
  return [options] { return compare_scores(*options); };
}

}  // namespace brink::app
