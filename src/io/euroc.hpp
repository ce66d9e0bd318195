#pragma once

#include <optional>
#include <string>

#include "brink/calibration.hpp"
#include "brink/sequence.hpp"

namespace brink {

/// Whether the folder is in the EuRoC/ASL layout: it holds mav0/cam0.
bool is_euroc(const std::string& folder);

/// The EuRoC/ASL half of open_sequence.
/// @param pictures as in CalibrationFiles.
Sequence open_euroc(const std::string& folder, std::optional<PictureState> pictures);

}  // namespace brink
