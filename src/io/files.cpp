#include "brink/files.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

namespace brink {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void fail_to_write(const std::string& path, int error) {
  throw std::runtime_error(fmt::format("{}: cannot be written: {}", path, std::generic_category().message(error)));
}

// Devices, pipes and what hides behind /dev/stdout cannot be renamed into place.
bool is_written_directly(const std::string& path) {
  const bool in_memory = path.starts_with("/dev/shm/");  // files like any other
  if ((path.starts_with("/dev/") && !in_memory) || path.starts_with("/proc/")) return true;
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  return fs::exists(status) && !fs::is_regular_file(status);
}

// Unique among the processes and threads that write into one folder.
std::string temporary_name(const std::string& target, const std::string& ending) {
  static std::atomic<unsigned> counter{0};
  const fs::path path(target);
  const std::string name = fmt::format(".{}.{}.{}.part{}", path.filename().string(), ::getpid(), counter++, ending);
  return (path.parent_path() / name).string();
}

}  // namespace

std::string read_file(const std::string& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) throw std::runtime_error(path + ": no such file");
  if (fs::is_directory(status)) throw std::runtime_error(path + ": is a folder, expected a file");
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (!file.is_open() || file.bad()) {
    throw std::runtime_error(fmt::format("{}: cannot be read: {}", path, std::generic_category().message(errno)));
  }
  return bytes;
}

OutputFile::OutputFile(const std::string& path, const std::string& ending) : path_(path), target_(path) {
  std::error_code missing;
  if (path == "-") {
    descriptor_ = ::dup(STDOUT_FILENO);
    path_ = "standard output";
  } else if (path.empty() || fs::is_directory(path, missing)) {
    fail(path.empty() ? ENOENT : EISDIR);
  } else if (is_written_directly(path)) {
    descriptor_ = ::open(path.c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC);
  } else {
    if (fs::exists(path, missing)) {
      if (::access(path.c_str(), W_OK) != 0) fail(errno);
      target_ = fs::canonical(path).string();  // a link stays a link, its target is replaced
    }
    temporary_ = temporary_name(target_, ending);
    constexpr int kEveryone = 0666;  // less what umask takes away
    descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kEveryone);
  }
  if (descriptor_ < 0) fail(errno);
}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void OutputFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(errno);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

void OutputFile::check_room() {
  constexpr std::size_t kRoom = 65536;
  const off_t end = ::lseek(descriptor_, 0, SEEK_END);
  if (end < 0) fail(errno);
  write(std::string(kRoom, '\0'));
  if (::ftruncate(descriptor_, end) != 0) fail(errno);
}

void OutputFile::commit() {
  if (::close(std::exchange(descriptor_, -1)) != 0) fail(errno);
  if (temporary_.empty()) return;
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) fail(errno);
  temporary_.clear();
}

void OutputFile::fail(int error) const { fail_to_write(path_, error); }

void write_file(const std::string& path, std::string_view bytes) {
  OutputFile file(path);
  file.write(bytes);
  file.commit();
}

OutputFolder::OutputFolder(const std::string& path) : path_(fs::absolute(path)) {
  std::vector<fs::path> missing;
  std::error_code error;
  for (fs::path level = path_; !fs::exists(level, error) && level.has_relative_path(); level = level.parent_path()) {
    missing.push_back(level);
  }
  std::reverse(missing.begin(), missing.end());
  for (const fs::path& level : missing) {
    if (fs::create_directory(level, error)) made_.insert(made_.begin(), level);
    if (error) fail_to_write(path, error.value());
  }
  if (!fs::is_directory(path_, error)) fail_to_write(path, ENOTDIR);
  if (::access(path_.c_str(), W_OK | X_OK) != 0) fail_to_write(path, errno);
}

OutputFolder::~OutputFolder() {
  std::error_code not_empty;
  for (const fs::path& level : made_) fs::remove(level, not_empty);
}

std::string OutputFolder::file(const std::string& name) const { return (path_ / name).string(); }

}  // namespace brink
