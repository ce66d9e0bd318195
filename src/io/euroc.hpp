#pragma once

#include <string>

#include "brink/sequence.hpp"

namespace brink {

/// Whether the folder is in the EuRoC/ASL layout: it holds mav0/cam0.
bool is_euroc(const std::string& folder);

/// The EuRoC/ASL half of open_sequence.
Sequence open_euroc(const std::string& folder);

}  // namespace brink
