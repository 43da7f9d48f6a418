// What is known of the last fault, in RAM that a reset leaves alone. A CRC tells it from what RAM happens to
// hold after power-on.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"

namespace octoskin::stm32g4 {

/// On the wire as InfoFault.kind; 0 is none.
enum class FaultKind : std::uint8_t {
    none = 0,
    hard_fault = 1,            ///< a fault of the core: CFSR says which
    stack_overflow = 2,        ///< the stack left its memory at the lower end
    assertion = 3,             ///< a programmer's mistake, found by the program itself
    unexpected_interrupt = 4,  ///< `where` is its number
    clock_lost = 5,            ///< the crystal failed while running
    pure_virtual_call = 6,
};

struct Fault {
    FaultKind kind = FaultKind::none;
    std::uint32_t where = 0;        ///< program counter; 0 if it is not known
    std::uint32_t called_from = 0;  ///< link register; 0 if it is not known
    std::uint32_t status = 0;       ///< CFSR
    std::uint32_t address = 0;      ///< that could not be reached; 0 if it is not known
    NodeTime uptime{};              ///< the node's clock at that time
};

/// Lives in memory that start-up does not touch. Its fields hold anything at all until checked.
class FaultRecord {
  public:
    /// The last fault, and how many there were since power-on; empty if the memory holds no valid record.
    struct Kept {
        Fault fault;
        std::uint32_t count = 0;
        bool is_new = false;  ///< not yet taken by `acknowledge`
    };
    [[nodiscard]] std::optional<Kept> read() const noexcept;

    /// Overwrites what was there; counts on if that was valid.
    void write(const Fault& fault) noexcept;
    /// Makes the record valid: without a fault if there was none, else no longer new.
    void acknowledge() noexcept;

  private:
    void seal() noexcept;
    [[nodiscard]] std::uint32_t checksum() const noexcept;

    // No initialisers: constructing it must leave the memory alone.
    std::uint32_t kind_;
    std::uint32_t where_;
    std::uint32_t called_from_;
    std::uint32_t status_;
    std::uint32_t address_;
    std::uint32_t uptime_us_;
    std::uint32_t count_;
    std::uint32_t is_new_;
    std::uint32_t crc_;
};

}  // namespace octoskin::stm32g4
