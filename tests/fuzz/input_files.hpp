#pragma once

#include <cstdint>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "temporary_folder.hpp"

namespace brink::fuzz {

/// The bytes that libFuzzer made.
inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// Overwrites a file of this process's own folder, which the readers are then given; returns its path.
inline std::string put(const std::string& name, std::string_view bytes) {
  static const test::TemporaryFolder folder;
  std::ofstream(folder / name, std::ios::binary) << bytes;
  return folder / name;
}

/// What a reader returned; empty when it refused the input as it promises: with a line that names the fault. Any other
/// exception is a finding.
template <typename Read>
auto result_of(Read read) -> std::optional<decltype(read())> {
  const auto check = [](const std::exception& refusal) {
    if (std::string_view(refusal.what()).empty()) throw std::logic_error("refused without a reason");
  };
  try {
    return read();
  } catch (const std::runtime_error& refusal) {
    check(refusal);
  } catch (const std::invalid_argument& refusal) {
    check(refusal);
  }
  return std::nullopt;
}

/// A finding.
inline void require(bool holds, const char* fact) {
  if (!holds) throw std::logic_error(fact);
}

/// Several files in one input: a line "=== NAME" begins each. What stands before the first such line is left out.
inline std::vector<std::pair<std::string, std::string_view>> split_files(std::string_view text) {
  constexpr std::string_view kMark = "=== ";
  std::vector<std::pair<std::string, std::string_view>> files;
  for (std::size_t at = text.find(kMark); at != std::string_view::npos;) {
    const std::size_t name = at + kMark.size();
    const std::size_t line_end = std::min(text.find('\n', name), text.size());
    const std::size_t start = std::min(line_end + 1, text.size());
    at = text.find(kMark, start);
    files.emplace_back(text.substr(name, line_end - name), text.substr(start, at == std::string_view::npos ? at : at - start));
  }
  return files;
}

}  // namespace brink::fuzz
