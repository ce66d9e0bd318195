#include "brink/parameters.hpp"

#include <algorithm>
#include <numeric>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "brink/files.hpp"
#include "io/parameter_table.hpp"
#include "io/text.hpp"

namespace brink {
namespace {

constexpr const char* kPresetKey = "elas.preset";

[[noreturn]] void fail(const std::string& key, const std::string& value, const std::string& expected) {
  throw std::invalid_argument(fmt::format("{} = {}, must be {}", key, value, expected));
}

std::string write_value(const ParameterReference& reference) {
  struct Writer {
    std::string operator()(const int* value) const { return std::to_string(*value); }
    std::string operator()(const double* value) const { return fmt::format("{}", *value); }
    std::string operator()(const bool* value) const { return *value ? "true" : "false"; }
    std::string operator()(const Matcher* value) const { return to_string(*value); }
  };
  return std::visit(Writer{}, reference);
}

// Reads the text as the type of the parameter and stores it there.
struct ValueReader {
  const std::string& key;
  const std::string& text;

  void operator()(int* value) const {
    const std::optional<int> number = parse_number<int>(text);
    if (!number) fail(key, text, "a whole number");
    *value = *number;
  }
  void operator()(double* value) const {
    const std::optional<double> number = parse_number(text);
    if (!number) fail(key, text, "a number");
    *value = *number;
  }
  void operator()(bool* value) const {
    if (text != "true" && text != "false") fail(key, text, "true or false");
    *value = text == "true";
  }
  void operator()(Matcher* value) const { *value = matcher_from_string(text); }
};

ElasParams elas_preset(const std::string& name) {
  if (name == "robotics") return ElasParams::robotics();
  if (name == "middlebury") return ElasParams::middlebury();
  if (name == "paper") return ElasParams::paper();
  fail(kPresetKey, name, "robotics, middlebury or paper");
}

// Number of letters to change, add or remove (Levenshtein) to get from one text to the other.
std::size_t edit_distance(const std::string& from, const std::string& to) {
  std::vector<std::size_t> row(to.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (const char letter : from) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < to.size(); ++j) {
      const std::size_t changed = diagonal + (letter == to[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({changed, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

// A name without its group counts as right when it is.
std::string most_similar_key(const std::string& key, const std::vector<ParameterEntry>& table) {
  const auto distance = [&key](const ParameterEntry& entry) {
    const std::string known = entry.key;
    const std::string name = known.substr(known.find('.') + 1);
    return std::min(edit_distance(key, known), edit_distance(key, name));
  };
  const auto nearest = std::min_element(table.begin(), table.end(), [&distance](const auto& first, const auto& second) {
    return distance(first) < distance(second);
  });
  return nearest->key;
}

void apply(const Setting& setting, const std::vector<ParameterEntry>& table) {
  const auto& [key, value] = setting;
  const auto entry = std::find_if(table.begin(), table.end(), [&key = key](const auto& known) { return known.key == key; });
  if (entry == table.end()) {
    throw std::invalid_argument(
        fmt::format("unknown parameter {}: did you mean {}? (brink params lists all)", key, most_similar_key(key, table)));
  }
  std::visit(ValueReader{key, value}, entry->value);
}

void collect_settings(const YAML::Node& node, const std::string& key, std::vector<Setting>& settings) {
  if (node.IsMap()) {
    for (const auto& item : node) {
      const std::string name = item.first.IsScalar() ? item.first.Scalar() : "?";
      collect_settings(item.second, key.empty() ? name : fmt::format("{}.{}", key, name), settings);
    }
  } else if (key.empty()) {
    throw std::invalid_argument("holds no parameters, expected lines like \"elas: {max_disparity: 128}\"");
  } else if (node.IsScalar()) {
    settings.emplace_back(key, node.Scalar());
  } else {
    throw std::invalid_argument(
        fmt::format("line {}: {} has no value, expected a number or a word", node.Mark().line + 1, key));
  }
}

}  // namespace

std::vector<Parameter> list_parameters(const DetectorParams& params) {
  DetectorParams copy = params;
  std::vector<Parameter> parameters;
  for (const ParameterEntry& entry : parameter_table(copy)) {
    parameters.push_back({entry.key, write_value(entry.value), entry.unit, entry.meaning});
  }
  return parameters;
}

DetectorParams with_settings(const DetectorParams& params, const std::vector<Setting>& settings) {
  DetectorParams changed = params;
  const std::vector<ParameterEntry> table = parameter_table(changed);
  for (const Setting& setting : settings) {
    if (setting.first == kPresetKey) changed.disparity.elas = elas_preset(setting.second);
  }
  for (const Setting& setting : settings) {
    if (setting.first != kPresetKey) apply(setting, table);
  }
  return changed;
}

Setting parse_setting(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) fail("--set", text, "key=value, as in candidates.min_depth_m=0.01");
  return {std::string(trimmed(text.substr(0, equals))), std::string(trimmed(text.substr(equals + 1)))};
}

DetectorParams read_parameters(const std::string& path, const DetectorParams& params) {
  const std::string text = read_file(path);
  try {
    const YAML::Node root = YAML::Load(text);
    std::vector<Setting> settings;
    collect_settings(root, "", settings);
    DetectorParams read = with_settings(params, settings);
    read.validate();
    return read;
  } catch (const YAML::Exception& error) {
    throw std::runtime_error(fmt::format("{}: is not YAML: line {}: {}", path, error.mark.line + 1, error.msg));
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(fmt::format("{}: {}", path, error.what()));
  }
}

std::string to_yaml(const DetectorParams& params) {
  std::string yaml = "# Parameters of brink: read by --params.\n";
  std::string group;
  for (const Parameter& parameter : list_parameters(params)) {
    const std::size_t dot = parameter.key.find('.');
    if (parameter.key.substr(0, dot) != group) {
      group = parameter.key.substr(0, dot);
      yaml += group + ":\n";
    }
    const std::string unit = parameter.unit.empty() ? "" : parameter.unit + "; ";
    yaml += fmt::format("  {}: {}  # {}{}\n", parameter.key.substr(dot + 1), parameter.value, unit, parameter.meaning);
  }
  return yaml;
}

}  // namespace brink
