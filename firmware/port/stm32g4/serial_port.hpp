// Sends lines of text on LPUART1, which the NUCLEO's debugger shows as a virtual serial port: 115200 baud, 8
// data bits, no parity. An interrupt sends; no call waits.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string_view>

namespace octoskin::stm32g4 {

/// LPUART1's divider for 115200 baud: 256 clocks per bit, rounded (RM0440 "LPUART baud rate generation").
[[nodiscard]] constexpr std::uint32_t lpuart_divider(std::uint32_t clock_hz) {
    constexpr std::uint32_t kBaud = 115'200;
    return static_cast<std::uint32_t>((std::uint64_t{256} * clock_hz + kBaud / 2) / kBaud);
}
static_assert(lpuart_divider(160'000'000) == 0x56CE4);

class SerialPort {
  public:
    void start(std::uint32_t clock_hz);

    /// Queues the line and its line end. False, and nothing queued, if there is no room. Call from the main
    /// loop only.
    bool say(std::string_view line);
    /// Whether all text has been sent, except for the last one or two characters.
    [[nodiscard]] bool is_quiet() const { return put_ == taken_; }
    /// Number of lines dropped for lack of room.
    [[nodiscard]] std::uint32_t lost_count() const { return lost_count_; }

    /// Call from the interrupt handler.
    void on_interrupt();

  private:
    static constexpr std::uint32_t kQueueBytes = 512;  // a power of two: the counters below wrap freely
    [[nodiscard]] std::uint32_t room() const { return kQueueBytes - (put_ - taken_); }
    void put(char character);

    std::array<char, kQueueBytes> queue_{};
    std::atomic<std::uint32_t> put_ = 0;    ///< characters put in since start; written by the main loop
    std::atomic<std::uint32_t> taken_ = 0;  ///< characters taken out; written by the interrupt
    std::uint32_t lost_count_ = 0;
};

}  // namespace octoskin::stm32g4
