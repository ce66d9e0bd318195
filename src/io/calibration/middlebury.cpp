#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "io/calibration/kinds.hpp"
#include "io/calibration/text_fields.hpp"
#include "io/yaml_fields.hpp"

namespace brink {
namespace {

// The camera matrix f 0 cx, 0 f cy, 0 0 1 as a projection; tx is told elsewhere.
Projection projection_of(const std::string& path, const TextFields& fields, const std::string& name, double tx) {
  const std::vector<double> k = read_text_field(path, fields, name, 9);
  return {name, {k[0], k[1], k[2], tx, k[3], k[4], k[5], 0.0, k[6], k[7], k[8], 0.0}};
}

}  // namespace

bool looks_like_middlebury(const std::string& text) {
  const TextFields fields = read_text_fields(text, '=', "[];");
  return fields.contains("cam0") || fields.contains("doffs");
}

// z = baseline f / (d + doffs): moving the right picture by doffs makes that of it what brink computes with.
StereoCalibration read_middlebury(const CalibrationRequest& request, const std::string& text) {
  constexpr double kMillimetres = 1e-3;
  const std::string& path = request.files.path;
  const TextFields fields = read_text_fields(text, '=', "[];");
  const Projection left = projection_of(path, fields, "cam0", 0.0);
  const double baseline = read_text_field(path, fields, "baseline", 1)[0] * kMillimetres;
  Projection right = projection_of(path, fields, "cam1", 0.0);
  right.p[3] = -baseline * right.p[0];
  const double offset = right.p[2] - left.p[2];
  const double doffs = fields.contains("doffs") ? read_text_field(path, fields, "doffs", 1)[0] : offset;
  constexpr double kTolerance = 0.01;  // px; the files have three digits
  if (std::abs(doffs - offset) > kTolerance) {
    fail_file(path, fmt::format("doffs = {}, expected the difference of the principal columns, {:.3f}", doffs, offset));
  }
  std::vector<double> sides = read_text_field(path, fields, "width", 1);
  sides.push_back(read_text_field(path, fields, "height", 1)[0]);
  return from_projections(request, "Middlebury", left, right, make_size(path, "width, height", sides), true);
}

}  // namespace brink
