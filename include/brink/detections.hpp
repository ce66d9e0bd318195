#pragma once

#include <string>

#include "brink/detector.hpp"

namespace brink {

/// One frame as a line of JSON (docs/formats.md), with the line's end. Lengths are rounded to 0.1 mm, angles to 0.001 degrees.
/// What is not known is null; there is no NaN, whatever the detection holds.
std::string to_json_line(const Detection& detection);

}  // namespace brink
