// The flashed image on a board without sensors, a host that says SYNC ten times a second, and what the node
// says: for tests of what it does when its board fails it.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/config/node_config.hpp"
#include "common/wire/codec.hpp"
#include "common/wire/frame_type.hpp"
#include "hw/sim/stm32g474/board_on_bus.hpp"
#include "hw/sim/stm32g474/nucleo_board.hpp"

namespace octoskin::sim::stm32 {

inline constexpr std::uint8_t kNode = 9;
inline constexpr std::uint8_t kNucleo = 1;  // hw/boards/nucleo_g474re.yaml

inline NodeConfig bare_config() {
    return {.node_id = kNode, .board_type = kNucleo};
}

inline std::vector<std::uint8_t> block_of(const NodeConfig& config) {
    std::array<std::uint8_t, kNodeConfigBytesMax> bytes{};
    const auto block = encode(config, bytes);
    return {block.begin(), block.end()};
}

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
            if (is_host_silent_ || now.us < next_sync_) return;
            next_sync_ = now.us + 100'000;
            (void)host_.send(wire::encode(wire::Sync{.sequence = 0}, wire::kHostId));
            (void)host_.send(
                {.can_id = 0x7C0, .is_fd = true, .has_bit_rate_switch = true, .payload_len = 12});
        });
        now_ = end;
    }
    /// Until the chip was reset once more, at most so long. Whether it was.
    bool run_until_reset(double seconds_max) {
        const std::uint32_t before = board_.reset_count();
        const double end_s = now_s() + seconds_max;
        while (board_.reset_count() == before && now_s() < end_s) run(0.0005);
        return board_.reset_count() > before;
    }
    /// Of a function of the image, by its linker's name.
    [[nodiscard]] std::uint32_t place_of(const std::string& symbol) {
        return board_.image().address_of(symbol).value() & ~1U;
    }
    void silence_host(bool is_silent) { is_host_silent_ = is_silent; }
    void forget() {
        heartbeats_.clear();
        fault_.reset();
        first_s_.reset();
        first_heartbeat_s_.reset();
    }

    [[nodiscard]] NucleoBoard& board() { return board_; }
    [[nodiscard]] double now_s() const { return static_cast<double>(now_.us) * 1e-6; }
    [[nodiscard]] const std::vector<wire::Heartbeat>& heartbeats() const { return heartbeats_; }
    [[nodiscard]] const std::optional<wire::InfoFault>& fault() const { return fault_; }
    /// When the node's first frame ended.
    [[nodiscard]] const std::optional<double>& first_s() const { return first_s_; }
    /// Since the last `forget`.
    [[nodiscard]] const std::optional<double>& first_heartbeat_s() const { return first_heartbeat_s_; }
    [[nodiscard]] std::uint8_t speaker() const { return speaker_; }
    [[nodiscard]] std::string violations() {
        std::string text;
        for (const auto& violation : board_.log().all()) text += violation.what + "\n";
        return text;
    }
    /// Rising edges of the light within its period of 2^21 us, or a part of it.
    int flashes(int for_ms = 2098) {
        int count = 0;
        bool was_lit = board_.is_led_lit();
        for (int i = 0; i < for_ms; ++i) {
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
        last_s_ = static_cast<double>(end.us) * 1e-6;
        if (!first_s_) first_s_ = last_s_;
        speaker_ = decoded->node_id;
        if (const auto* heartbeat = std::get_if<wire::Heartbeat>(&decoded->message)) {
            heartbeats_.push_back(*heartbeat);
            if (!first_heartbeat_s_) first_heartbeat_s_ = last_s_;
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
    bool is_host_silent_ = false;
    std::vector<wire::Heartbeat> heartbeats_;
    std::optional<wire::InfoFault> fault_;
    std::optional<double> first_s_;
    std::optional<double> last_s_;
    std::optional<double> first_heartbeat_s_;
    std::uint8_t speaker_ = 0;
};

}  // namespace octoskin::sim::stm32
