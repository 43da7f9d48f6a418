// What counts as a difference, and when a register counts no more. The registers are written down here again:
// those that steer the range, then all the others that the driver writes.
#include "firmware/drivers/vl53l1x/read_back.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <vector>

namespace octoskin::vl53l1x {
namespace {

std::set<reg::Index> interval(reg::Index first, reg::Index last) {
    std::set<reg::Index> indices;
    for (reg::Index index = first; index <= last; ++index) indices.insert(index);
    return indices;
}
std::set<reg::Index> registers_of(std::size_t first_run, std::size_t last_run) {
    std::set<reg::Index> indices;
    for (std::size_t i = first_run; i <= last_run; ++i) {
        const RegisterRun& run = kRegisterRuns[i];
        indices.merge(interval(run.first, static_cast<reg::Index>(run.first + run.count - 1)));
    }
    return indices;
}
bool contains_all(const std::set<reg::Index>& all, const std::set<reg::Index>& wanted) {
    return std::includes(all.begin(), all.end(), wanted.begin(), wanted.end());
}

TEST(RegisterRuns, first_three_hold_all_that_steers_the_range) {
    const auto steering = registers_of(0, kSteeringGroups - 1);
    EXPECT_TRUE(contains_all(steering, interval(0x1E, 0x23)));
    EXPECT_TRUE(contains_all(steering, interval(0x5E, 0x63)));
    EXPECT_TRUE(contains_all(steering, {0x69}));
    EXPECT_TRUE(contains_all(steering, interval(0x6C, 0x6F)))
        << "the period: a reading's time follows from it";
    EXPECT_TRUE(contains_all(steering, interval(0x78, 0x7B)));
    EXPECT_TRUE(contains_all(steering, {0x7F, 0x80}));
}

TEST(RegisterRuns, hold_all_that_the_driver_writes_but_the_pins_and_the_orders) {
    const auto all = registers_of(0, kRegisterRuns.size() - 1);
    auto configuration = interval(0x2D, 0x87);
    for (const reg::Index index : std::set<reg::Index>{0x31, 0x32, 0x86, 0x87}) {
        configuration.erase(index);
        EXPECT_FALSE(all.contains(index));
    }
    EXPECT_TRUE(contains_all(all, configuration));
    EXPECT_TRUE(contains_all(all, {0x08, 0x0B, 0x16, 0x17, 0x18, 0x19, 0x1A, 0x1B}));
    EXPECT_EQ(all.size(), kRegistersReadBack) << "none twice";
}

/// Registers as a sensor holds them, and the driver's idea of them.
class Registers : public testing::Test {
  protected:
    Registers() {
        for (std::size_t i = 0; i < registers_.size(); ++i)
            registers_[i] = static_cast<std::uint8_t>(i * 37 + 11);
        read_back_.note(0, registers_);
    }
    [[nodiscard]] std::vector<std::uint8_t> bytes(const RegisterRun& run) const {
        return {registers_.begin() + run.first, registers_.begin() + run.first + run.count};
    }
    [[nodiscard]] bool all_agree() const {
        return std::all_of(kRegisterRuns.begin(), kRegisterRuns.end(),
                           [this](const RegisterRun& run) { return read_back_.agrees(run, bytes(run)); });
    }
    /// Reads all back once; returns whether a difference counts.
    bool record_all() {
        bool counts = false;
        for (const RegisterRun& run : kRegisterRuns) counts |= read_back_.record(run, bytes(run));
        return counts;
    }

