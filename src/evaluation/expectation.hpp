#pragma once

#include <optional>

#include "brink/candidates.hpp"
#include "brink/detector.hpp"
#include "brink/truth.hpp"

namespace brink {

/// Whether the envelope has an instance seen by the rules of Type 1 in this frame: with the true pose of the camera over its
/// rim, its true opening and depth, the pixels that truly show it, and the noise that the detection found.
/// @return empty when one of these is not known.
std::optional<bool> is_in_envelope(const VisibleInstance& instance, const FrameTruth& truth, const Detection& detection,
                                   const CandidateParams& rules);

}  // namespace brink
