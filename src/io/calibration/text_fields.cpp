#include "io/calibration/text_fields.hpp"

#include <sstream>

#include "io/text.hpp"
#include "io/yaml_fields.hpp"

namespace brink {

TextFields read_text_fields(const std::string& text, char separator, std::string_view blanks) {
  TextFields fields;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t end = line.find(separator);
    if (end == std::string::npos) continue;
    std::string values = line.substr(end + 1);
    for (char& letter : values) {
      if (blanks.find(letter) != std::string_view::npos) letter = ' ';
    }
    std::istringstream stream(values);
    std::vector<std::string> words;
    for (std::string word; stream >> word;) words.push_back(word);
    fields[std::string(trimmed(std::string_view(line).substr(0, end)))] = std::move(words);
  }
  return fields;
}

std::vector<double> read_text_field(const std::string& path, const TextFields& fields, const std::string& name,
                                    std::size_t count) {
  const auto field = fields.find(name);
  if (field == fields.end()) fail_file(path, name + " is missing");
  check_count(path, name, field->second.size(), count);
  std::vector<double> numbers;
  for (std::size_t n = 0; n < count; ++n) numbers.push_back(read_number(path, name, n, field->second[n]));
  return numbers;
}

}  // namespace brink
