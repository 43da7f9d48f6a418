// What the flashed image does when its board fails it: no sensors, one partner on the bus, one fault.
#include <gmock/gmock.h>

#include <array>
#include <string>
#include <variant>
#include <vector>

#include "common/config/node_config.hpp"
#include "common/wire/codec.hpp"
#include "common/wire/frame_type.hpp"
#include "hw/sim/stm32g474/board_on_bus.hpp"
#include "hw/sim/stm32g474/nucleo_board.hpp"

namespace octoskin::sim::stm32 {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr std::uint8_t kNode = 9;
constexpr std::uint8_t kNucleo = 1;  // hw/boards/nucleo_g474re.yaml

NodeConfig bare_config() {
    return {.node_id = kNode, .board_type = kNucleo};
}

std::vector<std::uint8_t> block_of(const NodeConfig& config) {
    std::array<std::uint8_t, kNodeConfigBytesMax> bytes{};
    const auto block = encode(config, bytes);
    return {block.begin(), block.end()};
}

/// The image on its board, a host that says SYNC ten times a second, and what the node says.
class ImageBench {
  public:
    explicit ImageBench(const std::vector<std::uint8_t>& block, const NucleoOptions& options = {})
        : board_(options, ElfImage::load(OCTOSKIN_FLASHED_IMAGE).value(), block),
          bus_(options.bit_rates),
          on_bus_(board_, bus_),
          host_(bus_.attach({}, 16)) {
        bus_.tap([this](const wire::CanFrame& frame, SimTime end) { note(frame, end); });
    }

    void run(double seconds) {
        const SimTime end{now_.us + static_cast<std::int64_t>(seconds * 1e6)};
        on_bus_.run_until(end, [this](SimTime now) {
            if (now.us < next_sync_) return;
            next_sync_ = now.us + 100'000;
            (void)host_.send(wire::encode(wire::Sync{.sequence = 0}, wire::kHostId));
            (void)host_.send(
                {.can_id = 0x7C0, .is_fd = true, .has_bit_rate_switch = true, .payload_len = 12});
        });
        now_ = end;
    }
    void forget() {
        heartbeats_.clear();
        fault_.reset();
        first_s_.reset();
    }

    [[nodiscard]] NucleoBoard& board() { return board_; }
    [[nodiscard]] double now_s() const { return static_cast<double>(now_.us) * 1e-6; }
    [[nodiscard]] const std::vector<wire::Heartbeat>& heartbeats() const { return heartbeats_; }
    [[nodiscard]] const std::optional<wire::InfoFault>& fault() const { return fault_; }
    /// When the node's first frame ended.
    [[nodiscard]] const std::optional<double>& first_s() const { return first_s_; }
    [[nodiscard]] std::uint8_t speaker() const { return speaker_; }
    [[nodiscard]] std::string violations() {
        std::string text;
        for (const auto& violation : board_.log().all()) text += violation.what + "\n";
        return text;
    }
    /// Rising edges of the light within its period of 2^20 us.
    int flashes() {
        int count = 0;
        bool was_lit = board_.is_led_lit();
        for (int i = 0; i < 1049; ++i) {
            run(0.001);
            count += !was_lit && board_.is_led_lit() ? 1 : 0;
            was_lit = board_.is_led_lit();
        }
        return count;
    }

  private:
    void note(const wire::CanFrame& frame, SimTime end) {
        const auto decoded = wire::decode(frame);
        if (!decoded || decoded->node_id == wire::kHostId) return;
        if (!first_s_) first_s_ = static_cast<double>(end.us) * 1e-6;
        speaker_ = decoded->node_id;
        if (const auto* heartbeat = std::get_if<wire::Heartbeat>(&decoded->message)) {
            heartbeats_.push_back(*heartbeat);
        } else if (const auto* info = std::get_if<wire::NodeInfo>(&decoded->message)) {
            if (const auto* fault = std::get_if<wire::InfoFault>(info)) fault_ = *fault;
        }
    }

