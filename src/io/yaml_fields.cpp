#include "io/yaml_fields.hpp"

#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include "io/text.hpp"

namespace brink {

void fail_file(const std::string& path, const std::string& fault) { throw std::runtime_error(path + ": " + fault); }

double read_number(const std::string& path, const std::string& field, std::size_t position, const std::string& text) {
  const std::optional<double> number = parse_number(text);
  if (!number) fail_file(path, fmt::format("{}, number {} = {}, expected a finite number", field, position + 1, text));
  return *number;
}

void check_count(const std::string& path, const std::string& field, std::size_t count, std::size_t expected) {
  if (count != expected) fail_file(path, fmt::format("{} has {} numbers, expected {}", field, count, expected));
}

YAML::Node parse_yaml(const std::string& path, const std::string& text) {
  try {
    return YAML::Load(text);
  } catch (const YAML::Exception& error) {
    fail_file(path, fmt::format("is not YAML: line {}: {}", error.mark.line + 1, error.msg));
  }
}

YAML::Node parse_opencv_yaml(const std::string& path, std::string text, const std::string& expected) {
  if (text.starts_with('%')) text.erase(0, text.find('\n'));
  YAML::Node root = parse_yaml(path, text);
  if (!root.IsMap()) fail_file(path, "holds no fields, expected " + expected);
  return root;
}

std::vector<double> read_numbers(const std::string& path, const std::string& field, const YAML::Node& matrix) {
  const YAML::Node data = matrix.IsMap() ? matrix["data"] : matrix;
  if (!data || !data.IsSequence()) fail_file(path, field + " has no data, expected a list of numbers");
  std::vector<double> numbers;
  const auto take = [&](const YAML::Node& number) {
    numbers.push_back(read_number(path, field, numbers.size(), number.IsScalar() ? number.Scalar() : "a list"));
  };
  for (const YAML::Node& element : data) {
    if (!element.IsSequence()) {
      take(element);
      continue;
    }
    for (const YAML::Node& number : element) take(number);
  }
  return numbers;
}

std::vector<double> read_numbers(const std::string& path, const std::string& field, const YAML::Node& matrix,
                                 std::size_t expected) {
  std::vector<double> numbers = read_numbers(path, field, matrix);
  check_count(path, field, numbers.size(), expected);
  return numbers;
}

}  // namespace brink
