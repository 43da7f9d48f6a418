#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>

// GoogleTest runs a death test in a process of its own, which a board has not. Here the only death is a
// failed assert, and a jump leads from it back into the test, so that asserts are tested on the board as
// well.
namespace octoskin::target {

// Runs the statement and says whether an assert in it failed whose message contains a match of the regular
// expression (GoogleTest's simple syntax). What lives between here and the assert is not destroyed: its
// memory is lost.
[[nodiscard]] testing::AssertionResult asserts(const std::function<void()>& statement,
                                               const std::string& message_regex);

}  // namespace octoskin::target

// The name is GoogleTest's, so that one source serves both.
#define EXPECT_DEATH(statement, message_regex) \
    EXPECT_TRUE(::octoskin::target::asserts([&] { statement; }, message_regex))