    NucleoBoard board_;
    SimulatedCanBus bus_;
    BoardOnBus on_bus_;
    node::CanTransmitter& host_;
    SimTime now_{};
    std::int64_t next_sync_ = 0;
    std::vector<wire::Heartbeat> heartbeats_;
    std::optional<wire::InfoFault> fault_;
    std::optional<double> first_s_;
    std::uint8_t speaker_ = 0;
};

TEST(ImageFaults, starts_within_300_ms_and_sleeps_when_nothing_is_due) {
    ImageBench bench(block_of(bare_config()));
    bench.run(2.0);
    EXPECT_LT(*bench.first_s(), 0.3);
    EXPECT_NEAR(static_cast<double>(bench.heartbeats().size()), 20, 1);
    EXPECT_EQ(bench.heartbeats().back().state, wire::NodeState::ranging);
    EXPECT_EQ(bench.heartbeats().back().reset_cause, wire::ResetCause::power_on);
    EXPECT_LT(static_cast<double>(bench.board().core().cycles()), 0.02 * 160e6 * 2.0);
    EXPECT_EQ(bench.flashes(), 1);
    EXPECT_EQ(bench.violations(), "");
}

TEST(ImageFaults, tells_an_assertion_after_the_reset) {
    ImageBench bench(block_of(bare_config()));
    bench.run(0.5);
    bench.forget();
    bench.board().jump("abort");
    bench.run(1.5);
    ASSERT_FALSE(bench.heartbeats().empty());
    EXPECT_EQ(bench.heartbeats().front().reset_cause, wire::ResetCause::fault);
    ASSERT_TRUE(bench.fault());
    EXPECT_EQ(bench.fault()->kind, wire::FaultKind::assertion);
    EXPECT_EQ(bench.fault()->count, 1);
    EXPECT_THAT(bench.board().serial_text(), HasSubstr("reset fault"));
    EXPECT_THAT(bench.board().serial_text(), HasSubstr("fault assertion at 0800"));
    EXPECT_EQ(bench.board().reset_count(), 1U);
    EXPECT_EQ(bench.violations(), "");
}

TEST(ImageFaults, keeps_still_after_three_faults_in_ten_seconds) {
    ImageBench bench(block_of(bare_config()));
    for (int i = 0; i < 3; ++i) {
        bench.run(1.0);
        bench.board().jump("abort");
    }
    bench.forget();
    bench.run(1.0);
    ASSERT_FALSE(bench.heartbeats().empty());
    for (const auto& heartbeat : bench.heartbeats()) EXPECT_EQ(heartbeat.state, wire::NodeState::safe);
}

TEST(ImageFaults, tells_the_reset_button_from_power) {
    ImageBench bench(block_of(bare_config()));
    bench.run(0.3);
    bench.forget();
    bench.board().press_reset();
    bench.run(0.3);
    EXPECT_EQ(bench.heartbeats().back().reset_cause, wire::ResetCause::pin);
    bench.board().cycle_power();
    bench.run(0.3);
    EXPECT_EQ(bench.heartbeats().back().reset_cause, wire::ResetCause::power_on);
}

TEST(ImageFaults, is_silent_without_the_crystal_and_says_why) {
    NucleoOptions options;
    options.crystal.is_present = false;
    ImageBench bench(block_of(bare_config()), options);
    bench.run(2.0);
    EXPECT_FALSE(bench.first_s());
    EXPECT_THAT(bench.board().serial_text(), HasSubstr("without the crystal: CAN is silent"));
    EXPECT_EQ(bench.flashes(), 2);
    EXPECT_EQ(bench.violations(), "");
}

TEST(ImageFaults, falls_silent_when_the_crystal_dies) {
    NucleoOptions options;
    options.crystal.fails_at = BoardTime{1'000'000 * kPsPerUs};
    ImageBench bench(block_of(bare_config()), options);
    bench.run(1.0);
    ASSERT_FALSE(bench.heartbeats().empty());
    bench.run(0.001);
    bench.forget();
    bench.run(2.0);
    EXPECT_FALSE(bench.first_s());
    EXPECT_EQ(bench.board().reset_count(), 1U);
    EXPECT_THAT(bench.board().serial_text(), HasSubstr("fault clock_fault at 0800"));
    EXPECT_EQ(bench.violations(), "");
}

class UnconfiguredTest : public testing::TestWithParam<wire::BitRates> {};

TEST_P(UnconfiguredTest, finds_the_rates_by_listening_then_says_bad_config) {
    NucleoOptions options;
    options.bit_rates = GetParam();
    ImageBench bench({}, options);
    bench.run(1.4);
    EXPECT_FALSE(bench.first_s()) << "not before it has listened";
    bench.run(2.6);
    ASSERT_TRUE(bench.first_s());
    EXPECT_EQ(bench.speaker(), kUnconfiguredNodeId);
    for (const auto& heartbeat : bench.heartbeats()) EXPECT_EQ(heartbeat.state, wire::NodeState::bad_config);
    EXPECT_THAT(bench.board().serial_text(), HasSubstr("is missing"));
    EXPECT_EQ(bench.flashes(), 3);
    EXPECT_EQ(bench.violations(), "");
}
INSTANTIATE_TEST_SUITE_P(usual, UnconfiguredTest,
                         testing::Values(wire::BitRates{1'000'000, 5'000'000},
                                         wire::BitRates{500'000, 2'000'000},
                                         wire::BitRates{125'000, 500'000}));

TEST(ImageFaults, stays_silent_on_a_bus_of_unknown_rates) {
    NucleoOptions options;
    options.bit_rates = {800'000, 4'000'000};
    ImageBench bench({}, options);
    bench.run(10.0);
    EXPECT_FALSE(bench.first_s());
    EXPECT_EQ(bench.violations(), "");
}

TEST(ImageFaults, does_not_use_a_block_with_a_flipped_bit) {
    std::vector<std::uint8_t> block = block_of(bare_config());
    block[10] = static_cast<std::uint8_t>(block[10] ^ 0x20U);
    ImageBench bench(block);
    bench.run(2.0);
    EXPECT_THAT(bench.board().serial_text(), HasSubstr("is damaged"));
    EXPECT_EQ(bench.speaker(), kUnconfiguredNodeId);
}

TEST(ImageFaults, refuses_another_boards_block_under_its_own_id) {
    NodeConfig config = bare_config();
    config.board_type = 2;
    ImageBench bench(block_of(config));
    bench.run(0.5);
    EXPECT_EQ(bench.speaker(), kNode);
    EXPECT_EQ(bench.heartbeats().back().state, wire::NodeState::bad_config);
    EXPECT_THAT(bench.board().serial_text(), HasSubstr("board type 2, is not for this board"));
}

TEST(ImageFaults, comes_back_from_bus_off_within_a_second) {
    ImageBench bench(block_of(bare_config()));
    bench.run(0.5);
    bench.board().can().set_link(CanLink::broken);
    bench.run(5.0);
    EXPECT_TRUE(bench.board().can().is_bus_off());
    EXPECT_THAT(bench.board().serial_text(), HasSubstr("CAN bus-off, 6 since start"));
    bench.forget();
    bench.board().can().set_link(CanLink::good);
    const double mended_s = bench.now_s();
    bench.run(3.0);
    ASSERT_TRUE(bench.first_s());
    EXPECT_LT(*bench.first_s() - mended_s, 1.0);
    EXPECT_EQ(bench.heartbeats().back().state, wire::NodeState::ranging);
    EXPECT_EQ(bench.board().reset_count(), 0U);
}

TEST(ImageFaults, takes_back_what_nobody_acknowledges_and_goes_on) {
    ImageBench bench(block_of(bare_config()));
    bench.board().can().set_link(CanLink::nobody_acknowledges);
    bench.run(12.0);
    EXPECT_THAT(bench.board().serial_text(), HasSubstr("frames not acknowledged"));
    EXPECT_THAT(bench.board().serial_text(), Not(HasSubstr("bus-off")));
    bench.board().can().set_link(CanLink::good);
    bench.run(2.0);
    EXPECT_EQ(bench.heartbeats().back().state, wire::NodeState::ranging);
    EXPECT_EQ(bench.violations(), "");
}

}  // namespace
}  // namespace octoskin::sim::stm32
