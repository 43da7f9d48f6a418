#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>

// GoogleTest runs a death test in a separate process, which a board does not have. Here the only death is a
// failed assert, which jumps back into the test, so that asserts are tested on the board, too.
namespace octoskin::target {

// Runs the statement and returns whether an assert in it failed with a message that matches the regular
// expression (GoogleTest's simple syntax). Objects between here and the assert are not destroyed: their
// memory is lost.
[[nodiscard]] testing::AssertionResult asserts(const std::function<void()>& statement,
                                               const std::string& message_regex);

}  // namespace octoskin::target

// The name is GoogleTest's, so that one source serves both.
#define EXPECT_DEATH(statement, message_regex) \
    EXPECT_TRUE(::octoskin::target::asserts([&] { statement; }, message_regex))
