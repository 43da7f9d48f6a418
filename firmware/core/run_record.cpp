#include "firmware/core/run_record.hpp"

#include <algorithm>
#include <span>

#include "common/wire/crc.hpp"
#include "common/wire/names.hpp"

namespace octoskin::node {

namespace {

using wire::FaultKind;
using wire::ResetCause;

constexpr std::uint32_t kLayout = 0x4F53'4B02;  // memory with another layout holds no record

// In byte 1 of the flags.
constexpr std::uint32_t kFaultIsNew = 1;
constexpr std::uint32_t kIsStarting = 2;

// Index of each word.
enum : std::size_t {
    layout,
    flags,
    resets,
    where,
    fault_uptime,
    uptime,
    ended_last,
    ended_before,
    crc,
    count
};
static_assert(count == KeptMemory::Copy{}.size());

std::uint32_t crc_of(const KeptMemory::Copy& words) noexcept {
    std::array<std::uint8_t, 4 * crc> bytes{};
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        bytes[i] = static_cast<std::uint8_t>(words[i / 4] >> (8 * (i % 4)));
    }
    return crc32(bytes);
}

bool is_ordered(ResetCause cause) noexcept {
    switch (cause) {
        case ResetCause::power_on:
        case ResetCause::software:
        case ResetCause::pin:
            return true;
        case ResetCause::brown_out:
        case ResetCause::watchdog:
        case ResetCause::fault:
        case ResetCause::unknown:
            return false;
    }
    return false;
}

FaultKind unwritten_fault(ResetCause cause) noexcept {
    if (cause == ResetCause::watchdog) return FaultKind::watchdog;
    return cause == ResetCause::brown_out ? FaultKind::brown_out : FaultKind::unknown;
}

RunMode mode_after_fault(const RunRecord& record, const RunRules& rules) noexcept {
    if (record.mode != RunMode::normal) return RunMode::safe;
    const std::uint64_t together = std::uint64_t{record.ended_uptime_ms[0]} + record.ended_uptime_ms[1];
    const bool is_often = record.resets >= rules.resets_until_safe;
    return is_often && together <= rules.resets_within_ms ? RunMode::safe : RunMode::normal;
}

bool is_whole(const KeptMemory::Copy& words) noexcept {
    return words[layout] == kLayout && words[crc] == crc_of(words);
}

}  // namespace

RunRecord load(const KeptMemory& memory) noexcept {
    const bool is_first_whole = is_whole(memory.copies[0]);
    if (!is_first_whole && !is_whole(memory.copies[1])) return {};
    const KeptMemory::Copy& words = memory.copies[is_first_whole ? 0 : 1];
    const auto byte = [flag_word = words[flags]](unsigned which) {
        return static_cast<std::uint8_t>(flag_word >> (8 * which));
    };
    const auto fault = static_cast<FaultKind>(byte(0));
    return {.fault = wire::is_known(fault) ? fault : FaultKind::unknown,
            .is_fault_new = (byte(1) & kFaultIsNew) != 0,
            .is_starting = (byte(1) & kIsStarting) != 0,
            .mode = static_cast<RunMode>(std::min<std::uint8_t>(byte(2), 2)),
            .retries = byte(3),
            .resets = words[resets],
            .where = words[where],
            .fault_uptime_ms = words[fault_uptime],
            .uptime_ms = words[uptime],
            .ended_uptime_ms = {words[ended_last], words[ended_before]}};
}

void save(const RunRecord& record, KeptMemory& memory) noexcept {
    KeptMemory::Copy words{};
    words[layout] = kLayout;
    const std::uint32_t marks =
        (record.is_fault_new ? kFaultIsNew : 0U) | (record.is_starting ? kIsStarting : 0U);
    words[flags] = static_cast<std::uint32_t>(record.fault) | marks << 8U |
                   static_cast<std::uint32_t>(record.mode) << 16U | std::uint32_t{record.retries} << 24U;
    words[resets] = record.resets;
    words[where] = record.where;
    words[fault_uptime] = record.fault_uptime_ms;
    words[uptime] = record.uptime_ms;
    words[ended_last] = record.ended_uptime_ms[0];
    words[ended_before] = record.ended_uptime_ms[1];
    words[crc] = crc_of(words);
    // Volatile: both copies are written, and one is done before the other begins.
    for (KeptMemory::Copy& copy : memory.copies) {
        for (std::size_t i = 0; i < words.size(); ++i)
            static_cast<volatile std::uint32_t&>(copy[i]) = words[i];
    }
}

void note_fault(KeptMemory& memory, FaultKind fault, std::uint32_t where) noexcept {
    RunRecord record = load(memory);
    if (record.is_fault_new) return;
    record.fault = fault;
    record.where = where;
    record.fault_uptime_ms = record.uptime_ms;
    record.is_fault_new = true;
    save(record, memory);
}

RunStart begin_run(const RunRecord& last, ResetCause hardware, const RunRules& rules) noexcept {
    // After power-on the memory may still have its old content, which belongs to no run any more.
    if (hardware == ResetCause::power_on) return {.record = {}, .cause = hardware};

    RunStart start{.record = last, .cause = last.is_fault_new ? ResetCause::fault : hardware};
    RunRecord& record = start.record;
    record.is_fault_new = false;
    record.is_starting = false;
    record.uptime_ms = 0;
    if (is_ordered(start.cause)) {
        record.mode = RunMode::normal;
        record.retries = 0;
        record.resets = 0;
        return start;
    }
    if (!last.is_fault_new) {
        record.fault = unwritten_fault(start.cause);
        record.where = 0;
        record.fault_uptime_ms = last.uptime_ms;
    }
    ++record.resets;
    record.ended_uptime_ms = {last.uptime_ms, last.ended_uptime_ms[0]};
    if (last.mode == RunMode::retry && record.retries < 255) ++record.retries;
    record.mode = mode_after_fault(record, rules);
    // An unstable supply is not a failing program: while the supply holds, the node reports it itself.
    const bool was_supply = start.cause == ResetCause::brown_out;
    start.is_start_up_failing = last.is_starting && !was_supply && record.mode == RunMode::safe;
    return start;
}

RunStart begin_start_up(KeptMemory& memory, ResetCause hardware, const RunRules& rules) noexcept {
    RunStart start = begin_run(load(memory), hardware, rules);
    start.record.is_starting = true;
    save(start.record, memory);
    return start;
}

void retry_start_up(KeptMemory& memory, RunStart& start) noexcept {
    start.record.mode = RunMode::retry;
    save(start.record, memory);
}

}  // namespace octoskin::node
