#pragma once

#include <gtest/gtest.h>

#include <string>

#include "octurn/error.hpp"

namespace octurn {

/// Returns the Error that `action` throws; its message has to be one line. If nothing is thrown,
/// the test fails and the returned Error is of an unknown kind.
template <typename Action>
Error error_thrown_by(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return error;
  }
  ADD_FAILURE() << "nothing was thrown";
  return Error(ErrorCode::unknown, "nothing was thrown");
}

template <typename Action>
std::string code_thrown_by(const Action& action) {
  return std::string(to_string(error_thrown_by(action).code()));
}

}  // namespace octurn
