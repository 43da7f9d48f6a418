// The flashed image hangs, overflows its stack or fails before it runs: instructions of its flash are
// replaced while it runs, or before it starts.
#include <gmock/gmock.h>

#include "tests/board/image_bench.hpp"

namespace octoskin::sim::stm32 {
namespace {

using testing::HasSubstr;

constexpr std::uint16_t kBranchToItself = 0xE7FE;
constexpr std::uint16_t kReturn = 0x4770;     // bx lr
constexpr std::uint16_t kUndefined = 0xDE00;  // udf
// push {r0-r7, lr}; b to it
const std::vector<std::uint16_t> kPushForEver = {0xB5FF, 0xE7FD};
constexpr std::uint32_t kErasedFlash = 0x0806'0000;

constexpr const char* kNodePoll = "_ZN8octoskin4node4Node4pollENS_8NodeTimeE";
constexpr const char* kTimerStart = "_ZN8octoskin7stm32g416MicrosecondTimer5startEm";
constexpr const char* kDecodeConfig = "_ZN8octoskin18decode_node_configESt4spanIKhLj4294967295EE";
constexpr std::uint32_t kTimer2Control = 0x4000'0000;
constexpr std::uint32_t kInterruptClearEnable = 0xE000'E180;  // NVIC_ICER0
constexpr std::uint32_t kTimer2Interrupt = 28;

/// After one second of good life something makes it hang: the watchdog ends that, and the next run says so.
class ImageHang : public testing::Test {
  protected:
    ImageHang() : bench_(block_of(bare_config())) { bench_.run(1.0); }
    void patch(const std::string& symbol, std::uint16_t instruction) {
        patched_ = bench_.place_of(symbol);
        before_ = bench_.board().patch(patched_, {instruction});
    }
    void expect_the_watchdog_and_its_name() {
        const double hung_s = bench_.now_s();
        bench_.forget();
        ASSERT_TRUE(bench_.run_until_reset(1.0));
        const double reset_s = bench_.now_s();
        EXPECT_LE(reset_s - hung_s, 0.2 + 0.001);
        bench_.silence_host(false);
        if (!before_.empty()) bench_.board().patch(patched_, before_);
        bench_.run(0.3);
        ASSERT_FALSE(bench_.heartbeats().empty());
        EXPECT_EQ(bench_.heartbeats().front().reset_cause, wire::ResetCause::watchdog);
        std::printf("bitten after %.0f ms, heard again %.1f ms later\n", 1e3 * (reset_s - hung_s),
                    1e3 * (*bench_.first_heartbeat_s() - reset_s));
        EXPECT_EQ(bench_.heartbeats().back().state, wire::NodeState::ranging);
        bench_.run(1.2);
        ASSERT_TRUE(bench_.fault());
        EXPECT_EQ(bench_.fault()->kind, wire::FaultKind::watchdog);
        EXPECT_EQ(bench_.board().reset_count(), 1U);
        EXPECT_EQ(bench_.violations(), "");
    }

