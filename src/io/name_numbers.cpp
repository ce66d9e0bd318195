#include "io/name_numbers.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <functional>
#include <set>
#include <string_view>
#include <utility>

#include "io/text.hpp"

namespace brink {
namespace {

constexpr std::size_t kMostDigits = 18;  // that an int64 holds of every number

/// Digits before the point and behind it.
struct NumberText {
  std::string_view whole;
  std::string_view fraction;
};

bool is_digit(char letter) { return std::isdigit(static_cast<unsigned char>(letter)) != 0; }

/// All numbers of a name, from its end.
std::vector<NumberText> numbers_of(std::string_view name) {
  const auto run = [&](std::size_t start) {
    std::size_t end = start;
    while (end < name.size() && is_digit(name[end])) ++end;
    return name.substr(start, end - start);
  };
  std::vector<NumberText> numbers;
  for (std::size_t at = 0; at < name.size(); ++at) {
    NumberText number{run(at), {}};
    if (number.whole.empty()) continue;
    at += number.whole.size();
    if (at < name.size() && name[at] == '.') number.fraction = run(at + 1);
    if (!number.fraction.empty()) at += 1 + number.fraction.size();
    numbers.push_back(number);
  }
  std::ranges::reverse(numbers);
  return numbers;
}

/// The number in units of 10^-decimals.
std::optional<std::int64_t> scaled(const NumberText& number, std::size_t decimals) {
  if (number.whole.size() + decimals > kMostDigits + 1) return std::nullopt;
  std::string digits = std::string(number.whole) + std::string(number.fraction);
  digits.append(decimals - number.fraction.size(), '0');
  return parse_number<std::int64_t>(digits);
}

/// The numbers at one place of all names, if they differ.
std::optional<NameNumbers> read_place(const std::vector<std::vector<NumberText>>& names, std::size_t place) {
  std::size_t decimals = 0;
  for (const auto& numbers : names) decimals = std::max(decimals, numbers[place].fraction.size());
  NameNumbers found{{}, static_cast<int>(decimals)};
  std::set<std::int64_t> known;
  for (const auto& numbers : names) {
    const std::optional<std::int64_t> value = scaled(numbers[place], decimals);
    if (!value || !known.insert(*value).second) return std::nullopt;
    found.values.push_back(*value);
  }
  return found;
}

}  // namespace

std::optional<NameNumbers> find_name_numbers(const std::vector<std::string>& paths) {
  std::vector<std::string> stems;
  for (const std::string& path : paths) stems.push_back(std::filesystem::path(path).stem().string());
  std::vector<std::vector<NumberText>> names;
  std::size_t places = paths.empty() ? 0 : kMostDigits;
  for (const std::string& stem : stems) {
    names.push_back(numbers_of(stem));
    places = std::min(places, names.back().size());
  }
  for (std::size_t place = 0; place < places; ++place) {
    if (auto found = read_place(names, place)) return found;
  }
  return std::nullopt;
}

std::optional<NameTimes> to_times(const std::vector<std::int64_t>& values, int decimals) {
  constexpr double kLeastStep = 0.002;  // s
  constexpr std::array<std::pair<const char*, double>, 4> kUnits = {{{"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}}};
  const auto in_unit = [&](const char* unit, double seconds) -> std::optional<NameTimes> {
    NameTimes times{{}, unit};
    for (const std::int64_t value : values) times.seconds.push_back(static_cast<double>(value - values.front()) * seconds);
    const bool finer_than_a_double =
        std::ranges::adjacent_find(times.seconds, std::ranges::greater_equal()) != times.seconds.end();
    return finer_than_a_double ? std::nullopt : std::optional(times);
  };
  if (decimals > 0) return in_unit("s", std::pow(10.0, -decimals));
  std::vector<std::int64_t> steps;
  for (std::size_t i = 1; i < values.size(); ++i) steps.push_back(values[i] - values[i - 1]);
  if (steps.empty()) return in_unit("s", 1.0);  // one frame: its time is 0 in any unit
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::ranges::nth_element(steps, middle);
  for (const auto& [unit, seconds] : kUnits) {
    const double step = static_cast<double>(*middle) * seconds;
    if (step >= kLeastStep && step < 1000.0 * kLeastStep) return in_unit(unit, seconds);
  }
  return std::nullopt;
}

}  // namespace brink
