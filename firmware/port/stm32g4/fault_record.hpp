// The details of the last fault, for the serial port, in RAM that a reset does not clear. A CRC distinguishes
// them from random contents after power-on. The bus reports faults from the core's RunRecord.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "common/wire/messages.hpp"

namespace octoskin::stm32g4 {

struct Fault {
    wire::FaultKind kind = wire::FaultKind::none;
    std::uint32_t where = 0;        ///< program counter; 0 if unknown
    std::uint32_t called_from = 0;  ///< link register; 0 if unknown
    std::uint32_t status = 0;       ///< CFSR
    std::uint32_t address = 0;      ///< faulting address; 0 if unknown
    NodeTime uptime{};              ///< the node's clock at the fault
};

/// Placed in memory that start-up does not initialise. The fields are arbitrary until checked.
class FaultRecord {
  public:
    /// The last fault; kind `none` if there was none since power-on. Empty if the memory holds no valid
    /// record: RAM lost its contents.
    [[nodiscard]] std::optional<Fault> read() const noexcept;
    void write(const Fault& fault) noexcept;

  private:
    [[nodiscard]] std::uint32_t checksum() const noexcept;

    // No initialisers: construction must not change the memory.
    std::uint32_t kind_;
    std::uint32_t where_;
    std::uint32_t called_from_;
    std::uint32_t status_;
    std::uint32_t address_;
    std::uint32_t uptime_us_;
    std::uint32_t crc_;
};

}  // namespace octoskin::stm32g4
