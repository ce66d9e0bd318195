#pragma once

#include <cstdint>
#include <optional>

namespace brink::app {

/// How often memory was asked for since counting began, by all threads and libraries.
struct Allocations {
  std::int64_t calls = 0;
  std::int64_t bytes = 0;
};

/// Begins anew.
void start_counting_allocations();

/// Ends it. @return empty where it cannot be counted: under sanitizers, which watch the heap themselves, and without glibc.
std::optional<Allocations> stop_counting_allocations();

/// Memory that was asked for and not given back, MB. It does not grow unless something is kept; what the program holds of the
/// system's memory may, by gaps between blocks. @return empty where it cannot be told, as above.
std::optional<double> allocated_mb();

}  // namespace brink::app
