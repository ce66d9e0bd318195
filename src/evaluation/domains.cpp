#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "brink/evaluation.hpp"

namespace brink {
namespace {

std::string domain_of(const std::string& name) {
  const std::size_t underscore = name.rfind('_');
  return underscore == std::string::npos || underscore == 0 ? name : name.substr(0, underscore);
}

}  // namespace

std::vector<DomainSummary> summarise_by_domain(const std::vector<SequenceScore>& sequences, const EvaluationParams& params) {
  std::vector<std::pair<std::string, std::vector<SequenceScore>>> domains;
  for (const SequenceScore& sequence : sequences) {
    const std::string name = domain_of(sequence.name);
    const auto is_same = [&name](const auto& domain) { return domain.first == name; };
    auto domain = std::ranges::find_if(domains, is_same);
    if (domain == domains.end()) domain = domains.insert(domains.end(), {name, {}});
    domain->second.push_back(sequence);
  }
  std::vector<DomainSummary> summaries;
  summaries.reserve(domains.size());
  for (const auto& [name, scores] : domains) summaries.push_back({name, summarise(scores, params)});
  return summaries;
}

}  // namespace brink
