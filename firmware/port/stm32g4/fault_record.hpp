// The details of the last fault, for the serial port, in RAM that a reset leaves alone. A CRC tells them from
// what RAM happens to hold after power-on. What the bus is told of a fault is the core's RunRecord.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "common/wire/messages.hpp"

namespace octoskin::stm32g4 {

struct Fault {
    wire::FaultKind kind = wire::FaultKind::none;
    std::uint32_t where = 0;        ///< program counter; 0 if it is not known
    std::uint32_t called_from = 0;  ///< link register; 0 if it is not known
    std::uint32_t status = 0;       ///< CFSR
    std::uint32_t address = 0;      ///< that could not be reached; 0 if it is not known
    NodeTime uptime{};              ///< the node's clock at that time
};

/// Lives in memory that start-up does not touch. Its fields hold anything at all until checked.
class FaultRecord {
  public:
    /// The last fault, of kind `none` if there was none since power-on. Empty if the memory holds no valid
    /// record: RAM lost its contents.
    [[nodiscard]] std::optional<Fault> read() const noexcept;
    void write(const Fault& fault) noexcept;

  private:
    [[nodiscard]] std::uint32_t checksum() const noexcept;

    // No initialisers: constructing it must leave the memory alone.
    std::uint32_t kind_;
    std::uint32_t where_;
    std::uint32_t called_from_;
    std::uint32_t status_;
    std::uint32_t address_;
    std::uint32_t uptime_us_;
    std::uint32_t crc_;
};

}  // namespace octoskin::stm32g4