    ImageBench bench_;
    std::uint32_t patched_ = 0;
    std::vector<std::uint16_t> before_;
};

TEST_F(ImageHang, in_the_loop) {
    patch(kNodePoll, kBranchToItself);
    expect_the_watchdog_and_its_name();
}

TEST_F(ImageHang, in_an_interrupt) {
    patch("timer_interrupt", kBranchToItself);
    expect_the_watchdog_and_its_name();
}

TEST_F(ImageHang, in_an_interrupt_that_comes_again_and_again) {
    patch("timer_interrupt", kReturn);
    expect_the_watchdog_and_its_name();
}

TEST_F(ImageHang, of_its_clock) {
    bench_.board().poke(kTimer2Control, 0);
    expect_the_watchdog_and_its_name();
}

// The loop sleeps until the timer wakes it, and nothing else comes.
TEST_F(ImageHang, of_a_missed_wake_up) {
    bench_.silence_host(true);
    bench_.board().poke(kInterruptClearEnable, 1U << kTimer2Interrupt);
    expect_the_watchdog_and_its_name();
}

TEST_F(ImageHang, silently) {
    patch(kNodePoll, kBranchToItself);
    bench_.run(0.002);
    bench_.forget();
    ASSERT_TRUE(bench_.run_until_reset(1.0));
    EXPECT_FALSE(bench_.first_s()) << "nothing goes out of a node that hangs";
}

// Before the node feeds it for the first time the watchdog has the same period already.
TEST(ImageStartUp, that_hangs_is_bitten_within_200_ms_too) {
    for (const std::uint32_t lsi_hz : {29'500U, 32'000U, 34'000U}) {
        NucleoOptions options;
        options.lsi_hz = lsi_hz;
        ImageBench bench(block_of(bare_config()), options);
        bench.board().patch(bench.place_of(kTimerStart), {kBranchToItself});
        ASSERT_TRUE(bench.run_until_reset(3.0));
        EXPECT_LE(bench.now_s(), 0.2) << lsi_hz;
    }
}

TEST(ImageStartUp, that_fails_again_and_again_ends_in_silence_and_begins_anew_after_a_minute) {
    ImageBench bench(block_of(bare_config()));
    const std::uint32_t place = bench.place_of(kDecodeConfig);
    const auto before = bench.board().patch(place, {kUndefined});
    bench.run(1.0);
    EXPECT_EQ(bench.board().reset_count(), 3U);
    EXPECT_FALSE(bench.first_s());
    EXPECT_TRUE(bench.board().is_led_lit());
    EXPECT_THAT(bench.board().serial_text(), HasSubstr("start-up failed too often: nothing for 60 s"));
    EXPECT_THAT(bench.board().serial_text(), HasSubstr("fault hard_fault at 0800"));
    bench.run(60.0);
    EXPECT_EQ(bench.board().reset_count(), 4U) << "one try";
    EXPECT_THAT(bench.board().serial_text(), HasSubstr("nothing for 120 s"));
    EXPECT_TRUE(bench.board().is_led_lit());
    bench.board().patch(place, before);
    bench.run(120.0);
    ASSERT_TRUE(bench.first_s());
    EXPECT_EQ(bench.heartbeats().front().reset_cause, wire::ResetCause::fault);
    ASSERT_TRUE(bench.fault());
    EXPECT_EQ(bench.fault()->kind, wire::FaultKind::hard_fault);
    EXPECT_NEAR(bench.fault()->where, place, 4.0);
    EXPECT_EQ(bench.fault()->count, 4);
    EXPECT_EQ(bench.heartbeats().back().state, wire::NodeState::ranging);
}

TEST(ImageStartUp, that_failed_often_is_tried_at_once_when_somebody_presses_reset) {
    ImageBench bench(block_of(bare_config()));
    const std::uint32_t place = bench.place_of(kDecodeConfig);
    const auto before = bench.board().patch(place, {kUndefined});
    bench.run(1.0);
    bench.board().patch(place, before);
    bench.board().press_reset();
    bench.run(0.3);
    EXPECT_TRUE(bench.first_s());
}

TEST(ImageStack, that_overflows_is_caught_and_named) {
    ImageBench bench(block_of(bare_config()));
    bench.run(1.0);
    bench.forget();
    bench.board().patch(kErasedFlash, kPushForEver);
    bench.board().jump(kErasedFlash);
    bench.run(1.5);
    EXPECT_EQ(bench.board().reset_count(), 1U);
    ASSERT_FALSE(bench.heartbeats().empty());
    EXPECT_EQ(bench.heartbeats().front().reset_cause, wire::ResetCause::fault);
    ASSERT_TRUE(bench.fault());
    EXPECT_EQ(bench.fault()->kind, wire::FaultKind::stack_guard);
    EXPECT_THAT(bench.board().serial_text(), HasSubstr("fault stack_guard"));
    EXPECT_THAT(bench.violations(), HasSubstr("write to 0x1FFF")) << "just below the stack, and nowhere else";
}

}  // namespace
}  // namespace octoskin::sim::stm32
