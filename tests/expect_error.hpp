#pragma once

#include <string>

#include <gtest/gtest.h>

namespace brink::test {

/// The message of the exception that `action` throws; "" and a failure when it throws none, or another one.
template <typename Exception, typename Action>
std::string error_of(Action action) {
  try {
    action();
  } catch (const Exception& error) {
    return error.what();
  }
  ADD_FAILURE() << "no exception was thrown";
  return "";
}

/// The message is one line and holds the part.
inline void expect_line_with(const std::string& message, const std::string& part) {
  EXPECT_NE(message.find(part), std::string::npos) << "\"" << message << "\" does not hold \"" << part << "\"";
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

}  // namespace brink::test
