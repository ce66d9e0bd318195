#pragma once

#include <variant>
#include <vector>

#include "brink/detector.hpp"

namespace brink {

/// Where the value of a parameter lives, and so its type.
using ParameterReference = std::variant<int*, double*, bool*, Matcher*>;

/// One row of the only table of parameters: command line, YAML files and `brink params` are made from it.
struct ParameterEntry {
  const char* key;
  ParameterReference value;
  const char* unit;
  const char* meaning;
};

/// Every parameter of `params`, which must outlive the table.
std::vector<ParameterEntry> parameter_table(DetectorParams& params);

}  // namespace brink
