#pragma once

#include <cstddef>
#include <cstdint>

#include "disparity/descriptors.hpp"

namespace brink::benchmarks {

/// Sum of the matching costs of pairs of descriptors: how fast costs can be computed when nothing is done with each. @param
/// count a multiple of 8.
std::uint64_t add_differences(const Descriptor* a, const Descriptor* b, std::size_t count);

}  // namespace brink::benchmarks
