#include "brink/files.hpp"

#include <cstdlib>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "expect_error.hpp"
#include "temporary_folder.hpp"

namespace brink {
namespace {

using Names = std::set<std::string>;

TEST(OutputFile, AppearsWholeWhenItIsCommitted) {
  const test::TemporaryFolder folder;
  OutputFile file(folder / "out");
  file.write("one ");
  file.write("two");
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
  file.commit();
  EXPECT_EQ(read_file(folder / "out"), "one two");
  EXPECT_EQ(folder.list(), Names{"out"});
}

TEST(OutputFile, InSharedMemoryIsAFileLikeAnyOther) {
  std::string folder = "/dev/shm/brink_test_XXXXXX";
  if (::mkdtemp(folder.data()) == nullptr) GTEST_SKIP() << "no /dev/shm here";
  write_file(folder + "/out", "whole");
  EXPECT_EQ(read_file(folder + "/out"), "whole");
  std::filesystem::remove_all(folder);
}

TEST(OutputFile, LeavesNothingWithoutCommit) {
  const test::TemporaryFolder folder;
  { OutputFile(folder / "out").write("half"); }
  EXPECT_EQ(folder.list(), Names{});
}

TEST(OutputFile, KeepsTheOldFileUntilTheNewOneIsWhole) {
  const test::TemporaryFolder folder;
  const std::string path = folder.add("out", "old");
  { OutputFile(path).write("half"); }
  EXPECT_EQ(read_file(path), "old");
  write_file(path, "new");
  EXPECT_EQ(read_file(path), "new");
}

TEST(OutputFile, FollowsALink) {
  const test::TemporaryFolder folder;
  const std::string target = folder.add("target", "old");
  std::filesystem::create_symlink(target, folder / "link");
  write_file(folder / "link", "new");
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_EQ(read_file(target), "new");
}

TEST(OutputFile, ReportsAFullDisk) {
  const auto write = [] { write_file("/dev/full", "x"); };
  test::expect_line_with(test::error_of<std::runtime_error>(write), "/dev/full: cannot be written: No space left on device");
}

TEST(OutputFile, ReportsAPlaceThatCannotBeWritten) {
  const test::TemporaryFolder folder;
  const auto message = [](const std::string& path) {
    return test::error_of<std::runtime_error>([&] { const OutputFile file(path); });
  };
  test::expect_line_with(message(folder / "missing/out"), "missing/out: cannot be written: No such file or directory");
  test::expect_line_with(message(folder / ""), "cannot be written: Is a directory");
  test::expect_line_with(message(""), "cannot be written: No such file or directory");
}

TEST(OutputFolder, IsRemovedAgainOnlyWhileEmpty) {
  const test::TemporaryFolder folder;
  { const OutputFolder made(folder / "a/b"); }
  EXPECT_EQ(folder.list(), Names{});
  {
    const OutputFolder made(folder / "a/b");
    write_file(made.file("c"), "x");
  }
  EXPECT_EQ(folder.list(), (Names{"a", "a/b", "a/b/c"}));
}

TEST(OutputFolder, RefusesAFileInItsWay) {
  const test::TemporaryFolder folder;
  const std::string path = folder.add("taken", "x");
  const auto message = [](const std::string& name) {
    return test::error_of<std::runtime_error>([&] { const OutputFolder made(name); });
  };
  test::expect_line_with(message(path), "taken: cannot be written: Not a directory");
  test::expect_line_with(message(path + "/below"), "taken/below: cannot be written: Not a directory");
}

TEST(ReadFile, TellsWhyItCannot) {
  test::expect_line_with(test::error_of<std::runtime_error>([] { read_file("/nowhere"); }), "/nowhere: no such file");
  test::expect_line_with(test::error_of<std::runtime_error>([] { read_file("/tmp"); }), "/tmp: is a folder, expected a file");
}

}  // namespace
}  // namespace brink
