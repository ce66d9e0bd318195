#pragma once

#include <string>
#include <vector>

#include "brink/detector.hpp"

namespace brink {

/// One frame as a line of JSON (docs/formats.md), with the line's end. Lengths are rounded to 0.1 mm, angles to 0.001 degrees.
/// What is not known is null; there is no NaN, whatever the detection holds.
std::string to_json_line(const Detection& detection);

/// Reads what to_json_line wrote, frame by frame. Images are empty, contours are their corners, a ground that is known has its
/// pose but only `height_m`, `pitch_deg` and `roll_deg` of it.
/// @throws std::runtime_error "file: line n: ..." for a line that is cut off or not such an object (which field, what was
///         expected), for frame numbers that do not increase, and for an empty file.
std::vector<Detection> read_detections(const std::string& path);

}  // namespace brink
