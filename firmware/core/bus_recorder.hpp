// An I2C bus that records the last transfers, so that a fault in the field can be examined byte by byte. It
// lies between the sensors and the port's bus. It also detects overdue transfers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "common/time.hpp"
#include "common/wire/black_box.hpp"
#include "firmware/drivers/i2c/i2c_bus.hpp"

namespace octoskin::node {

inline constexpr std::size_t kRecordedTransfersMax = 64;
/// Transfers with their headers. A reading of one sensor takes about 120 bytes, a bring-up 700.
inline constexpr std::size_t kRecordedBytesMax = 1'536;

class BusRecorder final : public i2c::Bus {
  public:
    /// `bus` must outlive the recorder.
    explicit BusRecorder(i2c::Bus& bus) noexcept : bus_(bus) {}

    // --- the bus; each call is passed on, recording costs O(bytes of the transfer)
    [[nodiscard]] bool is_busy() const override { return bus_.is_busy(); }
    void submit(const i2c::Transfer& transfer, NodeTime now, NodeTime deadline) override;
    [[nodiscard]] i2c::TransferState poll(NodeTime now) override;
    [[nodiscard]] i2c::TransferError error() const override { return bus_.error(); }
    bool recover() override;

    /// Whether the transfer in flight should have ended long ago and `recover` could not end it: a defect of
    /// the port.
    [[nodiscard]] bool is_overdue(NodeTime now) const noexcept;

    // --- the record
    /// Stops recording, so that the record can be read piece by piece; transfers continue.
    void freeze(NodeTime now) noexcept;
    [[nodiscard]] bool is_frozen() const noexcept { return is_frozen_; }
    void thaw() noexcept { is_frozen_ = false; }
    /// Bytes of the dump with its header; only while frozen.
    [[nodiscard]] std::size_t dump_size() const noexcept { return wire::kDumpHeaderBytes + used_; }
    /// Byte number `at` < `dump_size()` of the dump; only while frozen.
    [[nodiscard]] std::uint8_t dump_byte(std::size_t at) const noexcept;

  private:
    struct InFlight {
        i2c::Transfer transfer;
        NodeTime start;
        NodeTime deadline;
    };

    void record(const InFlight& ended, wire::TransferOutcome outcome) noexcept;
    void make_room(std::size_t bytes) noexcept;
    void drop_oldest() noexcept;
    void append(std::span<const std::uint8_t> bytes) noexcept;
    [[nodiscard]] std::uint8_t at(std::size_t offset) const noexcept;

    i2c::Bus& bus_;
    std::optional<InFlight> in_flight_;
    std::array<std::uint8_t, kRecordedBytesMax> ring_{};
    std::size_t first_ = 0;  ///< position of the oldest transfer
    std::size_t used_ = 0;
    std::size_t transfers_ = 0;
    bool is_frozen_ = false;
    std::array<std::uint8_t, wire::kDumpHeaderBytes> header_{};
};

}  // namespace octoskin::node
