// The record that outlives a reset, and what it makes of the next run.
#include "firmware/core/run_record.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <random>

namespace octoskin::node {
namespace {

using wire::FaultKind;
using wire::ResetCause;

constexpr RunRules kRules{};

/// A board that only starts, lives and dies.
class Board {
  public:
    /// The run ends after `uptime_ms`; the next begins.
    RunStart reset(ResetCause cause, std::uint32_t uptime_ms) {
        RunRecord record = load(memory_);
        record.uptime_ms = uptime_ms;
        save(record, memory_);
        return begin(cause);
    }
    RunStart fault(FaultKind kind, std::uint32_t where, std::uint32_t uptime_ms) {
        RunRecord record = load(memory_);
        record.uptime_ms = uptime_ms;
        save(record, memory_);
        note_fault(memory_, kind, where);
        return begin(ResetCause::software);
    }
    RunStart begin(ResetCause cause) {
        const RunStart start = begin_run(load(memory_), cause, kRules);
        save(start.record, memory_);
        return start;
    }
    KeptMemory& memory() { return memory_; }

  private:
    KeptMemory memory_{};
};

TEST(RunRecord, survives_being_saved_and_loaded) {
    const RunRecord record{.fault = FaultKind::stack_guard,
                           .is_fault_new = true,
                           .is_starting = true,
                           .mode = RunMode::retry,
                           .retries = 5,
                           .resets = 0x12345678,
                           .where = 0x0801'2345,
                           .fault_uptime_ms = 0xFFFF'FFFF,
                           .uptime_ms = 77,
                           .ended_uptime_ms = {1, 2}};
    KeptMemory memory{};
    save(record, memory);
    EXPECT_EQ(load(memory), record);
}

constexpr std::size_t kCopyBits = 32 * KeptMemory::Copy{}.size();

TEST(RunRecord, holds_nothing_where_any_bit_of_both_copies_is_wrong) {
    KeptMemory memory{};
    save({.fault = FaultKind::assertion, .resets = 2, .where = 99}, memory);
    for (std::size_t bit = 0; bit < kCopyBits; ++bit) {
        KeptMemory damaged = memory;
        for (auto& copy : damaged.copies) copy[bit / 32] ^= 1U << (bit % 32);
        EXPECT_EQ(load(damaged), RunRecord{}) << bit;
    }
}

TEST(RunRecord, outlives_any_damage_to_one_copy) {
    const RunRecord record{.fault = FaultKind::assertion, .mode = RunMode::safe, .resets = 2, .where = 99};
    KeptMemory memory{};
    save(record, memory);
    for (std::size_t bit = 0; bit < 2 * kCopyBits; ++bit) {
        KeptMemory damaged = memory;
        damaged.copies[bit / kCopyBits][bit % kCopyBits / 32] ^= 1U << (bit % 32);
        EXPECT_EQ(load(damaged), record) << bit;
    }
}

// Word by word, in the order in which they are written: what is read is the old record or the new one.
TEST(RunRecord, is_the_old_or_the_new_one_wherever_a_reset_cuts_saving_short) {
    const RunRecord old{.resets = 1, .uptime_ms = 100};
    const RunRecord later{.fault = FaultKind::assertion, .mode = RunMode::safe, .resets = 2, .uptime_ms = 7};
    KeptMemory before{};
    KeptMemory after{};
    save(old, before);
    save(later, after);
    const std::size_t words = KeptMemory::Copy{}.size();
    for (std::size_t written = 0; written <= 2 * words; ++written) {
        KeptMemory cut = before;
        for (std::size_t i = 0; i < written; ++i) {
            cut.copies[i / words][i % words] = after.copies[i / words][i % words];
        }
        const RunRecord found = load(cut);
        EXPECT_TRUE(found == old || found == later) << written;
        EXPECT_EQ(found == later, written >= words) << written;
    }
}

TEST(RunRecord, holds_nothing_after_power_on_whatever_memory_may_hold) {
    std::mt19937 random(1);
    for (int i = 0; i < 10'000; ++i) {
        KeptMemory memory{};
        for (auto& copy : memory.copies) {
            for (auto& word : copy) word = static_cast<std::uint32_t>(random());
        }
        EXPECT_EQ(load(memory), RunRecord{});
    }
    for (const std::uint32_t pattern : {0U, 0xFFFF'FFFFU, 0xAAAA'AAAAU, 0x5555'5555U}) {
        KeptMemory memory{};
        for (auto& copy : memory.copies) copy.fill(pattern);
        EXPECT_EQ(load(memory), RunRecord{}) << pattern;
    }
}

TEST(RunRecord, forgets_an_earlier_life_at_power_on) {
    Board board;
    board.fault(FaultKind::hard_fault, 1, 100);
    const RunStart start = board.begin(ResetCause::power_on);
    EXPECT_EQ(start.record, RunRecord{});
    EXPECT_EQ(start.cause, ResetCause::power_on);
}

TEST(RunRecord, tells_a_recorded_fault_from_an_ordered_reset) {
    Board board;
    board.begin(ResetCause::power_on);
    const RunStart ordered = board.reset(ResetCause::software, 5'000);
    EXPECT_EQ(ordered.cause, ResetCause::software);
    EXPECT_EQ(ordered.record.fault, FaultKind::none);
    EXPECT_EQ(ordered.record.resets, 0U);

    const RunStart faulty = board.fault(FaultKind::assertion, 1234, 6'000);
    EXPECT_EQ(faulty.cause, ResetCause::fault);
    EXPECT_EQ(faulty.record.fault, FaultKind::assertion);
    EXPECT_EQ(faulty.record.where, 1234U);
    EXPECT_EQ(faulty.record.fault_uptime_ms, 6'000U);
    EXPECT_EQ(faulty.record.resets, 1U);
    EXPECT_FALSE(faulty.record.is_fault_new);
    EXPECT_EQ(faulty.record.uptime_ms, 0U);
}

TEST(RunRecord, keeps_the_first_fault_of_a_run) {
    KeptMemory memory{};
    note_fault(memory, FaultKind::stack_guard, 1);
    note_fault(memory, FaultKind::hard_fault, 2);
    EXPECT_EQ(load(memory).fault, FaultKind::stack_guard);
    EXPECT_EQ(load(memory).where, 1U);
}

TEST(RunRecord, names_a_reset_about_which_nobody_wrote_anything) {
    struct Case {
        ResetCause cause;
        FaultKind fault;
    };
    for (const Case& c :
         {Case{ResetCause::watchdog, FaultKind::watchdog}, Case{ResetCause::brown_out, FaultKind::brown_out},
          Case{ResetCause::unknown, FaultKind::unknown}}) {
        Board board;
        board.begin(ResetCause::power_on);
        const RunStart start = board.reset(c.cause, 300);
        EXPECT_EQ(start.record.fault, c.fault);
        EXPECT_EQ(start.record.fault_uptime_ms, 300U);
        EXPECT_EQ(start.cause, c.cause);
    }
}

TEST(RunRecord, goes_into_safe_mode_at_the_third_reset_within_ten_seconds_and_not_at_one_millisecond_more) {
    struct Case {
        std::uint32_t second_ms;
        std::uint32_t third_ms;
        RunMode mode;
    };
    for (const Case& c :
         {Case{0, 0, RunMode::safe}, Case{9'900, 100, RunMode::safe}, Case{5'000, 5'000, RunMode::safe},
          Case{5'000, 5'001, RunMode::normal}, Case{0xFFFF'FFFF, 1, RunMode::normal}}) {
        Board board;
        board.begin(ResetCause::power_on);
        // How long the run before the first reset had lasted does not matter.
        EXPECT_EQ(board.reset(ResetCause::watchdog, 4'000'000).record.mode, RunMode::normal);
        EXPECT_EQ(board.fault(FaultKind::assertion, 1, c.second_ms).record.mode, RunMode::normal);
        EXPECT_EQ(board.reset(ResetCause::watchdog, c.third_ms).record.mode, c.mode) << c.third_ms;
    }
}

TEST(RunRecord, counts_no_reset_that_somebody_ordered) {
    for (const ResetCause cause : {ResetCause::software, ResetCause::pin}) {
        Board board;
        board.begin(ResetCause::power_on);
        for (int i = 0; i < 10; ++i) EXPECT_EQ(board.reset(cause, 10).record.mode, RunMode::normal);
        board.reset(ResetCause::watchdog, 10);
        board.reset(ResetCause::watchdog, 10);
        board.reset(cause, 10);
        EXPECT_EQ(board.reset(ResetCause::watchdog, 10).record.mode, RunMode::normal);
    }
}

TEST(RunRecord, stays_in_safe_mode_over_resets_and_counts_the_retries_that_failed) {
    Board board;
    board.begin(ResetCause::power_on);
    for (int i = 0; i < 3; ++i) board.reset(ResetCause::watchdog, 100);
    EXPECT_EQ(load(board.memory()).mode, RunMode::safe);
    EXPECT_EQ(board.reset(ResetCause::watchdog, 4'000'000).record.mode, RunMode::safe);
    EXPECT_EQ(load(board.memory()).retries, 0);
    for (std::uint8_t failed = 1; failed < 10; ++failed) {
        RunRecord record = load(board.memory());
        record.mode = RunMode::retry;
        save(record, board.memory());
        const RunStart start = board.reset(ResetCause::watchdog, 50'000);
        EXPECT_EQ(start.record.mode, RunMode::safe);
        EXPECT_EQ(start.record.retries, failed);
    }
}

TEST(RunRecord, counts_a_run_that_ends_before_there_is_a_node_and_tells_when_to_keep_still) {
    KeptMemory memory{};
    EXPECT_FALSE(begin_start_up(memory, ResetCause::power_on, kRules).is_start_up_failing);
    for (std::uint32_t reset = 1; reset < 3; ++reset) {
        note_fault(memory, FaultKind::assertion, 5);
        const RunStart start = begin_start_up(memory, ResetCause::software, kRules);
        EXPECT_EQ(start.record.resets, reset);
        EXPECT_FALSE(start.is_start_up_failing);
    }
    for (std::uint8_t retries = 0; retries < 4; ++retries) {
        note_fault(memory, FaultKind::assertion, 5);
        RunStart start = begin_start_up(memory, ResetCause::software, kRules);
        EXPECT_TRUE(start.is_start_up_failing);
        EXPECT_EQ(start.record.retries, retries);
        retry_start_up(memory, start);
        EXPECT_EQ(load(memory).mode, RunMode::retry);
        EXPECT_TRUE(load(memory).is_starting);
    }
    KeptMemory of_bad_plug{};
    for (int i = 0; i < 6; ++i) {
        EXPECT_FALSE(begin_start_up(of_bad_plug, ResetCause::brown_out, kRules).is_start_up_failing)
            << "a supply that bounces is no program that fails";
    }
    EXPECT_EQ(load(of_bad_plug).mode, RunMode::safe);
    EXPECT_FALSE(begin_start_up(memory, ResetCause::pin, kRules).is_start_up_failing)
        << "somebody ordered it";
}

TEST(RunRecord, lets_a_node_in_safe_mode_start) {
    Board board;
    board.begin(ResetCause::power_on);
    for (int i = 0; i < 3; ++i) board.reset(ResetCause::watchdog, 100);
    const RunStart start = begin_start_up(board.memory(), ResetCause::watchdog, kRules);
    EXPECT_EQ(start.record.mode, RunMode::safe);
    EXPECT_FALSE(start.is_start_up_failing) << "there was a node each time: it can say so itself";
}

TEST(RunRecord, doubles_the_time_of_safe_mode_from_a_minute_to_an_hour) {
    const std::array<std::uint32_t, 9> expected = {60, 120, 240, 480, 960, 1'920, 3'600, 3'600, 3'600};
    for (std::uint8_t retries = 0; retries < expected.size(); ++retries) {
        EXPECT_EQ(safe_mode_s(retries), expected.at(retries));
    }
    EXPECT_EQ(safe_mode_s(255), 3'600U);
}

}  // namespace
}  // namespace octoskin::node
