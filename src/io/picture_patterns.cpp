#include "io/picture_patterns.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <regex>
#include <stdexcept>

#include <fmt/format.h>
#include <glob.h>

#include "io/name_numbers.hpp"
#include "io/sequence_files.hpp"

namespace brink {
namespace fs = std::filesystem;
namespace {

/// A place for a number as printf has it: %d, %6d or %06d.
const std::regex& number_place() {
  static const std::regex place("%(0?[0-9]*)d");
  return place;
}

/// The pattern for glob(3), and what must be left of its matches.
struct Pattern {
  std::string glob;
  std::optional<std::regex> name;  ///< with a number's place: of the whole path
};

std::string escaped(const std::string& text) {
  return std::regex_replace(text, std::regex(R"([.^$|()\[\]{}*+?\\])"), R"(\$&)");
}

Pattern parse_pattern(const std::string& text) {
  std::smatch place;
  if (!std::regex_search(text, place, number_place())) return {text, std::nullopt};
  const std::string after = place.suffix();
  if (text.find_first_of("*?[") != std::string::npos || std::regex_search(after, number_place())) {
    throw std::invalid_argument(fmt::format("pattern = {}, must have one {} and no *, ? or [", text, place.str()));
  }
  const std::string width = place[1].str();
  const std::string digits = width.empty() || width == "0" ? "[0-9]+" : fmt::format("[0-9]{{{},}}", std::stoi(width));
  return {place.prefix().str() + "*" + after, std::regex(escaped(place.prefix()) + digits + escaped(after))};
}

/// The files that a pattern matches, by the numbers of their names if they have any, else as strverscmp(3) sorts them.
struct FoundFiles {
  std::string pattern;
  std::vector<std::string> paths;
  std::optional<NameNumbers> numbers;
};

std::vector<std::string> list_matches(const std::string& text) {
  const Pattern pattern = parse_pattern(text);
  ::glob_t found{};
  const int result = ::glob(pattern.glob.c_str(), GLOB_NOSORT, nullptr, &found);
  std::vector<std::string> paths;
  std::error_code error;
  for (std::size_t i = 0; i < found.gl_pathc; ++i) {
    const std::string path = found.gl_pathv[i];
    if (!fs::is_directory(path, error) && (!pattern.name || std::regex_match(path, *pattern.name))) paths.push_back(path);
  }
  ::globfree(&found);
  if (result != 0 && result != GLOB_NOMATCH) throw std::runtime_error(text + ": its folder cannot be read");
  if (paths.empty()) throw std::runtime_error(text + ": no such file, and no file matches it as a pattern");
  return paths;
}

FoundFiles find_files(const std::string& pattern) {
  FoundFiles found{pattern, list_matches(pattern), std::nullopt};
  std::ranges::sort(found.paths, [](const std::string& a, const std::string& b) {
    const int order = ::strverscmp(a.c_str(), b.c_str());
    return order != 0 ? order < 0 : a < b;
  });
  found.numbers = find_name_numbers(found.paths);
  if (!found.numbers) return found;
  std::map<std::int64_t, std::string> sorted;
  for (std::size_t i = 0; i < found.paths.size(); ++i) sorted[found.numbers->values[i]] = found.paths[i];
  found.paths.clear();
  found.numbers->values.clear();
  for (const auto& [number, path] : sorted) {
    found.paths.push_back(path);
    found.numbers->values.push_back(number);
  }
  return found;
}

/// What belongs together: a frame before it has a time.
struct Moment {
  int index = 0;                       ///< of the frame
  std::optional<std::int64_t> number;  ///< in the names
  std::string left;                    ///< "" = missing
  std::string right;
};

struct Moments {
  std::vector<Moment> list;
  int decimals = 0;  ///< of the numbers
};

Moments in_order(const FoundFiles& left, const FoundFiles* right) {
  Moments moments{{}, left.numbers ? left.numbers->decimals : 0};
  for (std::size_t i = 0; i < left.paths.size(); ++i) {
    moments.list.push_back({static_cast<int>(i), left.numbers ? std::optional(left.numbers->values[i]) : std::nullopt,
                            left.paths[i], right != nullptr ? right->paths[i] : ""});
  }
  return moments;
}

bool share_a_number(const FoundFiles& left, const FoundFiles& right) {
  if (!left.numbers || !right.numbers || left.numbers->decimals != right.numbers->decimals) return false;
  std::vector<std::int64_t> shared;
  std::ranges::set_intersection(left.numbers->values, right.numbers->values, std::back_inserter(shared));
  return !shared.empty();
}

Moments pair_by_number(const FoundFiles& left, const FoundFiles& right) {
  std::map<std::int64_t, Moment> by_number;
  for (std::size_t i = 0; i < left.paths.size(); ++i) by_number[left.numbers->values[i]].left = left.paths[i];
  for (std::size_t i = 0; i < right.paths.size(); ++i) by_number[right.numbers->values[i]].right = right.paths[i];
  Moments moments{{}, left.numbers->decimals};
  for (const auto& [number, moment] : by_number) {
    moments.list.push_back({static_cast<int>(moments.list.size()), number, moment.left, moment.right});
  }
  return moments;
}

/// The step of consecutive frame numbers, as 5 in every fifth picture; empty when the numbers are none: times, for instance.
std::optional<std::int64_t> find_step(const Moments& moments) {
  if (moments.decimals > 0 || !moments.list.front().number) return std::nullopt;
  if (*moments.list.back().number > std::numeric_limits<int>::max()) return std::nullopt;
  std::int64_t step = 0;
  for (std::size_t i = 1; i < moments.list.size(); ++i) {
    step = std::gcd(step, *moments.list[i].number - *moments.list[i - 1].number);
  }
  step = std::max<std::int64_t>(step, 1);
  const std::int64_t frames = (*moments.list.back().number - *moments.list.front().number) / step + 1;
  return frames <= 2 * std::ssize(moments.list) ? std::optional(step) : std::nullopt;  // more than half would be missing
}

/// Where the names hold frame numbers, frames get those, and what is missing in between is a frame as well.
void number_frames(Moments& moments) {
  const std::optional<std::int64_t> step = find_step(moments);
  if (!step) return;
  std::vector<Moment> numbered;
  for (const Moment& moment : moments.list) {
    std::int64_t number = numbered.empty() ? *moment.number : *numbered.back().number + *step;
    for (; number < *moment.number; number += *step) numbered.push_back({static_cast<int>(number), number, "", ""});
    numbered.push_back({static_cast<int>(number), number, moment.left, moment.right});
  }
  moments.list = std::move(numbered);
}

/// When the frames were taken.
struct Times {
  std::vector<double> seconds;
  std::string source;  ///< for people
};

Times read_name_times(const std::string& name, const Moments& moments) {
  std::vector<std::int64_t> numbers;
  for (const Moment& moment : moments.list) {
    if (moment.number) numbers.push_back(*moment.number);
  }
  const bool complete = numbers.size() == moments.list.size();
  const std::optional<NameTimes> times = complete ? to_times(numbers, moments.decimals) : std::nullopt;
  if (!times) {
    throw std::runtime_error(
        name + ": the names tell no times, expected a number in each, in ns, us, ms or s, with steps of 2 ms to 2 s");
  }
  return {times->seconds, "times from the names, in " + times->unit};
}

Times read_file_times(const std::string& file, const std::vector<Moment>& frames) {
  const std::vector<double> times = read_time_list(file);
  const bool one_each = times.size() == frames.size();
  if (!one_each && times.size() <= static_cast<std::size_t>(frames.back().index)) {
    throw std::runtime_error(
        fmt::format("{}: has {} times, expected one for each of {} frames", file, times.size(), frames.size()));
  }
  Times found{{}, "times from " + file};
  for (std::size_t i = 0; i < frames.size(); ++i) {
    found.seconds.push_back(times[one_each ? i : static_cast<std::size_t>(frames[i].index)]);
  }
  return found;
}

Times find_times(const std::string& name, const Moments& moments, const TimeSource& source) {
  if (source.names) return read_name_times(name, moments);
  if (!source.file.empty()) return read_file_times(source.file, moments.list);
  Times times{{}, source.fps ? fmt::format("{:.4g} a second", *source.fps) : "no times"};
  for (const Moment& moment : moments.list) times.seconds.push_back(moment.index / source.fps.value_or(1.0));
  return times;
}

}  // namespace

bool is_pattern(const std::string& path) {
  std::error_code error;
  return !fs::exists(path, error) &&
         (path.find_first_of("*?[") != std::string::npos || std::regex_search(path, number_place()));
}

PatternFrames match_patterns(const std::string& left, const std::string& right, const TimeSource& source) {
  source.validate();
  const FoundFiles left_files = find_files(left);
  std::string name = left;
  std::string pairing;
  bool by_number = false;
  Moments moments;
  if (right.empty()) {
    moments = in_order(left_files, nullptr);
  } else {
    name += " and " + right;
    const FoundFiles right_files = find_files(right);
    by_number = share_a_number(left_files, right_files);
    if (!by_number && left_files.paths.size() != right_files.paths.size()) {
      throw std::runtime_error(
          fmt::format("{}: {} left and {} right pictures, and their names share no numbers to pair them by", name,
                      left_files.paths.size(), right_files.paths.size()));
    }
    moments = by_number ? pair_by_number(left_files, right_files) : in_order(left_files, &right_files);
    pairing = by_number ? ", paired by the numbers in their names" : ", paired by order";
  }
  // Times are no frame numbers, nor are numbers of which each eye has its own: none is missing between two of them.
  if (!source.names && (right.empty() || by_number)) number_frames(moments);
  const Times times = find_times(name, moments, source);

  PatternFrames found{{}, {fmt::format("{}: {} frames{}, {}", name, moments.list.size(), pairing, times.source)}};
  std::vector<int> left_indices;
  std::vector<int> right_indices;
  for (const Moment& moment : moments.list) {
    if (!moment.left.empty()) left_indices.push_back(moment.index);
    if (!moment.right.empty()) right_indices.push_back(moment.index);
    const bool gone = moment.left.empty() && moment.right.empty();
    const std::string path = gone ? fmt::format("{}, number {}", name, moment.index) : moment.left;
    found.frames.push_back({moment.index, times.seconds[found.frames.size()], path, moment.right});
  }
  if (right.empty()) return found;
  if (const auto remark = unequal_counts(name, left_indices, right_indices)) found.remarks.push_back(*remark);
  return found;
}

}  // namespace brink
