// What outlives a reset: why the last run ended, how long the runs lasted, and whether the node is to keep
// still for a while. A node that is reset three times in 10 s by itself goes into safe mode: it says that it
// lives, and touches no bus. After a minute it tries once more, then after two, four, up to an hour; a
// command ends it at once.
#pragma once

#include <array>
#include <cstdint>

#include "common/wire/messages.hpp"

namespace octoskin::node {

/// Memory that no start-up code clears: a port puts it where its linker script says so, and gives it away
/// by `Ports::kept`. What it holds after power-on is anything; a CRC tells. Two copies, written one after the
/// other: a reset that comes in the middle of one leaves the other whole. Trivial on purpose, as a
/// constructor would clear it.
struct KeptMemory {
    using Copy = std::array<std::uint32_t, 9>;
    std::array<Copy, 2> copies;
};

enum class RunMode : std::uint8_t {
    normal,
    safe,   ///< heartbeat only
    retry,  ///< as normal, but the next reset that nobody ordered leads back to safe mode
};

struct RunRecord {
    wire::FaultKind fault = wire::FaultKind::none;  ///< the last one
    bool is_fault_new = false;                      ///< noted in this run: it is about to end
    bool is_starting = false;  ///< there is no node yet: what fails now would fail in safe mode too
    RunMode mode = RunMode::normal;
    std::uint8_t retries = 0;           ///< after safe mode, which failed
    std::uint32_t resets = 0;           ///< that nobody ordered, since the last one that was
    std::uint32_t where = 0;            ///< of the last fault: program counter, or by kind
    std::uint32_t fault_uptime_ms = 0;  ///< of the run that it ended
    std::uint32_t uptime_ms = 0;        ///< of this run, as last noted
    /// Of the last two runs that ended by themselves one after the other, the newest first.
    std::array<std::uint32_t, 2> ended_uptime_ms{};
    friend constexpr bool operator==(const RunRecord&, const RunRecord&) = default;
};

struct RunRules {
    std::uint32_t resets_until_safe = 3;
    std::uint32_t resets_within_ms = 10'000;
};

/// What `memory` holds; the record of a first run if it was never written, or both copies are damaged.
[[nodiscard]] RunRecord load(const KeptMemory& memory) noexcept;
void save(const RunRecord& record, KeptMemory& memory) noexcept;

/// For fault handlers and the assertion's: writes down what ends this run, then whoever calls resets. From
/// any context, about 100 bytes of stack and 30 us on a Cortex-M4. The first one of a run counts: what comes
/// after it is its consequence.
void note_fault(KeptMemory& memory, wire::FaultKind fault, std::uint32_t where) noexcept;

/// A new run begins: judges how the one before ended. `hardware`: what the reset register says. Afterwards
/// `is_fault_new` is false and `uptime_ms` 0.
struct RunStart {
    RunRecord record;
    wire::ResetCause cause = wire::ResetCause::unknown;  ///< `fault` if one was noted
    /// So many runs ended so soon, and the last one before there was a node. Whoever starts keeps still for
    /// `safe_mode_s`, touching as little as possible, before it tries again (`retry_start_up`).
    bool is_start_up_failing = false;
};
[[nodiscard]] RunStart begin_run(const RunRecord& last, wire::ResetCause hardware,
                                 const RunRules& rules) noexcept;

/// For a port, before anything that may fail: begins the run and writes down that start-up is under way. From
/// then on a reset counts, wherever it comes. The node, made with this `RunStart`, ends start-up.
[[nodiscard]] RunStart begin_start_up(KeptMemory& memory, wire::ResetCause hardware,
                                      const RunRules& rules) noexcept;
/// After having kept still: this is the one try.
void retry_start_up(KeptMemory& memory, RunStart& start) noexcept;

/// How long safe mode lasts before the next try, in seconds.
[[nodiscard]] constexpr std::uint32_t safe_mode_s(std::uint8_t failed_retries) noexcept {
    constexpr std::uint32_t kFirst = 60;
    constexpr std::uint32_t kLongest = 3'600;
    const std::uint32_t doubled = failed_retries < 6 ? kFirst << failed_retries : kLongest;
    return doubled < kLongest ? doubled : kLongest;
}

}  // namespace octoskin::node
