#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace brink {

/// The bytes of a file.
/// @throws std::runtime_error "path: ..." when it is missing, a folder, or cannot be read.
std::string read_file(const std::string& path);

/// A file that is there whole or not at all: written under a temporary name in the same folder, renamed by commit(), removed
/// when there was no commit(). What is not a regular file (/dev/stdout, a pipe) is written directly.
class OutputFile {
 public:
  /// @param path "-" = standard output. @param ending of the temporary name, for libraries that tell a format by it.
  /// @throws std::runtime_error "path: cannot be written: ..."
  explicit OutputFile(const std::string& path, const std::string& ending = "");
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  ~OutputFile();

  /// @throws std::runtime_error "path: cannot be written: ..." as soon as the disk is full.
  void write(std::string_view bytes);
  /// The name until commit(), for libraries that write a file by its name; empty when it is written directly.
  [[nodiscard]] const std::string& temporary() const { return temporary_; }
  /// For those: whether the file could still grow. @throws std::runtime_error as write does when it could not.
  void check_room();
  /// Closes the file and gives it its name. @throws std::runtime_error as write does.
  void commit();

 private:
  [[noreturn]] void fail(int error) const;

  std::string path_;
  std::string target_;     ///< path_ with links followed
  std::string temporary_;  ///< empty when written directly
  int descriptor_ = -1;
};

/// One OutputFile from start to commit.
void write_file(const std::string& path, std::string_view bytes);

/// A folder for output, made when it is missing, with what is above it. Folders made here that are still empty at the end are
/// removed: a run that failed leaves nothing behind.
class OutputFolder {
 public:
  /// @throws std::runtime_error "path: cannot be written: ..." when nothing can be put there.
  explicit OutputFolder(const std::string& path);
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  ~OutputFolder();

  /// The path of a file in this folder.
  [[nodiscard]] std::string file(const std::string& name) const;

 private:
  std::filesystem::path path_;
  std::vector<std::filesystem::path> made_;  // deepest first
};

}  // namespace brink
