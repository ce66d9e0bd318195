#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

namespace brink {

/// Throws std::runtime_error "path: fault".
[[noreturn]] void fail_file(const std::string& path, const std::string& fault);

/// The number that a text of a file is. @param position from 0, in the numbers of the field.
/// @throws std::runtime_error "path: field, number n = ..., expected ..."; all below throw in the same style.
double read_number(const std::string& path, const std::string& field, std::size_t position, const std::string& text);

void check_count(const std::string& path, const std::string& field, std::size_t count, std::size_t expected);

/// The fault of a text that is no YAML names the line.
YAML::Node parse_yaml(const std::string& path, const std::string& text);

/// YAML as OpenCV writes it: with "%YAML:1.0" in the first line, which YAML does not know.
/// @param expected what fields it should have, for the message when it has none.
YAML::Node parse_opencv_yaml(const std::string& path, std::string text, const std::string& expected);

/// A list of numbers, a list of rows, or OpenCV's matrix, which has it as `data`.
std::vector<double> read_numbers(const std::string& path, const std::string& field, const YAML::Node& matrix);

/// The same, of so many numbers.
std::vector<double> read_numbers(const std::string& path, const std::string& field, const YAML::Node& matrix,
                                 std::size_t expected);

}  // namespace brink
