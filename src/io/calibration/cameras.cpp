#include "io/calibration/cameras.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <set>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "io/picture_header.hpp"
#include "io/yaml_fields.hpp"

namespace brink {
namespace {

constexpr double kPixelTolerance = 0.01;

void check_same(const std::string& path, const std::string& what, double first, double second, double tolerance) {
  if (std::abs(first - second) > tolerance) {
    fail_file(path,
              fmt::format("{} = {} and {}, expected equal values: rectified cameras with square pixels", what, first, second));
  }
}

// The file that is at fault when two cameras do not go together.
const std::string& file_of_pair(const CalibrationRequest& request) {
  return request.files.right_path.empty() ? request.files.path : request.files.right_path;
}

void check_picture_size(const CalibrationRequest& request, cv::Size size) {
  if (std::int64_t{size.width} * size.height > kMostPixels) {  // rectification takes six bytes a pixel and eye
    fail_file(request.files.path, fmt::format("is for pictures of {}x{} px, expected at most {} megapixels", size.width,
                                              size.height, kMostPixels / 1'000'000));
  }
  const cv::Size& pictures = request.picture_size;
  if (pictures.empty() || size.empty() || pictures == size) return;
  const bool scaled = std::int64_t{pictures.width} * size.height == std::int64_t{pictures.height} * size.width;
  const std::string hint = scaled ? fmt::format(" ({:.4g} times as large): scaled pictures need a calibration of their own",
                                                static_cast<double>(pictures.width) / size.width)
                                  : "";
  fail_file(request.files.path, fmt::format("is for pictures of {}x{} px, these have {}x{}{}", size.width, size.height,
                                            pictures.width, pictures.height, hint));
}

void check_state(const CalibrationRequest& request, const std::string& source, PictureState described) {
  const auto name = [](PictureState state) { return state == PictureState::raw ? "raw" : "rectified"; };
  const std::optional<PictureState>& told = request.files.pictures;
  if (!told || *told == described) return;
  throw std::invalid_argument(fmt::format("pictures = {}, must be {} or not told: {} ({}) describes no others", name(*told),
                                          name(described), request.files.path, source));
}

// Turns the checks of StereoCamera into a fault of the file.
void check_camera(const std::string& path, const std::string& source, const StereoCamera& camera) {
  if (camera.baseline <= 0.0) {
    fail_file(path, fmt::format("{}: baseline = {} m, expected more than 0: are left and right {}?", source, camera.baseline,
                                camera.baseline == 0.0 ? "the same camera" : "swapped"));
  }
  try {
    camera.validate();
  } catch (const std::invalid_argument& error) {
    const char* hint = camera.baseline > 10.0 ? " (is it in millimetres?)" : "";
    fail_file(path, fmt::format("{}: {}{}", source, error.what(), hint));
  }
}

// The right camera must be on the right of the left one, more than above, below, before or behind it.
void check_beside(const std::string& path, const std::string& source, const Eigen::Isometry3d& right_from_left) {
  const Eigen::Vector3d place = right_from_left.inverse().translation().array() + 0.0;  // no -0
  const std::string told = fmt::format("{}: the right camera is at ({:.4g}, {:.4g}, {:.4g}) m from the left one", source,
                                       place.x(), place.y(), place.z());
  const double aside = std::abs(place.x());
  if (aside == 0.0 || aside <= std::max(std::abs(place.y()), std::abs(place.z()))) {
    fail_file(path, told + ", expected beside it");
  }
  if (place.x() < 0.0) fail_file(path, told + ", expected on its right: are they swapped?");
  if (place.norm() > 10.0) fail_file(path, told + ", expected at most 10 m (is it in millimetres?)");
}

void check_projection(const std::string& path, const Projection& projection) {
  const std::vector<double>& p = projection.p;
  const std::string& name = projection.name;
  if (p[0] <= 0.0) fail_file(path, fmt::format("{} focal length = {}, expected more than 0 px", name, p[0]));
  if (p[1] != 0.0 || p[4] != 0.0 || p[8] != 0.0 || p[9] != 0.0 || p[10] != 1.0) {
    fail_file(path, name + " is not the projection of a rectified camera, expected f 0 cx tx, 0 f cy ty, 0 0 1 tz");
  }
  check_same(path, name + " focal lengths along x and y", p[0], p[5], 1e-3 * p[0]);
}

}  // namespace

StereoCalibration from_projections(const CalibrationRequest& request, const std::string& source, const Projection& left,
                                   const Projection& right, cv::Size size, bool shifted) {
  const std::string& path = file_of_pair(request);
  for (const Projection* projection : {&left, &right}) check_projection(path, *projection);
  const double focal = right.p[0];
  const std::string both = left.name + " and " + right.name + " ";
  check_same(path, both + "focal lengths", left.p[0], focal, 1e-3 * focal);
  if (!shifted) check_same(path, both + "principal columns", left.p[2], right.p[2], kPixelTolerance);
  check_same(path, both + "principal rows", left.p[6], right.p[6], kPixelTolerance);
  const double baseline = (left.p[3] - right.p[3]) / focal;
  const double vertical = (left.p[7] - right.p[7]) / focal;
  if (std::abs(vertical) > 0.1 * std::abs(baseline)) {
    fail_file(path, fmt::format("{}are {} m apart vertically, expected cameras side by side", both, vertical));
  }
  return from_rectified(request, source, {left.p[0], left.p[2], left.p[6], baseline}, size, right.p[2] - left.p[2]);
}

StereoCalibration from_rectified(const CalibrationRequest& request, const std::string& source, const StereoCamera& camera,
                                 cv::Size size, double right_offset) {
  const std::string& path = file_of_pair(request);
  check_camera(path, source, camera);
  check_picture_size(request, size);
  check_state(request, source, PictureState::rectified);
  StereoCalibration calibration{camera, source, size.empty() ? request.picture_size : size};
  if (std::abs(right_offset) <= kPixelTolerance) return calibration;
  if (calibration.size.empty() || std::abs(right_offset) >= calibration.size.width) {
    fail_file(path,
              fmt::format("{}: principal columns differ by {} px, expected {}", source, right_offset,
                          calibration.size.empty() ? "pictures of a size that is known" : "less than the pictures' width"));
  }
  calibration.source += fmt::format(", right pictures moved by {:.2f} px", -right_offset);
  calibration.rectification = std::make_shared<Rectification>(make_shift(camera, calibration.size, right_offset));
  return calibration;
}

StereoCalibration from_lenses(const CalibrationRequest& request, const std::string& source, const LensCamera& left,
                              const LensCamera& right, const Eigen::Isometry3d& right_from_left) {
  const std::string& path = file_of_pair(request);
  if (left.size != right.size) {
    fail_file(path, fmt::format("{}: the right camera has {}x{} px, expected those of the left one, {}x{}", source,
                                right.size.width, right.size.height, left.size.width, left.size.height));
  }
  if (left.size.empty()) fail_file(path, source + ": tells no size, and no picture does, expected one of them to");
  check_picture_size(request, left.size);
  check_beside(path, source, right_from_left);
  const std::string told = fmt::format("{}, {}", source, left.lens());
  if (is_rectified(left, right, right_from_left)) {
    const StereoCamera camera{left.focal_x, left.cx, left.cy, right_from_left.translation().norm()};
    check_camera(path, source, camera);
    return {camera, told, left.size};
  }
  check_state(request, source, PictureState::raw);
  std::shared_ptr<const Rectification> rectification;
  try {
    rectification = std::make_shared<Rectification>(make_rectification(left, right, right_from_left));
  } catch (const std::exception& error) {  // of OpenCV's too
    fail_file(path, fmt::format("{}: cannot be rectified: {}", told, error.what()));
  }
  check_camera(path, source + ", rectified", rectification->camera);
  const StereoCamera camera = rectification->camera;
  return {camera, told, left.size, std::move(rectification)};
}

StereoCalibration from_single(const CalibrationRequest& request, const std::string& source, const LensCamera& camera) {
  const std::string& path = request.files.path;
  if (!request.single_will_do) {
    fail_file(path, source + " is about one camera, expected another file with the right one (calib-right)");
  }
  check_picture_size(request, camera.size);
  if (!camera.is_pinhole()) {
    fail_file(path, fmt::format("{}: the lens is {}, expected none: a single picture is not corrected", source, camera.lens()));
  }
  constexpr double kSquare = 5e-3;  // depth cameras without a rectification differ by so much
  check_same(path, source + " focal lengths along x and y", camera.focal_x, camera.focal_y, kSquare * camera.focal_x);
  const StereoCamera nominal{(camera.focal_x + camera.focal_y) / 2.0, camera.cx, camera.cy, kNominalBaseline};
  check_camera(path, source, nominal);
  return {nominal, source, camera.size.empty() ? request.picture_size : camera.size, nullptr, true};
}

LensCamera make_lens(const std::string& path, const std::vector<double>& intrinsics, const std::string& field,
                     const std::string& model, std::vector<double> coefficients, cv::Size size) {
  static const std::set<std::string> radial{"radial-tangential", "radtan", "plumb_bob", "rational_polynomial"};
  static const std::set<std::string> fisheye{"equidistant", "fisheye"};
  static const std::set<std::size_t> counts{0, 4, 5, 8, 12, 14};  // of OpenCV
  LensCamera lens{intrinsics[0],           intrinsics[1], intrinsics[2], intrinsics[3], LensModel::radial_tangential,
                  std::move(coefficients), size};
  if (fisheye.contains(model)) {
    lens.model = LensModel::fisheye;
    check_count(path, field + " " + model, lens.distortion.size(), 4);
  } else if (model == "none") {
    lens.distortion.clear();
  } else if (!radial.contains(model)) {
    fail_file(path, fmt::format("{} = {}, expected radial-tangential, rational, equidistant (fisheye) or none", field, model));
  } else if (!counts.contains(lens.distortion.size())) {
    fail_file(path, fmt::format("{} {} has {} numbers, expected 4, 5, 8, 12 or 14", field, model, lens.distortion.size()));
  }
  for (const double focal : {lens.focal_x, lens.focal_y}) {
    constexpr double kLargest = 1e6;
    if (focal < 1 || focal > kLargest) fail_file(path, fmt::format("focal length = {}, expected 1 to {} px", focal, kLargest));
  }
  return lens;
}

cv::Size make_size(const std::string& path, const std::string& field, const std::vector<double>& sides) {
  for (const double side : sides) {
    constexpr double kLargest = 10000;
    if (side < 1 || side > kLargest || side != std::floor(side)) {
      fail_file(path, fmt::format("{} = {}, expected whole numbers from 1 to {} px", field, side, kLargest));
    }
  }
  return {static_cast<int>(sides[0]), static_cast<int>(sides[1])};
}

Eigen::Matrix3d make_rotation(const std::string& path, const std::string& field, const std::vector<double>& matrix) {
  const Eigen::Matrix3d rotation = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(matrix.data());
  constexpr double kTolerance = 1e-3;
  const double skew = (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (skew > kTolerance || rotation.determinant() < 0.0) fail_file(path, field + " is no rotation");
  return Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
}

Eigen::Isometry3d make_isometry(const std::string& path, const std::string& field, const std::vector<double>& matrix) {
  const Eigen::Matrix4d all = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(matrix.data());
  if (all.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) fail_file(path, field + " is no rotation and shift, expected R t, 0 0 0 1");
  std::vector<double> turn;
  for (const std::size_t at : {0U, 1U, 2U, 4U, 5U, 6U, 8U, 9U, 10U}) turn.push_back(matrix[at]);
  Eigen::Isometry3d isometry = Eigen::Isometry3d::Identity();
  isometry.linear() = make_rotation(path, field, turn);
  isometry.translation() = all.topRightCorner<3, 1>();
  return isometry;
}

}  // namespace brink
