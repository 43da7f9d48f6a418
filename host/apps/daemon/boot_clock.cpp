#include "host/apps/daemon/boot_clock.hpp"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iterator>
#include <limits>
#include <sstream>
#include <string>

#include "host/apps/daemon/clocks.hpp"

namespace octoskin {
namespace {

std::optional<std::array<std::uint8_t, 16>> boot_id() {
    std::ifstream kernels("/proc/sys/kernel/random/boot_id");
    std::string text;
    if (std::getline(kernels, text)) return read_boot_id(text);
    const char* const systemds = std::getenv("OCTOSKIN_BOOT_ID");
    return systemds != nullptr ? read_boot_id(systemds) : std::nullopt;
}

constexpr std::int64_t kSecond_ns = 1'000'000'000;

/// Offset of this process's time namespace; 0 if the kernel has none.
std::optional<Nanoseconds> boot_offset() {
    std::ifstream offsets("/proc/self/timens_offsets");
    if (!offsets) return Nanoseconds{0};
    const std::string text{std::istreambuf_iterator<char>(offsets), {}};
    return read_boot_offset(text);
}

/// When the second of the bus time began that the clock shows; empty: it shows none of the bus time.
std::optional<BootTime> begin_of_second(const VoxelAges::Clock& clock, const std::optional<BootTime>& now,
                                        HostTime bus) {
    if (!now || !clock.has_begun || clock.waits) return std::nullopt;
    const std::int64_t whole_s = bus.ns / kSecond_ns - (clock.zero_s + clock.now);
    if (whole_s < 0) return now;  // the bus time was estimated late, or has gone back
    const std::int64_t boot_s = now->since_boot.count() / kSecond_ns;
    const Nanoseconds since{std::min(whole_s, boot_s) * kSecond_ns + bus.ns % kSecond_ns};
    return BootTime{now->boot, std::max(now->since_boot - since, Nanoseconds{0})};
}

}  // namespace

Nanoseconds clock_boottime() {
    timespec now{};
    (void)::clock_gettime(CLOCK_BOOTTIME, &now);  // available since Linux 2.6.39
    return Nanoseconds{std::int64_t{now.tv_sec} * kSecond_ns + now.tv_nsec};
}
Nanoseconds clock_monotonic() {
    return Nanoseconds{monotonic_now().ns};
}

SleepWatch::SleepWatch(Clock boottime, Clock monotonic)
    : boottime_(std::move(boottime)), monotonic_(std::move(monotonic)), reported_(read().most) {}

/// This thread may lose the processor, or the machine may sleep, between two readings.
SleepWatch::Slept SleepWatch::read() const {
    const Nanoseconds before = monotonic_();
    const Nanoseconds boottime = boottime_();
    return {boottime - monotonic_(), boottime - before};
}

Nanoseconds SleepWatch::look() {
    const Slept now = read();
    const Nanoseconds slept = now.least - reported_;
    if (slept < Nanoseconds{kSecond_ns}) {
        reported_ = std::min(reported_, now.most);
        return Nanoseconds{0};
    }
    reported_ = now.most;
    return slept;
}

std::optional<Nanoseconds> read_boot_offset(std::string_view text) {
    std::istringstream lines{std::string(text)};
    std::string clock;
    std::int64_t seconds = 0;
    std::int64_t nanoseconds = 0;
    constexpr std::int64_t kSecondsMax = std::numeric_limits<std::int64_t>::max() / 2 / kSecond_ns;
    while (lines >> clock >> seconds >> nanoseconds) {
        if (clock != "boottime") continue;
        if (seconds > kSecondsMax || seconds < -kSecondsMax) return std::nullopt;
        if (nanoseconds >= kSecond_ns || nanoseconds < 0) return std::nullopt;
        return Nanoseconds{seconds * kSecond_ns + nanoseconds};
    }
    return std::nullopt;
}

std::optional<std::array<std::uint8_t, 16>> read_boot_id(std::string_view text) {
    constexpr int kHex = 16;
    std::string digits;
    for (const char letter : text)
        if (letter != '-') digits += letter;
    std::array<std::uint8_t, 16> id{};
    if (digits.size() != 2 * id.size()) return std::nullopt;
    for (std::size_t i = 0; i < id.size(); ++i) {
        const char* const first = digits.data() + 2 * i;
        const auto [end, error] = std::from_chars(first, first + 2, id[i], kHex);
        if (error != std::errc{} || end != first + 2) return std::nullopt;
    }
    return id;
}

std::optional<BootTime> boot_now() {
    static const auto boot = boot_id();  // constant while this process lives
    const auto offset = boot_offset();
    if (!boot || !offset) return std::nullopt;
    return BootTime{*boot, std::max(clock_boottime() - *offset, Nanoseconds{0})};
}

std::optional<std::int64_t> seconds_between(const std::optional<BootTime>& then,
                                            const std::optional<BootTime>& now) {
    if (!then || !now || then->boot != now->boot || now->since_boot < then->since_boot) return std::nullopt;
    const std::int64_t passed_ns = (now->since_boot - then->since_boot).count();
    return passed_ns / kSecond_ns + (passed_ns % kSecond_ns > 0 ? 1 : 0);
}

std::optional<std::int64_t> MapTime::begin_with(FusedMap& map, const std::optional<BootTime>& saved) {
    const std::optional<BootTime> now = clock_();
    const auto passed_s = seconds_between(saved, now);
    if (passed_s) {
        map.begin_to_wait();
        const bool is_older = map.wait(*passed_s);
        begin(map, saved, now);
        if (is_older) map_time_ = now;
    } else {
        map.clear_times();
        begin(map, now, now);
    }
    return passed_s;
}

void MapTime::forget(Pipeline& pipeline) {
    pipeline.clear_times();
    const std::optional<BootTime> now = clock_();
    begin(pipeline.map(), now, now);
}

void MapTime::begin(const FusedMap& map, const std::optional<BootTime>& since,
                    const std::optional<BootTime>& now) {
    saved_ = since;
    map_time_ = since;
    looked_ = now;
    seen_ = map.layers().ages.clock();
}

Nanoseconds MapTime::attend(Pipeline& pipeline, HostTime bus) {
    const Nanoseconds slept = sleep_.look();
    if (slept > Nanoseconds{0}) jump_over_sleep(pipeline, bus, slept);
    if (const auto passed_s = since_saved()) pipeline.wait(*passed_s);
    note(pipeline.map(), bus);
    return slept;
}

/// Counts from when the map's clock reached its present value: what passed before the sleep is included. If
/// that is not known, only the sleep counts.
void MapTime::jump_over_sleep(Pipeline& pipeline, HostTime bus, Nanoseconds slept) {
    pipeline.jump_over_sleep();
    note(pipeline.map(), bus);
    saved_ = map_time_;
    // It may have been read since then, and the time set may be that of another second.
    if (saved_ && looked_) saved_->since_boot = std::min(saved_->since_boot, looked_->since_boot - slept);
    if (!since_saved()) pipeline.wait((slept.count() + kSecond_ns - 1) / kSecond_ns);
}

std::optional<BootTime> MapTime::advance_time(FusedMap& copy, HostTime bus) const {
    const VoxelAges::Clock before = copy.layers().ages.clock();
    if (!before.has_begun || before.waits) return map_time_;
    copy.advance_time(bus);
    const VoxelAges::Clock& after = copy.layers().ages.clock();
    return after.runs_for_s == before.runs_for_s ? map_time_ : begin_of_second(after, clock_(), bus);
}

void MapTime::note(const FusedMap& map, HostTime bus) {
    const VoxelAges::Clock& clock = map.layers().ages.clock();
    const bool went_on = clock.has_begun != seen_.has_begun || clock.runs_for_s != seen_.runs_for_s;
    const std::optional<BootTime> now = clock_();
    if (went_on) {
        const auto second = begin_of_second(clock, now, bus);
        const bool was_earlier = looked_ && second && second->since_boot < looked_->since_boot;
        map_time_ = was_earlier ? second : looked_;
    }
    seen_ = clock;
    looked_ = now;
}

}  // namespace octoskin