    std::array<std::uint8_t, 0x90> registers_{};
    ReadBack read_back_;
};

TEST_F(Registers, every_bit_counts_but_those_that_are_not_the_drivers) {
    const std::map<reg::Index, unsigned> counted{{0x0B, 0x80}, {0x2E, 0x01}, {0x2F, 0x03}, {0x30, 0x1F}};
    const auto all = registers_of(0, kRegisterRuns.size() - 1);
    EXPECT_TRUE(all_agree());
    for (reg::Index index = 0; index < registers_.size(); ++index) {
        for (unsigned bit = 1; bit <= 0x80; bit <<= 1U) {
            const bool is_masked = counted.contains(index) && (counted.at(index) & bit) == 0;
            registers_[index] = static_cast<std::uint8_t>(registers_[index] ^ bit);
            EXPECT_EQ(all_agree(), !all.contains(index) || is_masked) << index << ' ' << bit;
            registers_[index] = static_cast<std::uint8_t>(registers_[index] ^ bit);
        }
    }
}

TEST_F(Registers, what_was_never_written_is_learnt_and_what_was_is_not) {
    read_back_.forget();
    registers_[0x1E] = 1;
    EXPECT_TRUE(all_agree()) << "nothing is known";
    EXPECT_FALSE(record_all());
    EXPECT_EQ(read_back_.last_difference(), std::nullopt);
    read_back_.note(0x20, std::vector<std::uint8_t>{7});
    registers_[0x20] = 8;
    read_back_.learn(kRegisterRuns[0], bytes(kRegisterRuns[0]));
    EXPECT_FALSE(all_agree()) << "written 7, found 8";
    registers_[0x20] = 7;
    EXPECT_TRUE(all_agree());
    registers_[0x1E] = 2;
    EXPECT_FALSE(all_agree()) << "learnt as 1";
}

TEST_F(Registers, difference_is_named) {
    EXPECT_EQ(read_back_.last_difference(), std::nullopt);
    EXPECT_FALSE(record_all());
    registers_[0x69] = 0xB9;
    EXPECT_TRUE(record_all());
    const RegisterDifference expected{
        .index = 0x69, .expected = static_cast<std::uint8_t>(0x69 * 37 + 11), .found = 0xB9};
    EXPECT_EQ(read_back_.last_difference(), expected);
    EXPECT_EQ(read_back_.exempt_count(), 0);
}

TEST_F(Registers, third_time_the_same_exempts_the_register_alone) {
    registers_[0x4E] ^= 0x10U;
    EXPECT_TRUE(record_all());
    EXPECT_TRUE(record_all());
    EXPECT_FALSE(record_all()) << "this part is like that";
    EXPECT_EQ(read_back_.exempt_count(), 1);
    EXPECT_EQ(read_back_.fixed_register()->index, 0x4E);
    EXPECT_FALSE(read_back_.is_distrusted());
    registers_[0x4E] ^= 0x03U;
    EXPECT_FALSE(record_all()) << "it counts no more, whatever it reads";
    EXPECT_TRUE(all_agree());
    registers_[0x4F] ^= 0x03U;
    EXPECT_TRUE(record_all());
    read_back_.forget();
    read_back_.note(0x4E, std::vector<std::uint8_t>{0});
    EXPECT_TRUE(all_agree()) << "exempt for good";
}

TEST_F(Registers, another_value_is_another_difference) {
    const std::uint8_t clean = registers_[0x50];
    for (int i = 0; i < 9; ++i) {
        registers_[0x50] = static_cast<std::uint8_t>(clean + 1 + i % 3);
        EXPECT_TRUE(record_all()) << i;
    }
}

// Offset; time-outs, VCSEL periods, limits, valid phase, period; windows, phases, region of interest,
// sequence; crosstalk; pulse, least range, phase calibration, how SPADs are chosen, fraction, quadrants.
TEST_F(Registers, one_that_decides_the_range_is_never_exempt_but_makes_the_part_distrusted) {
    auto deciding = interval(0x1E, 0x23);
    for (const auto& more : {interval(0x5E, 0x6F), interval(0x78, 0x85), interval(0x16, 0x1B)})
        deciding.insert(more.begin(), more.end());
    deciding.insert({0x34, 0x3F, 0x47, 0x4A, 0x4B, 0x4F, 0x70, 0x76});
    for (reg::Index index = 0; index < 0x200; ++index)
        EXPECT_EQ(decides_range(index), deciding.contains(index)) << index;
    for (const reg::Index index : registers_of(0, kRegisterRuns.size() - 1)) {
        ReadBack read_back;
        read_back.note(0, registers_);
        auto changed = registers_;
        changed[index] ^= 0x81U;
        const auto record_all_of = [&] {
            bool counts = false;
            for (const RegisterRun& run : kRegisterRuns)
                counts |= read_back.record(run, std::span(changed).subspan(run.first, run.count));
            return counts;
        };
        EXPECT_TRUE(record_all_of()) << index;
        EXPECT_TRUE(record_all_of()) << index;
        EXPECT_FALSE(read_back.is_distrusted()) << index << ": it may have been an accident";
        EXPECT_EQ(read_back.fixed_register(), std::nullopt) << index;
        EXPECT_EQ(record_all_of(), deciding.contains(index)) << index;
        EXPECT_EQ(read_back.is_distrusted(), deciding.contains(index)) << index;
        EXPECT_EQ(read_back.exempt_count(), deciding.contains(index) ? 0 : 1) << index;
        ASSERT_TRUE(read_back.fixed_register().has_value()) << index;
        EXPECT_EQ(read_back.fixed_register()->index, index);
        for (int i = 0; i < 20; ++i) EXPECT_EQ(record_all_of(), deciding.contains(index)) << index;
    }
}

TEST_F(Registers, a_distrusted_part_is_trusted_again_after_a_hundred_clean_checks_in_a_row) {
    registers_[0x7F] ^= 0x01U;
    for (int i = 0; i < 3; ++i) EXPECT_TRUE(record_all());
    for (int i = 0; i < 99; ++i) read_back_.on_clean_check();
    read_back_.forget();
    EXPECT_TRUE(read_back_.is_distrusted());
    read_back_.note(0, registers_);
    registers_[0x7E] ^= 0x01U;
    EXPECT_TRUE(record_all()) << "another one";
    EXPECT_EQ(read_back_.fixed_register()->index, 0x7F) << "the one that was seen thrice";
    for (int i = 0; i < 99; ++i) read_back_.on_clean_check();
    EXPECT_TRUE(read_back_.is_distrusted());
    read_back_.on_clean_check();
    EXPECT_FALSE(read_back_.is_distrusted());
    EXPECT_EQ(read_back_.fixed_register(), std::nullopt);
}

TEST_F(Registers, a_part_that_needs_more_than_eight_exempted_is_broken) {
    for (reg::Index index = 0x35; index < 0x35 + 9; ++index) registers_[index] ^= 0x40U;
    for (int i = 0; i < 40; ++i) EXPECT_TRUE(record_all()) << i;
    EXPECT_EQ(read_back_.exempt_count(), 8);
    registers_[0x35 + 8] ^= 0x40U;
    EXPECT_FALSE(record_all());
}

TEST_F(Registers, accidents_are_forgotten_after_a_hundred_clean_checks_in_a_row) {
    const auto sight_then_check = [this](int clean_checks) {
        registers_[0x78] ^= 0x04U;
        const bool counts = record_all();
        registers_[0x78] ^= 0x04U;
        for (int i = 0; i < clean_checks; ++i) read_back_.on_clean_check();
        return counts;
    };
    for (int i = 0; i < 10; ++i) EXPECT_TRUE(sight_then_check(100)) << i;
    EXPECT_TRUE(sight_then_check(99));
    EXPECT_TRUE(sight_then_check(99));
    EXPECT_FALSE(read_back_.is_distrusted());
    EXPECT_TRUE(sight_then_check(99));
    EXPECT_TRUE(read_back_.is_distrusted()) << "99 are not enough, however often";
}

}  // namespace
}  // namespace octoskin::vl53l1x
