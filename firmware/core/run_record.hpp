// What survives a reset: why the last run ended, how long the runs lasted, and whether the node is in safe
// mode. A node that resets three times in 10 s without a command goes into safe mode: it sends its heartbeat
// and touches no I2C bus. After a minute it tries once more, then after two, four, up to an hour; a command
// ends safe mode at once.
#pragma once

#include <array>
#include <cstdint>

#include "common/wire/messages.hpp"

namespace octoskin::node {

/// Memory that no start-up code clears: a port places it with its linker script and passes it in
/// `Ports::kept`. Its content after power-on is arbitrary; a CRC detects that. There are two copies, written
/// one after the other: a reset in the middle of one leaves the other intact. The type is trivial, since a
/// constructor would clear it.
struct KeptMemory {
    using Copy = std::array<std::uint32_t, 9>;
    std::array<Copy, 2> copies;
};

enum class RunMode : std::uint8_t {
    normal,
    safe,   ///< heartbeat only
    retry,  ///< as normal, but the next unexpected reset leads back to safe mode
};

struct RunRecord {
    wire::FaultKind fault = wire::FaultKind::none;  ///< the last one
    bool is_fault_new = false;                      ///< recorded in this run, which is about to end
    bool is_starting = false;  ///< there is no node yet: what fails now would also fail in safe mode
    RunMode mode = RunMode::normal;
    std::uint8_t retries = 0;           ///< failed attempts after safe mode
    std::uint32_t resets = 0;           ///< unexpected ones since the last ordered one
    std::uint32_t where = 0;            ///< of the last fault: program counter, or by kind
    std::uint32_t fault_uptime_ms = 0;  ///< length of the run that it ended
    std::uint32_t uptime_ms = 0;        ///< length of this run, as last recorded
    /// The last two consecutive runs that ended unexpectedly, the newest first.
    std::array<std::uint32_t, 2> ended_uptime_ms{};
    friend constexpr bool operator==(const RunRecord&, const RunRecord&) = default;
};

struct RunRules {
    std::uint32_t resets_until_safe = 3;
    std::uint32_t resets_within_ms = 10'000;
};

/// The content of `memory`; the record of a first run if it was never written, or if both copies are damaged.
[[nodiscard]] RunRecord load(const KeptMemory& memory) noexcept;
void save(const RunRecord& record, KeptMemory& memory) noexcept;

/// For the fault handlers and the assertion handler: records what ends this run; the caller then resets. From
/// any context; about 100 bytes of stack and 30 us on a Cortex-M4. Only the first fault of a run counts:
/// later ones are its consequences.
void note_fault(KeptMemory& memory, wire::FaultKind fault, std::uint32_t where) noexcept;

/// How a new run begins, after a judgement of how the last one ended. `hardware`: the content of the reset
/// register. Afterwards `is_fault_new` is false and `uptime_ms` 0.
struct RunStart {
    RunRecord record;
    wire::ResetCause cause = wire::ResetCause::unknown;  ///< `fault` if one was recorded
    /// Too many runs ended too soon, and the last one before there was a node. The port then waits for
    /// `safe_mode_s`, touching as little as possible, before it tries again (`retry_start_up`).
    bool is_start_up_failing = false;
};
[[nodiscard]] RunStart begin_run(const RunRecord& last, wire::ResetCause hardware,
                                 const RunRules& rules) noexcept;

/// For a port, before anything that may fail: begins the run and records that start-up is under way. From
/// then on every reset counts. The node that is made with this `RunStart` ends start-up.
[[nodiscard]] RunStart begin_start_up(KeptMemory& memory, wire::ResetCause hardware,
                                      const RunRules& rules) noexcept;
/// After the wait: begins the one attempt.
void retry_start_up(KeptMemory& memory, RunStart& start) noexcept;

/// How long safe mode lasts before the next try, in seconds.
[[nodiscard]] constexpr std::uint32_t safe_mode_s(std::uint8_t failed_retries) noexcept {
    constexpr std::uint32_t kFirst = 60;
    constexpr std::uint32_t kLongest = 3'600;
    const std::uint32_t doubled = failed_retries < 6 ? kFirst << failed_retries : kLongest;
    return doubled < kLongest ? doubled : kLongest;
}

}  // namespace octoskin::node
