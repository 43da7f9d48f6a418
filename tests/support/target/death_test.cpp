#include "tests/support/target/death_test.hpp"

#include <array>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>

namespace octoskin::target {
namespace {

struct ExpectedDeath {
    bool is_expected = false;
    std::jmp_buf way_back;
    std::array<char, 512> message;
};
ExpectedDeath expected_death;

}  // namespace

testing::AssertionResult asserts(const std::function<void()>& statement, const std::string& message_regex) {
    expected_death.is_expected = true;
    if (setjmp(expected_death.way_back) == 0) {
        statement();
        expected_death.is_expected = false;
        return testing::AssertionFailure() << "no assert failed";
    }
    const std::string message = expected_death.message.data();
    const testing::Matcher<const std::string&> is_right = testing::ContainsRegex(message_regex);
    if (is_right.Matches(message)) return testing::AssertionSuccess();
    return testing::AssertionFailure()
           << "expected an assert with '" << message_regex << "', got: " << message;
}

}  // namespace octoskin::target

// Replaces newlib's: assert() calls it.
extern "C" void __assert_func(const char* file, int line, const char* function, const char* condition) {
    auto& death = octoskin::target::expected_death;
    std::snprintf(death.message.data(), death.message.size(), "%s:%d: %s: assertion '%s' failed", file, line,
                  function, condition);
    if (death.is_expected) {
        death.is_expected = false;
        std::longjmp(death.way_back, 1);
    }
    std::printf("%s\n", death.message.data());
    std::abort();
}
