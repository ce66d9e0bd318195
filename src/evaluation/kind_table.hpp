#pragma once

#include <string>
#include <vector>

#include "brink/evaluation.hpp"

namespace brink {

/// Fills in EvaluationSummary::kinds and kind_accuracy, from the detections whose true kind is known.
void summarise_kinds(EvaluationSummary& summary, const std::vector<SequenceScore>& sequences);

/// Markdown: a row for each true kind, a column for each that was told.
std::string kind_table(const EvaluationSummary& summary);

}  // namespace brink
