#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace brink {

/// The numbers that the names of files tell them apart by: left_000012.png, 1403636579763555584.png, 1305031102.175304.png.
struct NameNumbers {
  std::vector<std::int64_t> values;  ///< of each file, whole numbers of 10^-decimals
  int decimals = 0;                  ///< digits behind the point, of the name that has most
};

/// The last number of the names, without folder and extension, in which all of them differ.
/// @return empty when there is none: a name without a number, two with the same, or one of more than 18 digits.
std::optional<NameNumbers> find_name_numbers(const std::vector<std::string>& paths);

/// What such numbers are as times.
struct NameTimes {
  std::vector<double> seconds;  ///< since the first
  std::string unit;             ///< "ns", "us", "ms" or "s"
};

/// Numbers with decimals are seconds. Whole ones are in the unit in which their median step is at least 2 ms and below 2 s:
/// each unit is a thousand times the next smaller one, so that is never more than one.
/// @param values ascending. @return empty when there is no such unit, or two times are the same as double.
std::optional<NameTimes> to_times(const std::vector<std::int64_t>& values, int decimals);

}  // namespace brink
