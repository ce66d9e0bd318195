#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

/// A folder of the real data, or "" when BRINK_TEST_DATA is not set.
inline std::string test_data(const std::string& name) {
  const char* root = std::getenv("BRINK_TEST_DATA");
  if (root == nullptr || *root == '\0') return "";
  return (std::filesystem::path(root) / name).string();
}

/// Skips a test that needs real data when there is none, and says so.
// NOLINTBEGIN(bugprone-macro-parentheses): the first argument is the name of a new variable
#define BRINK_REQUIRE_DATA(variable, name)                    \
  const std::string variable = test_data(name);               \
  if (variable.empty() || !std::filesystem::exists(variable)) \
  GTEST_SKIP() << "real data not there: set BRINK_TEST_DATA to the folder that holds " << (name)
// NOLINTEND(bugprone-macro-parentheses)
