#pragma once

#include <string>
#include <vector>

#include "brink/sequence.hpp"

namespace brink {

/// The frames that patterns name, with what people should know of them.
struct PatternFrames {
  std::vector<FrameFiles> frames;    ///< in order; the path of a missing picture is empty, or names no file when both are
  std::vector<std::string> remarks;  ///< for people: what was understood, and what is odd about it
};

/// Looks up the files of one pattern, or of two that are paired (docs/formats.md).
/// @param right empty = the pattern `left` names whole frames, whose `right` stays empty.
/// @throws std::runtime_error "pattern: ..." when one matches nothing, two cannot be paired, or the times cannot be told;
///         std::invalid_argument when a pattern or the times are not what they must be.
PatternFrames match_patterns(const std::string& left, const std::string& right, const TimeSource& times);

}  // namespace brink
