#include "brink/sequence_writer.hpp"

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include "brink/disparity.hpp"
#include "brink/files.hpp"
#include "brink/pictures.hpp"
#include "brink/trajectory.hpp"

namespace brink {
namespace fs = std::filesystem;
namespace {

constexpr const char* kRecipe = "simulation.yaml";

[[noreturn]] void fail(const std::string& path, const std::error_code& error) {
  throw std::runtime_error(fmt::format("{}: cannot be written: {}", path, error.message()));
}

std::string without_slash(std::string path) {
  while (path.size() > 1 && path.ends_with('/')) path.pop_back();
  return path;
}

// The first line of `wanted` that the recipe in a folder does not have at its place.
std::string first_difference(std::string_view found, std::string_view wanted) {
  const auto line = [](std::string_view& text) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view first = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    return first;
  };
  while (true) {
    const std::string_view old = line(found);
    const std::string_view now = line(wanted);
    if (old != now || (found.empty() && wanted.empty())) return fmt::format(R"("{}", not "{}")", old, now);
  }
}

void require_recipe(const std::string& folder, const std::string& recipe) {
  const std::string found = read_file(folder + "/" + kRecipe);
  if (found == recipe) return;
  throw std::runtime_error(fmt::format("{}: cannot be resumed, it was made with {}", folder, first_difference(found, recipe)));
}

void remove_all(const std::string& path) {
  std::error_code error;
  fs::remove_all(path, error);
  if (error) fail(path, error);
}

void make_folder(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) fail(path, error);
}

// What a killed process left half written.
void remove_temporary_files(const std::string& folder) {
  std::vector<fs::path> left;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with('.') && name.ends_with(".part")) left.push_back(entry.path());
  }
  for (const fs::path& path : left) remove_all(path.string());
}

bool is_there(const std::string& path) {
  std::error_code missing;
  return fs::exists(fs::symlink_status(path, missing));
}

// Nothing is removed or overwritten that does not say that it is ours.
void require_simulated(const std::string& folder) {
  if (is_there(folder + "/" + kRecipe)) return;
  throw std::runtime_error(fmt::format("{}: is no simulated sequence (has no {}), so it is not replaced", folder, kRecipe));
}

void rename(const std::string& from, const std::string& to) {
  std::error_code error;
  fs::rename(from, to, error);
  if (error) fail(to, error);
}

std::string number_of(int frame, const char* extension) { return fmt::format("{:06}.{}", frame, extension); }

std::string encode_jpeg(const cv::Mat3b& picture, int quality) {
  std::vector<uchar> bytes;
  if (!cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_QUALITY, quality})) {
    throw std::runtime_error("picture cannot be stored as JPEG");
  }
  return {bytes.begin(), bytes.end()};
}

std::string projection(const char* name, const StereoCamera& camera, double baseline) {
  return fmt::format("{0}: {1} 0 {2} {4} 0 {1} {3} 0 0 0 1 0\n", name, camera.focal, camera.cx, camera.cy,
                     baseline == 0.0 ? 0.0 : -camera.focal * baseline);
}

}  // namespace

SequenceWriter::SequenceWriter(const std::string& folder, const std::string& recipe, Existing existing)
    : folder_(without_slash(folder)), part_(folder_ + ".part") {
  if (folder.empty()) fail("\"\"", std::make_error_code(std::errc::no_such_file_or_directory));
  if (is_there(folder_)) {
    if (existing == Existing::refuse) throw std::runtime_error(folder_ + ": is there already; --force replaces it");
    require_simulated(folder_);
    if (existing == Existing::resume) {
      require_recipe(folder_, recipe);
      complete_ = true;
      return;
    }
  }
  if (is_there(part_)) {
    if (existing == Existing::refuse) {
      throw std::runtime_error(part_ + ": is left of an interrupted run; --resume goes on with it, --force starts anew");
    }
    require_simulated(part_);
    if (existing == Existing::resume) {
      require_recipe(part_, recipe);
      remove_temporary_files(part_);
    } else {
      remove_all(part_);
    }
  }
  make_folder(part_);
  write_file(path_of(kRecipe), recipe);
  for (const char* name : {"image_2", "image_3", "disparity", "negative"}) make_folder(path_of(name));
}

bool SequenceWriter::has_frame(int frame) const { return is_there(path_of("negative/" + number_of(frame, "png"))); }

void SequenceWriter::write_pictures(int frame, const cv::Mat3b& left, const cv::Mat3b& right, int jpeg_quality) const {
  const auto write = [&](const char* eye, const cv::Mat3b& picture) {
    const std::string name = number_of(frame, jpeg_quality == 0 ? "png" : "jpg");
    write_file(path_of(fmt::format("{}/{}", eye, name)),
               jpeg_quality == 0 ? encode_png(picture) : encode_jpeg(picture, jpeg_quality));
  };
  write("image_2", left);
  write("image_3", right);
}

void SequenceWriter::write_truth(int frame, const cv::Mat1f& disparity, const cv::Mat1b& negative) const {
  constexpr float kTooLarge = 255.99F;
  cv::Mat1f stored = disparity.clone();
  stored.setTo(kInvalidDisparity, (disparity <= 0.0F) | (disparity > kTooLarge));
  const std::string name = number_of(frame, "png");
  write_file(path_of("disparity/" + name), encode_disparity(stored, DisparityFormat::png));
  write_file(path_of("negative/" + name), encode_png(negative));
}

void SequenceWriter::write_calibration(const StereoCamera& camera) const {
  write_file(path_of("calib.txt"), projection("P0", camera, 0.0) + projection("P1", camera, camera.baseline) +
                                       projection("P2", camera, 0.0) + projection("P3", camera, camera.baseline));
}

void SequenceWriter::write_times(const std::vector<double>& times) const {
  std::string text;
  for (const double time : times) text += fmt::format("{:.6f}\n", time);
  write_file(path_of("times.txt"), text);
}

void SequenceWriter::write_poses(const std::vector<Eigen::Isometry3d>& world_from_camera) const {
  write_file(path_of("poses.txt"), to_kitti({{}, world_from_camera}));
}

void SequenceWriter::write_imu(const std::vector<ImuSample>& samples) const {
  std::string text = "t,gx,gy,gz,ax,ay,az\n";
  for (const ImuSample& sample : samples) {
    const Eigen::Vector3d& rate = sample.angular_rate;
    const Eigen::Vector3d& force = sample.specific_force;
    text += fmt::format("{:.6f},{:.7f},{:.7f},{:.7f},{:.6f},{:.6f},{:.6f}\n", sample.time, rate.x(), rate.y(), rate.z(),
                        force.x(), force.y(), force.z());
  }
  write_file(path_of("imu.csv"), text);
}

void SequenceWriter::write_instances(const std::vector<InstanceTruth>& instances) const {
  std::string text = instances.empty() ? "[]\n" : "";
  for (const InstanceTruth& instance : instances) {
    text += fmt::format("- id: {}\n  type: {}\n  depth_m: {:.4f}\n  opening:\n", instance.id, instance.type, instance.depth_m);
    for (const Eigen::Vector3d& point : instance.opening) {
      text += fmt::format("    - [{:.6f}, {:.6f}, {:.6f}]\n", point.x(), point.y(), point.z());
    }
  }
  write_file(path_of("instances.yaml"), text);
}

void SequenceWriter::commit() {
  const std::string old = folder_ + ".old.part";
  if (is_there(old)) remove_all(old);
  if (is_there(folder_)) rename(folder_, old);
  rename(part_, folder_);
  if (is_there(old)) remove_all(old);
  complete_ = true;
}

}  // namespace brink
