#include "evaluation/kind_table.hpp"

#include <array>
#include <optional>

#include <fmt/format.h>

namespace brink {
namespace {

constexpr std::array<ObstacleKind, 4> kKinds = {ObstacleKind::stairs_down, ObstacleKind::edge, ObstacleKind::hole,
                                                ObstacleKind::unknown};

}  // namespace

void summarise_kinds(EvaluationSummary& summary, const std::vector<SequenceScore>& sequences) {
  int all = 0;
  int right = 0;
  for (const SequenceScore& sequence : sequences) {
    for (const FrameScore& frame : sequence.frames) {
      for (const DetectionScore& detection : frame.detections) {
        if (!detection.kind || !detection.true_kind) continue;
        ++summary.kinds[to_string(*detection.true_kind)][to_string(*detection.kind)];
        ++all;
        right += *detection.kind == *detection.true_kind ? 1 : 0;
      }
    }
  }
  if (all > 0) summary.kind_accuracy = static_cast<double>(right) / all;
}

std::string kind_table(const EvaluationSummary& summary) {
  if (!summary.kind_accuracy) return "Kinds: no detection hits an instance whose kind is known\n";
  std::string text =
      "| is, detections that hit | told stairs_down | edge | hole | unknown | share told right |\n|---|---|---|---|---|---|\n";
  for (const auto& [kind, told] : summary.kinds) {
    int all = 0;
    text += "| " + kind;
    for (const ObstacleKind one : kKinds) {
      const auto found = told.find(to_string(one));
      const int count = found == told.end() ? 0 : found->second;
      all += count;
      text += fmt::format(" | {}", count);
    }
    const auto right = told.find(kind);
    text += fmt::format(" | {:.3f} |\n", right == told.end() ? 0.0 : static_cast<double>(right->second) / all);
  }
  return text + fmt::format("Kinds told right: {:.3f}\n", *summary.kind_accuracy);
}

}  // namespace brink
