#pragma once

#include <string>
#include <utility>
#include <vector>

#include "brink/detector.hpp"

namespace brink {

/// A parameter as people meet it: on the command line, in files and in the documentation.
struct Parameter {
  std::string key;      ///< "elas.max_disparity": group and name
  std::string value;    ///< as it is written in a file
  std::string unit;     ///< "px", "m", ...; empty when it has none
  std::string meaning;  ///< one line
};

/// A key and the text of its value.
using Setting = std::pair<std::string, std::string>;

/// Every parameter there is, with its value in `params`, group by group.
std::vector<Parameter> list_parameters(const DetectorParams& params = {});

/// Changes parameters by name. The key `elas.preset` (robotics, middlebury or paper) is not a parameter: it sets the whole
/// group `elas` and is applied before all other settings, wherever it stands. Of a key given twice the last one counts.
/// @throws std::invalid_argument "key = value, must be ..." for a text of the wrong type, and for an unknown key, with the most
///         similar known one. Limits are not checked here: DetectorParams::validate does that.
DetectorParams with_settings(const DetectorParams& params, const std::vector<Setting>& settings);

/// "key=value" as written after --set. @throws std::invalid_argument when there is no key or no "=".
Setting parse_setting(const std::string& text);

/// Applies a YAML file of groups and names, `elas: {max_disparity: 128}`, to `params`.
/// @throws std::runtime_error "file: ..." when it is missing or not such a file, holds an unknown key or a wrong value, or
/// leaves
///         parameters that are not valid.
DetectorParams read_parameters(const std::string& path, const DetectorParams& params = {});

/// All parameters as a YAML file that read_parameters reads, with units and meanings as comments.
std::string to_yaml(const DetectorParams& params);

}  // namespace brink
