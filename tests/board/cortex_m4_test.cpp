// The core alone: exceptions, masks, sleep and faults, by programs compiled for it that tell what they saw.
#include "hw/sim/stm32g474/cpu/cortex_m4.hpp"

#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unicorn/unicorn.h>

#include <cstring>

#include "hw/image/elf_image.hpp"

namespace octoskin::sim::stm32 {
namespace {

using image::ElfImage;
using image::ElfSegment;
using testing::ElementsAre;

class CoreTest : public testing::Test, private MemoryMappedDevices {
  protected:
    explicit CoreTest(std::uint32_t cycles_per_instruction = 1)
        : core_(now_, log_,
                std::array{MemoryRegion{0x0800'0000, flash_, false}, MemoryRegion{0x2000'0000, ram_, true}},
                *this, cycles_per_instruction),
          control_(now_, log_,
                   {.hclk_hz = [] { return 16'000'000U; },
                    .cycles = [this] { return core_.cycles(); },
                    .request_reset = [this] { ++resets_; }}),
          image_(ElfImage::load(OCTOSKIN_TINY_PROGRAMS "/exceptions.elf").value()) {
        for (const ElfSegment& segment : image_.segments()) {
            std::memcpy(flash_.data() + (segment.physical_address - 0x0800'0000), segment.bytes.data(),
                        segment.bytes.size());
        }
        core_.attach(control_);
        core_.reset();
    }

    /// Runs a program to its end, at most a simulated second; jumps over idle time.
    void run(const std::string& program) {
        write(image_.address_of("is_finished").value(), 0);
        core_.jump(image_.address_of(program).value());
        while (now_.ps < kPsPerSecond && word(image_.address_of("is_finished").value()) != 1 &&
               core_.state() != CoreState::locked_up) {
            control_.advance();
            const BoardTime next = std::min(control_.next_event(), now_ + 10 * kPsPerUs);
            if (core_.is_idle()) {
                now_ = next;
            } else {
                core_.run(next);
            }
        }
    }
    [[nodiscard]] std::uint32_t word(std::uint32_t address) const {
        std::uint32_t value = 0;
        std::memcpy(&value, ram_.data() + (address - 0x2000'0000), sizeof value);
        return value;
    }
    void write(std::uint32_t address, std::uint32_t value) {
        std::memcpy(ram_.data() + (address - 0x2000'0000), &value, sizeof value);
    }
    [[nodiscard]] std::vector<std::uint32_t> results(std::uint32_t count) const {
        std::vector<std::uint32_t> all;
        const std::uint32_t first = image_.address_of("result").value();
        for (std::uint32_t i = 0; i < count; ++i) all.push_back(word(first + 4 * i));
        return all;
    }
    [[nodiscard]] bool is_finished() const { return word(image_.address_of("is_finished").value()) == 1; }

    std::uint32_t read(std::uint32_t address, std::uint32_t size) override {
        return control_.read(address, size);
    }
    void write(std::uint32_t address, std::uint32_t value, std::uint32_t size) override {
        control_.write(address, value, size);
        core_.shorten_slice(control_.next_event());
    }

    BoardTime now_;
    ViolationLog log_{now_};
    std::vector<std::uint8_t> flash_ = std::vector<std::uint8_t>(512 * 1024, 0xFF);
    std::vector<std::uint8_t> ram_ = std::vector<std::uint8_t>(128 * 1024, 0xA5);
    CortexM4 core_;
    SystemControl control_;
    ElfImage image_;
    int resets_ = 0;
};

// Without them everything is right and takes twice as long, which no other test would see.
TEST(Engine, calls_our_functions_for_a_store) {
    if (UC_API_MAJOR != 2 || UC_API_MINOR != 0) GTEST_SKIP() << "another Unicorn";
    Dl_info library{};
    ASSERT_NE(dladdr(dlsym(RTLD_DEFAULT, "uc_open"), &library), 0);
    for (const char* name :
         {"page_collection_lock_arm", "page_collection_unlock_arm", "tb_invalidate_phys_page_fast_arm"}) {
        Dl_info found{};
        ASSERT_NE(dladdr(dlsym(RTLD_DEFAULT, name), &found), 0) << name;
        EXPECT_STRNE(found.dli_fname, library.dli_fname) << name;
    }
}

TEST_F(CoreTest, higher_priority_preempts_and_equal_priority_waits) {
    run("nested");
    EXPECT_THAT(results(8), ElementsAre(0xA0, 0xB0, 0xB1, 0xC0, 0xA1, 0x11, 0, 0));
    EXPECT_EQ(log_.count(), 0U);
}

TEST_F(CoreTest, sub_priority_orders_but_does_not_preempt) {
    run("grouped");
    // B (group 0x40 as A's) waits for A; C (group 0) preempts B.
    EXPECT_THAT(results(8), ElementsAre(0xA0, 0xA1, 0xB0, 0xC0, 0xB1, 0x11, 0, 0));
    EXPECT_EQ(log_.count(), 0U);
}

TEST_F(CoreTest, floating_point_state_survives_nested_handlers_that_use_it) {
    run("floating");
    EXPECT_THAT(results(8), ElementsAre(0xA0, 0xB0, 0xB1, 0xA1, 0x3FC0'0000, 0x4020'0000, 0x40E0'0000, 1));
    EXPECT_EQ(log_.count(), 0U);
}

TEST_F(CoreTest, registers_flags_and_it_state_survive_interrupts_at_any_moment) {
    run("it_block");
    ASSERT_TRUE(is_finished());
    EXPECT_THAT(results(2), ElementsAre(0, 1));
    EXPECT_EQ(log_.count(), 0U);
}

TEST_F(CoreTest, primask_holds_back_until_cleared) {
    run("primask");
    EXPECT_THAT(results(5), ElementsAre(0x11, 0xA0, 0xA1, 0x12, 0));
}

TEST_F(CoreTest, basepri_holds_back_its_own_priority_and_below) {
    run("basepri");
    EXPECT_THAT(results(7), ElementsAre(0xB0, 0xB1, 0x11, 0xA0, 0xA1, 0x12, 0));
}

TEST_F(CoreTest, faultmask_holds_back_priority_zero) {
    run("faultmask");
    EXPECT_THAT(results(5), ElementsAre(0x11, 0xB0, 0xB1, 0x12, 0));
}

TEST_F(CoreTest, faultmask_ends_with_the_handler_that_set_it) {
    run("faultmask_in_handler");
    EXPECT_THAT(results(7), ElementsAre(0xA0, 0xA1, 0x11, 0xB0, 0xB1, 0x12, 0));
}

TEST_F(CoreTest, wfi_wakes_with_primask_set_without_entering_the_handler) {
    run("wfi_masked");
    EXPECT_THAT(results(4), ElementsAre(0, 1, 1, 0));
    EXPECT_GT(now_.ps, 999 * kPsPerUs) << "it slept for the 16,000 ticks of 62.5 ns";
}

TEST_F(CoreTest, sleeping_is_free_and_five_ticks_take_five_milliseconds) {
    run("wfi_plain");
    EXPECT_THAT(results(1), ElementsAre(5));
    EXPECT_NEAR(static_cast<double>(now_.ps), 5e9, 5e7) << "and the program before the first sleep";
    EXPECT_LT(core_.instructions(), 2000U);
}

TEST_F(CoreTest, calls_and_tail_chaining) {
    run("system_calls");
    EXPECT_THAT(results(7), ElementsAre(0x50, 0x11, 0xA0, 0xA1, 0xE0, 0x12, 0));
    EXPECT_EQ(log_.count(), 0U);
}

TEST_F(CoreTest, stack_pointer_returns_to_four_modulo_eight) {
    run("stack_alignment");
    EXPECT_THAT(results(4), ElementsAre(0xA0, 0xA1, 4, 1));
}

TEST_F(CoreTest, a_disabled_fault_becomes_a_hard_fault_with_its_cause) {
    run("fault_disabled");
    EXPECT_THAT(results(4), ElementsAre(0xF0, 1U << 30, 0x8200, 0x3000'0010));
    EXPECT_TRUE(log_.has(Rule::memory));
}

TEST_F(CoreTest, an_enabled_bus_fault_has_its_own_handler) {
    run("fault_enabled");
    EXPECT_THAT(results(3), ElementsAre(0xF5, 0x8200, 0x3000'0010));
}

TEST_F(CoreTest, calling_null_faults) {
    run("fault_null_call");
    EXPECT_THAT(results(3), ElementsAre(0xF0, 1U << 30, 0x100));
}

TEST_F(CoreTest, an_undefined_instruction_is_a_usage_fault) {
    run("fault_undefined");
    EXPECT_THAT(results(2), ElementsAre(0xF6, 1U << 16));
}

TEST_F(CoreTest, flash_is_not_written_by_a_store) {
    run("fault_flash_write");
    EXPECT_THAT(results(4), ElementsAre(0xF0, 1U << 30, 0x8200, 0x0800'0100));
}

// On the chip it would be: but no store is watched for what it does to instructions.
TEST_F(CoreTest, what_can_be_written_is_not_executed) {
    core_.jump(0x2000'0100);
    core_.run(now_ + 10 * kPsPerUs);
    EXPECT_TRUE(log_.has(Rule::memory));
}

TEST_F(CoreTest, a_stack_that_leaves_memory_ends_in_hard_fault) {
    run("stack_overflow");
    ASSERT_TRUE(is_finished());
    EXPECT_EQ(results(1)[0], 0xF0U);
    EXPECT_LT(core_.lowest_stack(), 0x2000'0100U);
}

TEST_F(CoreTest, floating_point_while_disabled_is_reported) {
    run("fpu_while_disabled");
    EXPECT_TRUE(log_.has(Rule::fpu_disabled));
}

TEST_F(CoreTest, a_fault_above_hard_fault_locks_up) {
    run("fault_in_hard_fault");
    EXPECT_EQ(core_.state(), CoreState::locked_up);
    EXPECT_FALSE(is_finished());
    EXPECT_TRUE(log_.has(Rule::exception_model));
}

TEST_F(CoreTest, instructions_are_counted_one_by_one) {
    run("count_cycles");
    EXPECT_NEAR(results(1)[0], 4e6, 20);
    EXPECT_NEAR(static_cast<double>(core_.instructions()), 4e6, 700);
}

class ThreeCyclesTest : public CoreTest {
  protected:
    ThreeCyclesTest() : CoreTest(3) {}
};

TEST_F(ThreeCyclesTest, cycles_are_instructions_times_the_factor) {
    run("count_cycles");
    EXPECT_NEAR(results(1)[0], 12e6, 60);
    EXPECT_NEAR(static_cast<double>(now_.ps), 12e6 * 62500, 62500.0 * 2100);
}

TEST_F(CoreTest, the_same_program_takes_the_same_time_to_the_picosecond) {
    run("it_block");
    const BoardTime first = now_;
    const std::uint64_t instructions = core_.instructions();
    now_ = {};
    control_.reset();
    core_.reset();
    run("it_block");
    EXPECT_EQ(now_, first);
    EXPECT_EQ(core_.instructions(), 2 * instructions);
}

}  // namespace
}  // namespace octoskin::sim::stm32
