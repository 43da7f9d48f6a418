// The message RAM of FDCAN1 (RM0440 44.3.3): words only.
#pragma once

#include <array>
#include <cstdint>

#include "common/wire/can_frame.hpp"
#include "hw/sim/stm32g474/peripheral.hpp"

namespace octoskin::sim::stm32 {

class FdcanRam final : public Peripheral {
  public:
    static constexpr std::uint32_t kFifoElements = 3;

    explicit FdcanRam(const Surroundings& surroundings) : env_(surroundings) {}

    [[nodiscard]] std::string_view name() const override { return "SRAMCAN"; }
    [[nodiscard]] std::uint32_t read(std::uint32_t offset) override;
    void write(std::uint32_t offset, std::uint32_t value) override;
    /// RAM: a reset leaves it.
    void reset() override {}

    [[nodiscard]] std::uint32_t standard_filter(std::uint32_t index) const { return words_.at(index); }
    [[nodiscard]] std::uint64_t extended_filter(std::uint32_t index) const;
    struct TxElement {
        wire::CanFrame frame;
        std::uint8_t marker = 0;
        bool stores_event = false;
    };
    [[nodiscard]] TxElement tx_element(std::uint32_t index) const;
    /// `fifo`: 0 or 1. `filter`: the index that matched, or none.
    void store_rx(std::uint32_t fifo, std::uint32_t index, const wire::CanFrame& frame,
                  std::uint16_t timestamp, int filter);
    void store_event(std::uint32_t index, const TxElement& sent, std::uint16_t timestamp);

  private:
    Surroundings env_;
    std::array<std::uint32_t, 3 * 0x350 / 4> words_{};  ///< of all three controllers; the first is ours
};

}  // namespace octoskin::sim::stm32
