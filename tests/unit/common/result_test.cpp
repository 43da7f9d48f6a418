#include "common/result.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <string>

namespace octoskin {
namespace {

enum class Fault { broken, lost };

Result<int, Fault> half_of(int number) {
    if (number % 2 != 0) {
        return unexpected(Fault::broken);
    }
    return number / 2;
}

TEST(Result, holds_the_value) {
    const auto result = half_of(6);
    EXPECT_TRUE(result.has_value());
    EXPECT_TRUE(result);
    EXPECT_EQ(*result, 3);
    EXPECT_EQ(result.value(), 3);
}

TEST(Result, holds_the_error) {
    const auto result = half_of(7);
    EXPECT_FALSE(result.has_value());
    EXPECT_FALSE(result);
    EXPECT_EQ(result.error(), Fault::broken);
}

TEST(Result, tells_value_from_error_of_the_same_type) {
    const Result<int, int> good = 1;
    const Result<int, int> bad = unexpected(1);
    EXPECT_TRUE(good);
    EXPECT_FALSE(bad);
}

TEST(Result, gives_access_to_members_and_lets_them_change) {
    Result<std::string, Fault> result = std::string("ab");
    result->push_back('c');
    *result += "d";
    result.value() += "e";
    const auto& constant = result;
    EXPECT_EQ(constant->size(), 5U);
    EXPECT_EQ(*constant, "abcde");
}

TEST(Result, moves_a_value_that_cannot_be_copied) {
    Result<std::unique_ptr<int>, Fault> result = std::make_unique<int>(5);
    const std::unique_ptr<int> taken = *std::move(result);
    EXPECT_EQ(*taken, 5);
    Result<std::unique_ptr<int>, Fault> other = std::make_unique<int>(6);
    EXPECT_EQ(*std::move(other).value(), 6);
}

TEST(Result, of_nothing_is_done_or_an_error) {
    const Status<Fault> done = Done{};
    const Status<Fault> failed = unexpected(Fault::lost);
    EXPECT_TRUE(done);
    EXPECT_EQ(failed.error(), Fault::lost);
}

TEST(Result, works_at_compile_time) {
    constexpr Result<int, Fault> kGood = 4;
    constexpr Result<int, Fault> kBad = unexpected(Fault::lost);
    static_assert(*kGood == 4);
    static_assert(kBad.error() == Fault::lost);
}

TEST(ResultDeathTest, asserts_when_asked_for_what_is_not_there) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    Result<int, Fault> bad = half_of(1);
    const auto& constant = bad;
    EXPECT_DEATH(static_cast<void>(*constant), "has_value");
    EXPECT_DEATH(static_cast<void>(bad.value()), "has_value");
    EXPECT_DEATH(static_cast<void>(std::move(bad).value()), "has_value");
    EXPECT_DEATH(static_cast<void>(half_of(2).error()), "has_value");
}

}  // namespace
}  // namespace octoskin
