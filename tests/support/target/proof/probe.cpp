// Ends in every way a test program can end. Only the first two tests are meant to pass.
#include <gtest/gtest.h>

#include <array>
#include <cassert>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <vector>

namespace {

// The optimiser must not know the values, or it may remove the faults.
volatile std::uint32_t zero = 0;
volatile std::uint32_t sink = 0;
const std::uint32_t kConstant = 7;

// NOLINTNEXTLINE(misc-no-recursion): the stack is meant to overflow
std::uint32_t depth_of(std::uint32_t depth) {
    std::array<volatile std::uint32_t, 64> frame{};
    frame[depth % 64] = depth;
    if (zero != 0) return frame[0];
    return depth_of(depth + 1) + frame[depth % 64];
}

TEST(Probe, passes) {}

TEST(Probe, expects_an_assert_and_sees_it) {
    EXPECT_DEATH(assert(zero != 0), "zero != 0");
}

TEST(Probe, fails) {
    EXPECT_EQ(zero, 1U);
}
TEST(Probe, throws) {
    throw std::runtime_error("probe");
}
TEST(Probe, asserts) {
    assert(zero != 0);
}
TEST(Probe, aborts) {
    std::abort();
}
TEST(Probe, expects_an_assert_in_vain) {
    EXPECT_DEATH(assert(zero == 0), "zero");
}
TEST(Probe, expects_another_assert) {
    EXPECT_DEATH(assert(zero != 0), "one");
}
TEST(Probe, asserts_after_an_expected_assert) {
    EXPECT_DEATH(assert(zero != 0), "");
    assert(zero != 0);
}
TEST(Probe, reads_through_a_null_pointer) {
    sink = *reinterpret_cast<volatile std::uint32_t*>(zero + 8);
}
TEST(Probe, writes_to_a_constant) {
    const_cast<volatile std::uint32_t&>(kConstant) = zero;
}
TEST(Probe, divides_by_zero) {
    sink = 7 / zero;
}
TEST(Probe, overflows_the_stack) {
    sink = depth_of(0);
}
TEST(Probe, runs_out_of_memory) {
    const std::vector<std::uint32_t> more_than_there_is((zero + 32U) << 20U);
    sink = more_than_there_is.back();
}

}  // namespace
